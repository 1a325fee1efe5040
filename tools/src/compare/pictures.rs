//! Two pictures in memory.

use super::args::CompareArgs;
use super::error::CompareError;
use super::load::Loaded;
use super::pairs::Pair;
use super::run::compare_loaded;
use crate::flip::FlipMap;

/// What a comparison found.
#[derive(Debug)]
pub struct Judged {
    /// All numbers: an element of `comparisons` of the JSON that `caustica compare` writes.
    pub json: String,
    /// LDR-FLIP of each pixel.
    pub flip: FlipMap,
}

/// Compares two pictures as [`run`](super::run()) compares the files that `args` names. A mask and a variance beside
/// the reference count as there; both paths are names in messages only.
///
/// # Errors
/// The pictures have different sizes, or a mask or a variance cannot be used.
pub fn judge(args: &CompareArgs, image: Loaded, reference: Loaded) -> Result<Judged, CompareError> {
    let name = args.image.display().to_string();
    let pair = Pair { name, image: args.image.clone(), reference: args.reference.clone() };
    let compared = compare_loaded(args, false, &pair, image, reference, None)?;
    let json =
        serde_json::to_string(&compared.comparison).expect("a comparison holds only numbers and strings");
    Ok(Judged { json, flip: compared.ldr })
}
