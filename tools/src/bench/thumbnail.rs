//! Pictures as small PNGs.

use super::error::BenchError;
use crate::html::base64;
use crate::pixels::{Pixels, linear_to_srgb};
use caustica_formats::image::encode_png;

/// An sRGB PNG whose longer side is at most `side` pixels; each is the mean of a square block.
///
/// # Errors
/// The PNG cannot be encoded.
pub fn png(pixels: &Pixels, side: usize) -> Result<Vec<u8>, BenchError> {
    let block = pixels.width.max(pixels.height).div_ceil(side.max(1)).max(1);
    let (width, height) = (pixels.width.div_ceil(block), pixels.height.div_ceil(block));
    let mut bytes = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0.0f32; 3];
            let mut count = 0.0;
            for py in y * block..((y + 1) * block).min(pixels.height) {
                for px in x * block..((x + 1) * block).min(pixels.width) {
                    let p = pixels.at(px, py);
                    (0..3).for_each(|c| sum[c] += p[c]);
                    count += 1.0;
                }
            }
            bytes.extend(sum.map(|v| (255.0 * linear_to_srgb((v / count).clamp(0.0, 1.0)) + 0.5) as u8));
        }
    }
    encode_png(width, height, &bytes).map_err(|e| BenchError::Usage(format!("cannot encode a PNG: {e}")))
}

/// The same PNG as the source of an `img` element.
///
/// # Errors
/// The PNG cannot be encoded.
pub fn data_uri(pixels: &Pixels, side: usize) -> Result<String, BenchError> {
    Ok(format!("data:image/png;base64,{}", base64(&png(pixels, side)?)))
}
