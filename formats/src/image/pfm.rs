//! Portable float maps: `PF` (three channels) or `Pf` (one), rows bottom-up.

use std::path::Path;

use super::{Encoding, Image, ImageError, atomic_write, check_data, check_size};

pub(super) fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    let invalid = |what: &str| ImageError::Invalid(format!("PFM: {what}"));
    let mut words = Words { bytes, position: 0 };
    let channels: usize = match words.next() {
        Some("PF") => 3,
        Some("Pf") => 1,
        _ => return Err(invalid("the file does not start with PF or Pf")),
    };
    let mut number = || words.next().and_then(|word| word.parse::<u32>().ok());
    let (Some(width), Some(height)) = (number(), number()) else {
        return Err(invalid("width and height must be positive integers below 2³²"));
    };
    let (width, height) = (width as usize, height as usize);
    let scale = words.next().and_then(|word| word.parse::<f32>().ok());
    let Some(scale) = scale.filter(|scale| scale.is_finite() && *scale != 0.0) else {
        return Err(invalid("the scale must be a finite number other than zero"));
    };
    // Exactly one byte of white space separates the header from the data.
    let data = bytes.get(words.position + 1..).unwrap_or(&[]);
    let raw_bytes = width as u128 * height as u128 * channels as u128 * 4;
    check_size([width, height], raw_bytes, data.len(), 1)?;
    let row_bytes = width * channels * 4;
    let mut values = Vec::with_capacity(width * height * channels);
    for row in data[..row_bytes * height].chunks_exact(row_bytes).rev() {
        for word in row.chunks_exact(4) {
            let word = [word[0], word[1], word[2], word[3]];
            let value = if scale < 0.0 { f32::from_le_bytes(word) } else { f32::from_be_bytes(word) };
            values.push(value * scale.abs());
        }
    }
    let names: &[&str] = if channels == 3 { &["R", "G", "B"] } else { &["Y"] };
    Ok(Image {
        width,
        height,
        channels: names.iter().map(|name| (*name).to_owned()).collect(),
        data: values,
        encoding: Encoding::Linear,
    })
}

/// A little-endian PFM file; `data` holds three or one values per pixel, row 0 at the top.
///
/// # Errors
/// When `data` has the wrong length.
pub fn encode_pfm(width: usize, height: usize, data: &[f32]) -> Result<Vec<u8>, ImageError> {
    let channels = if data.len() == width.saturating_mul(height) { 1 } else { 3 };
    check_data(width, height, channels, data.len())?;
    let kind = if channels == 3 { "PF" } else { "Pf" };
    let mut bytes = format!("{kind}\n{width} {height}\n-1.0\n").into_bytes();
    for row in data.chunks_exact(width * channels).rev() {
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    Ok(bytes)
}

/// [`encode_pfm`] into a file that is replaced in one step.
///
/// # Errors
/// As [`encode_pfm`], and when the file cannot be written.
pub fn write_pfm(
    path: impl AsRef<Path>,
    width: usize,
    height: usize,
    data: &[f32],
) -> Result<(), ImageError> {
    Ok(atomic_write(path, &encode_pfm(width, height, data)?)?)
}

/// White-space separated words of the header.
struct Words<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a str> {
        let rest = &self.bytes[self.position..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace)?;
        self.position += start + length;
        std::str::from_utf8(&rest[start..start + length]).ok()
    }
}
