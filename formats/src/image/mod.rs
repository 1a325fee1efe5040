//! Images: bytes ↔ [`Image`].

use thiserror::Error;

/// Pixels as named channels, interleaved, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub width: usize,
    pub height: usize,
    /// In storage order, e.g. `R G B A`, `Y`, `direct.R`.
    pub channels: Vec<String>,
    /// `width · height · channels.len()` values; integer formats are scaled to 0..1, not decoded.
    pub data: Vec<f32>,
    pub encoding: Encoding,
}

/// What the stored numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Linear,
    /// 8- or 16-bit integers through the sRGB curve.
    Srgb,
}

/// Why an image could not be read or written.
#[derive(Debug, Error)]
pub enum ImageError {
    #[error("{0}")]
    Invalid(String),
    #[error("{0} is not supported")]
    Unsupported(String),
    #[error(transparent)]
    Io(#[from] std::io::Error),
}
