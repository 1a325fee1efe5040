//! What every other renderer is asked for, and what is said where there is none.

use crate::cli::failure::Failure;
use crate::cli::report;

/// Of its pictures: their spread says how far their mean is off.
pub const SEEDS: u32 = 4;

/// The renderer's name, and its pictures with different seeds; `None` where it is not installed.
pub type Rendered = Option<(String, Vec<Vec<[f32; 3]>>)>;

/// Says what would install the renderer.
///
/// # Errors
/// When nothing can be printed.
pub fn skipped(renderer: &str, command: &str) -> Result<Rendered, Failure> {
    report::data(&format!("check with {renderer}: skipped, it is not installed; {command}"))?;
    Ok(None)
}
