//! Radiance pictures (`.hdr`, `.pic`): shared-exponent RGB.

use std::io::Cursor;

use image::codecs::hdr::{HdrDecoder, HdrEncoder};
use image::{ColorType, ImageDecoder, Rgb};

use super::{Encoding, Image, ImageError, check_data, check_memory, check_size, guarded};

pub(super) fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    let invalid = |error: image::ImageError| ImageError::Invalid(format!("HDR: {error}"));
    guarded(|| {
        let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(invalid)?;
        let (width, height) = decoder.dimensions();
        let (width, height) = (width as usize, height as usize);
        // A run of 127 equal bytes takes two.
        check_size([width, height], width as u128 * height as u128 * 4, bytes.len(), 64)?;
        check_memory([width, height], width as u128 * height as u128 * 24)?;
        if decoder.color_type() != ColorType::Rgb32F {
            return Err(ImageError::Unsupported("this kind of HDR file".into()));
        }
        let mut raw = vec![0_u8; width * height * 12];
        decoder.read_image(&mut raw).map_err(invalid)?;
        let data = raw
            .chunks_exact(4)
            .map(|word| f32::from_ne_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        let channels = ["R", "G", "B"].map(str::to_owned).to_vec();
        Ok(Image { width, height, channels, data, encoding: Encoding::Linear })
    })
}

/// A Radiance picture; `rgb` holds three linear values per pixel, row 0 at the top.
///
/// # Errors
/// When `rgb` has the wrong length.
pub fn encode_hdr(width: usize, height: usize, rgb: &[f32]) -> Result<Vec<u8>, ImageError> {
    check_data(width, height, 3, rgb.len())?;
    let pixels: Vec<Rgb<f32>> =
        rgb.chunks_exact(3).map(|pixel| Rgb([pixel[0], pixel[1], pixel[2]])).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, width, height)
        .map_err(|error| ImageError::Invalid(format!("HDR: {error}")))?;
    Ok(bytes)
}
