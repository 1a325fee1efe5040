//! Two pictures, each in a file or in memory.

use super::args::CompareArgs;
use super::error::CompareError;
use super::load::{Opened, open};
use super::run::compare_opened;
use crate::flip::FlipMap;
use crate::pixels::Pixels;
use std::path::Path;

/// Where a picture is.
#[derive(Clone, Debug)]
pub enum Picture {
    /// In the file that the arguments name.
    File,
    /// The bytes of such a file.
    Bytes(Vec<u8>),
    /// Radiance.
    Pixels(Pixels),
}

/// What a comparison found.
#[derive(Debug)]
pub struct Judged {
    /// All numbers: an element of `comparisons` of the JSON that `caustica compare` writes.
    pub json: String,
    /// LDR-FLIP of each pixel.
    pub flip: FlipMap,
}

/// Compares two pictures as [`run`](super::run()) compares the files that `args` names. A mask and a variance beside
/// the reference count as there; what is in memory is called by the name of its file in messages.
///
/// # Errors
/// A picture cannot be read or holds values that are not finite, the sizes differ, or a mask or a variance cannot be
/// used.
pub fn judge(args: &CompareArgs, image: Picture, reference: Picture) -> Result<Judged, CompareError> {
    let opened = |picture: Picture, path: &Path| match picture {
        Picture::File => open(path),
        Picture::Bytes(bytes) => Opened::of_bytes(bytes, path),
        Picture::Pixels(pixels) => Ok(Opened::of_pixels(&pixels)),
    };
    let pictures = [opened(image, &args.image)?, opened(reference, &args.reference)?];
    let compared = compare_opened(args, pictures)?;
    let json =
        serde_json::to_string(&compared.comparison).expect("a comparison holds only numbers and strings");
    Ok(Judged { json, flip: compared.ldr })
}
