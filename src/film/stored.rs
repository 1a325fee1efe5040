//! The numbers that are summed for a pixel: layers × RGB, then alpha, then the luminance of each pass and its square; and
//! where their sums are.

use super::layer::LAYERS;

/// Place of alpha, after the layers.
pub(super) const ALPHA: usize = 3 * LAYERS.len();
/// Place of the luminance.
pub(super) const LUMINANCE: usize = ALPHA + 1;
/// Place of its square.
pub(super) const SQUARE: usize = LUMINANCE + 1;
/// Numbers summed for each pixel.
pub const STRIDE: usize = SQUARE + 1;

/// Where the sum of a number of a pixel is, of `count` pixels: one number of all pixels after another, so that memory
/// for layers without light is never touched.
pub(super) fn place(pixel: usize, number: usize, count: usize) -> usize {
    number * count + pixel
}

/// Luminance of linear sRGB, by channel.
pub(super) const LUMINANCE_WEIGHTS: [f64; 3] = [0.212671, 0.715160, 0.072169];
