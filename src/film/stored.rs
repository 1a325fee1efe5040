//! The numbers that are summed for a pixel: layers × RGB, then alpha, then the luminance of each pass and its square; and
//! where their sums are.

use super::binned::ROW;
use super::layer::LAYERS;

/// Place of alpha, after the layers.
pub(super) const ALPHA: usize = 3 * LAYERS.len();
/// Place of the luminance.
pub(super) const LUMINANCE: usize = ALPHA + 1;
/// Place of its square.
pub(super) const SQUARE: usize = LUMINANCE + 1;
/// Numbers summed for each pixel.
pub const STRIDE: usize = SQUARE + 1;

/// Sums of the pixels whose sums of one number stand side by side: numbers of one size, or all 0.
pub(super) const BLOCK: usize = ROW * STRIDE;

/// Where the sum of a number of a pixel is: blocks of pixels have a row for each number.
pub(super) fn place(pixel: usize, number: usize) -> usize {
    pixel / ROW * BLOCK + number * ROW + pixel % ROW
}

/// Luminance of the sum of all layers, which come first in `s`.
pub(super) fn luminance_of(s: &[f64]) -> f64 {
    let channel = |c: usize| (0..LAYERS.len()).map(|l| s[3 * l + c]).sum::<f64>();
    0.212671 * channel(0) + 0.715160 * channel(1) + 0.072169 * channel(2)
}
