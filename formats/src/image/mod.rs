//! Images: bytes ↔ [`Image`].
//!
//! [`read`] tells formats apart by their content. Nothing is allocated for a size that the file
//! cannot hold, so a hostile file costs no more than a small honest one.

mod atomic;
mod exr_claims;
mod exr_read;
mod exr_write;
mod hdr;
mod pfm;
mod raster;

use std::panic::{AssertUnwindSafe, catch_unwind};

use thiserror::Error;

use crate::misnamed;

pub use crate::files::words;
pub use atomic::{Staged, atomic_replace, atomic_write};
pub use exr_write::{ExrLayer, ExrOptions, encode_exr, write_exr};
pub use hdr::encode_hdr;
pub use pfm::{encode_pfm, write_pfm};
pub use raster::{encode_png, write_png};

/// Pixels as named channels, interleaved, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<Data = Vec<f32>> {
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// In storage order, e.g. `R G B A`, `Y`, `direct.R`.
    pub channels: Vec<String>,
    /// `width · height · channels.len()` values; integer formats are scaled to 0..1, not decoded.
    pub data: Data,
    /// Of the colour channels.
    pub encoding: Encoding,
}

/// The values of an [`Image`] as its file stores them, so that a texture of bytes may stay one.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Of an 8-bit format; 255 is 1.
    Bytes(Vec<u8>),
    /// One for each channel of a pixel.
    Floats(Vec<f32>),
}

/// What the stored numbers mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Proportional to light.
    Linear,
    /// 8- or 16-bit integers through the sRGB curve.
    Srgb,
}

/// Why an image could not be read or written.
#[derive(Debug, Error)]
pub enum ImageError {
    /// The bytes break the rules of their format.
    #[error("{0}")]
    Invalid(String),
    /// Allowed by the format, but not supported.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] std::io::Error),
}

/// The largest image read, in pixels.
pub const MAX_PIXELS: usize = 1 << 28;

impl<Data> Image<Data> {
    /// Position of the channel called `name` within a pixel.
    pub fn channel(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|channel| channel == name)
    }

    /// Positions of red, green and blue within a pixel: `R G B`, or `Y` three times, or the only
    /// channel three times.
    pub fn rgb(&self) -> Option<[usize; 3]> {
        let named = |r, g, b| Some([self.channel(r)?, self.channel(g)?, self.channel(b)?]);
        let gray = || self.channel("Y").or((self.channels.len() == 1).then_some(0));
        named("R", "G", "B").or_else(|| gray().map(|i| [i; 3])).or_else(|| named("r", "g", "b"))
    }

    fn map<Other>(self, to: impl FnOnce(Data) -> Other) -> Image<Other> {
        let Self { width, height, channels, data, encoding } = self;
        Image { width, height, channels, data: to(data), encoding }
    }
}

impl Image {
    /// The values of one pixel, in the order of `channels`.
    pub fn pixel(&self, x: usize, y: usize) -> &[f32] {
        let count = self.channels.len();
        let start = (y * self.width + x) * count;
        &self.data[start..start + count]
    }
}

/// Reads an EXR, PNG, JPEG, BMP, TGA, Radiance HDR or PFM file.
///
/// EXR pixels cover the data window (the union of the data windows of all parts); channels of part
/// `p` are called `p.name` when the file has several parts, and integer channels keep their numbers.
///
/// # Errors
/// When the format is unknown, the bytes are malformed, or the image is larger than [`MAX_PIXELS`] or the
/// free memory allows.
pub fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    let floats = |samples| match samples {
        Samples::Bytes(bytes) => bytes.into_iter().map(|v| f32::from(v) / 255.0).collect(),
        Samples::Floats(values) => values,
    };
    Ok(read_samples(bytes)?.map(floats))
}

/// Text or whole number of an EXR file's header; `None` where it has no such attribute, or is no EXR file.
pub fn attribute(bytes: &[u8], name: &str) -> Option<String> {
    match detect(bytes) {
        Some(Format::Exr) => exr_read::attribute(bytes, name),
        _ => None,
    }
}

/// As [`read`], but 8-bit formats stay bytes.
///
/// # Errors
/// As [`read`].
pub fn read_samples(bytes: &[u8]) -> Result<Image<Samples>, ImageError> {
    let floats = |image: Image| image.map(Samples::Floats);
    match detect(bytes) {
        Some(Format::Exr) => exr_read::read(bytes).map(floats),
        Some(Format::Pfm) => pfm::read(bytes).map(floats),
        Some(Format::Hdr) => hdr::read(bytes).map(floats),
        Some(Format::Raster(format)) => raster::read(bytes, format),
        None => Err(match misnamed::not_binary(bytes) {
            Some(what) => ImageError::Invalid(format!("it is {what}")),
            None => ImageError::Unsupported(
                "this image format (known: EXR, PNG, JPEG, BMP, TGA, HDR, PFM)".into(),
            ),
        }),
    }
}

enum Format {
    Exr,
    Pfm,
    Hdr,
    Raster(image::ImageFormat),
}

fn detect(bytes: &[u8]) -> Option<Format> {
    use image::ImageFormat::{Bmp, Jpeg, Png, Tga};
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    Some(if starts(&[0x76, 0x2f, 0x31, 0x01]) {
        Format::Exr
    } else if starts(b"\x89PNG\r\n\x1a\n") {
        Format::Raster(Png)
    } else if starts(&[0xff, 0xd8, 0xff]) {
        Format::Raster(Jpeg)
    } else if starts(b"#?") {
        Format::Hdr
    } else if starts(b"PF") || starts(b"Pf") {
        Format::Pfm
    } else if starts(b"BM") {
        Format::Raster(Bmp)
    } else if raster::looks_like_tga(bytes) {
        Format::Raster(Tga)
    } else {
        return None;
    })
}

/// Refuses empty images, sizes beyond [`MAX_PIXELS`], and content of `raw_bytes` that a file of
/// `file_bytes` cannot expand to when its compression reaches at most `ratio`.
fn check_size(
    [width, height]: [usize; 2],
    raw_bytes: u128,
    file_bytes: usize,
    ratio: u128,
) -> Result<(), ImageError> {
    let pixels = width as u128 * height as u128;
    if pixels == 0 {
        return Err(ImageError::Invalid("the image has no pixels".into()));
    }
    if pixels > MAX_PIXELS as u128 {
        return Err(ImageError::Unsupported(format!("an image of {width} × {height} pixels")));
    }
    if raw_bytes > file_bytes as u128 * ratio {
        return Err(ImageError::Invalid(format!(
            "the file of {file_bytes} bytes cannot hold {width} × {height} pixels"
        )));
    }
    Ok(())
}

/// Refuses pictures that take more than a quarter of the free memory, of which a scene has several and
/// needs more for itself. `bytes` is what decoding holds at once.
fn check_memory([width, height]: [usize; 2], bytes: u128) -> Result<(), ImageError> {
    // Any machine has this much; asking the system would cost more.
    if bytes <= 1 << 26 {
        return Ok(());
    }
    let free = crate::memory::available();
    if bytes > free / 4 {
        let gigabytes = |n: u128| n as f64 / 1e9;
        return Err(ImageError::Invalid(format!(
            "an image of {width} × {height} pixels takes {:.2} GB, more than a quarter of the {:.2} GB of free memory",
            gigabytes(bytes),
            gigabytes(free)
        )));
    }
    Ok(())
}

/// Runs a third-party decoder; a panic inside it counts as a malformed file.
fn guarded<T>(decode: impl FnOnce() -> Result<T, ImageError>) -> Result<T, ImageError> {
    catch_unwind(AssertUnwindSafe(decode))
        .unwrap_or_else(|_| Err(ImageError::Invalid("the file is malformed".into())))
}

fn check_data(width: usize, height: usize, channels: usize, len: usize) -> Result<(), ImageError> {
    let expected = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(channels));
    if width > 0 && height > 0 && expected == Some(len) {
        return Ok(());
    }
    Err(ImageError::Invalid(format!(
        "{len} values do not fill {width} × {height} pixels of {channels} channels"
    )))
}

#[cfg(test)]
mod tests;
