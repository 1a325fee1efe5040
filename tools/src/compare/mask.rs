//! Pixels that a reference leaves out.

use super::{CompareError, load};
use crate::pixels::Pixels;
use std::path::{Path, PathBuf};

/// Which pixels count: those where the mask is above one half.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    counts: Vec<bool>,
}

impl Mask {
    /// The mask `X.mask.exr` beside the reference `X.exr`, of the reference's size; none without one.
    ///
    /// # Errors
    /// A mask that cannot be read, or of another size.
    pub fn beside(reference: &Path, size: &Pixels) -> Result<Option<Self>, CompareError> {
        match path(reference).filter(|p| p.is_file()) {
            Some(path) => Self::read(&path, reference, size).map(Some),
            None => Ok(None),
        }
    }

    /// # Errors
    /// A mask that cannot be read, or of another size than the reference.
    pub fn read(path: &Path, reference: &Path, size: &Pixels) -> Result<Self, CompareError> {
        let mask = load(path, None)?.pixels;
        if !mask.same_size(size) {
            return Err(CompareError::Size {
                path: path.to_path_buf(),
                size: [mask.width, mask.height],
                reference: reference.to_path_buf(),
                reference_size: [size.width, size.height],
            });
        }
        Ok(Self { counts: mask.rgb.iter().map(|p| p[0] > 0.5).collect() })
    }

    /// Makes black what does not count.
    pub fn apply(&self, pixels: &mut Pixels) {
        for (pixel, counts) in pixels.rgb.iter_mut().zip(&self.counts) {
            if !counts {
                *pixel = [0.0; 3];
            }
        }
    }

    /// Number of pixels that do not count.
    pub fn left_out(&self) -> usize {
        self.counts.iter().filter(|c| !**c).count()
    }
}

/// Where the mask of a reference would be.
pub fn path(reference: &Path) -> Option<PathBuf> {
    let name = format!("{}.mask.{}", reference.file_stem()?.to_str()?, reference.extension()?.to_str()?);
    Some(reference.with_file_name(name))
}
