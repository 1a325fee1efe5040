//! Writing a FLIP map.

use super::error::CompareError;
use crate::flip::{FlipMap, magma};
use caustica_formats::image::{ExrLayer, ExrOptions, write_exr, write_pfm, write_png};
use std::path::Path;

/// Writes magma colours, or the values for `.exr` and `.pfm`.
///
/// # Errors
/// The folder or the file cannot be written.
pub fn write(path: &Path, map: &FlipMap) -> Result<(), CompareError> {
    if let Some(parent) = path.parent() {
        let io = |source| CompareError::Io { path: parent.to_path_buf(), source };
        std::fs::create_dir_all(parent).map_err(io)?;
    }
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let written = match extension.as_ref().and_then(|e| e.to_str()) {
        Some("exr") => {
            let layer = ExrLayer { name: "", channels: &["Y"], data: &map.values };
            write_exr(path, map.width, map.height, &[layer], &[], ExrOptions::default())
        }
        Some("pfm") => write_pfm(path, map.width, map.height, &map.values),
        _ => write_png(path, map.width, map.height, &colours(map)),
    };
    written.map_err(|source| CompareError::Read { path: path.to_path_buf(), source })
}

/// The map in magma, three bytes per pixel.
fn colours(map: &FlipMap) -> Vec<u8> {
    map.values.iter().flat_map(|v| magma(*v)).collect()
}
