//! Files and folders of a run, with their paths in the errors.

use super::error::BenchError;
use std::path::Path;

/// The error of a file.
pub fn at(path: &Path) -> impl Fn(std::io::Error) -> BenchError + '_ {
    |source| BenchError::Io { path: path.to_path_buf(), source }
}

/// Reads a file.
///
/// # Errors
/// It cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>, BenchError> {
    std::fs::read(path).map_err(at(path))
}

/// Writes a file in one step: it is there as a whole, or as before.
///
/// # Errors
/// It cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), BenchError> {
    caustica_formats::image::atomic_write(path, bytes).map_err(at(path))
}

/// Creates a folder and those above it.
///
/// # Errors
/// It cannot be created.
pub fn make_folder(path: &Path) -> Result<(), BenchError> {
    std::fs::create_dir_all(path).map_err(at(path))
}
