//! Masks: pixels of a reference that do not count.

use super::error::CompareError;
use super::load::load;
use crate::pixels::Pixels;
use std::path::{Path, PathBuf};

/// Which pixels count: those where the mask is above one half.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    counts: Vec<bool>,
}

impl Mask {
    /// The mask `X.mask.exr` beside the reference `X.exr`; `None` if there is no such file. `size` is the
    /// reference.
    ///
    /// # Errors
    /// The mask cannot be read, or has another size than the reference.
    pub fn beside(reference: &Path, size: &Pixels) -> Result<Option<Self>, CompareError> {
        match path(reference).filter(|p| p.is_file()) {
            Some(path) => Self::read(&path, reference, size).map(Some),
            None => Ok(None),
        }
    }

    /// Reads the mask of a reference; `size` is the reference.
    ///
    /// # Errors
    /// The mask cannot be read, or has another size than the reference.
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

    /// Makes the pixels black that do not count.
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

/// The file name that a mask of this reference has.
fn path(reference: &Path) -> Option<PathBuf> {
    let name = format!("{}.mask.{}", reference.file_stem()?.to_str()?, reference.extension()?.to_str()?);
    Some(reference.with_file_name(name))
}
