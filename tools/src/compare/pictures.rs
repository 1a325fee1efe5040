//! Pictures in memory.

use super::args::CompareArgs;
use super::error::CompareError;
use super::load::{Opened, open};
use super::pairs::Pair;
use super::run::compare_opened;
use crate::flip::FlipMap;
use crate::pixels::Pixels;

/// What a comparison found.
#[derive(Debug)]
pub struct Judged {
    /// All numbers: an element of `comparisons` of the JSON that `caustica compare` writes.
    pub json: String,
    /// LDR-FLIP of each pixel.
    pub flip: FlipMap,
}

/// Compares two pictures as [`run`](super::run()) compares the files that `args` names: pictures of radiance in memory, or
/// those files where there are none. A mask and a variance beside the reference count either way.
///
/// # Errors
/// A file cannot be read, a value is not finite, the pictures have different sizes, or a mask or a variance cannot be
/// used.
pub fn judge(
    args: &CompareArgs,
    image: Option<&Pixels>,
    reference: Option<&Pixels>,
) -> Result<Judged, CompareError> {
    let name = args.image.display().to_string();
    let pair = Pair { name, image: args.image.clone(), reference: args.reference.clone() };
    let layer = args.layer.as_deref();
    let opened = |pixels: Option<&Pixels>, file, layer| match pixels {
        Some(pixels) => Ok(Opened::in_memory(pixels, layer)),
        None => open(file),
    };
    let image = opened(image, &args.image, layer)?;
    let reference = opened(reference, &args.reference, args.reference_layer.as_deref().or(layer))?;
    let (compared, _) = compare_opened(args, &pair, &image, &reference)?;
    let json =
        serde_json::to_string(&compared.comparison).expect("a comparison holds only numbers and strings");
    Ok(Judged { json, flip: compared.ldr })
}
