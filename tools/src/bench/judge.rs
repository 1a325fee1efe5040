//! The numbers that are kept of a rendered picture.

use super::error::BenchError;
use crate::compare::{CompareError, CompareOptions, compare, load};
use crate::pixels::Pixels;
use std::path::Path;

/// The errors of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Judged {
    pub rmse: f64,
    pub relmse: f64,
    pub relmse_trimmed: f64,
    /// Difference of the means, relative to the reference's.
    pub bias: f64,
    /// Mean LDR-FLIP.
    pub flip: f64,
    /// Mean HDR-FLIP.
    pub hdr_flip: f64,
}

/// Judges a picture.
///
/// # Panics
/// If the sizes differ.
pub fn judge(image: &Pixels, reference: &Pixels) -> Judged {
    let c = compare(image, reference, None, &CompareOptions::default()).comparison;
    Judged {
        rmse: c.errors.rmse_all,
        relmse: c.errors.relmse,
        relmse_trimmed: c.errors.relmse_trimmed,
        bias: c.bias.relative_all,
        flip: c.flip_ldr.stats.mean,
        hdr_flip: c.flip_hdr.expect("the default options ask for HDR-FLIP").stats.mean,
    }
}

/// Reads a picture that must have the given size; `reference` is named in the error.
///
/// # Errors
/// The picture cannot be read, or has another size.
pub fn load_sized(path: &Path, reference: &Path, size: [usize; 2]) -> Result<Pixels, BenchError> {
    let pixels = load(path, None)?.pixels;
    if [pixels.width, pixels.height] != size {
        return Err(BenchError::Image(CompareError::Size {
            path: path.to_path_buf(),
            size: [pixels.width, pixels.height],
            reference: reference.to_path_buf(),
            reference_size: size,
        }));
    }
    Ok(pixels)
}
