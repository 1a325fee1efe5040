//! What the lanes of a [`Color`] mean: linear Rec. 709 red, green and blue.

use crate::math::Color;

/// The colour of linear Rec. 709 red, green and blue.
#[inline(always)]
pub const fn rgb(components: [f32; 3]) -> Color {
    Color::from_lanes(components)
}

/// Linear Rec. 709 red, green and blue of a colour.
#[inline(always)]
pub fn to_rgb(color: Color) -> [f32; 3] {
    color.lanes()
}

/// Weights of red, green and blue in [`luminance`] (Rec. 709, with Mitsuba's digits).
pub const LUMINANCE: [f32; 3] = [0.212671, 0.715160, 0.072169];

/// Rec. 709 luminance.
#[inline]
pub fn luminance(color: Color) -> f32 {
    let [r, g, b] = to_rgb(color);
    LUMINANCE[0] * r + LUMINANCE[1] * g + LUMINANCE[2] * b
}

/// The value of a scalar parameter that is given as a colour: its luminance, and exactly the number of a
/// grey one, for the weights of the luminance do not quite sum to 1.
#[inline]
pub fn scalar(color: Color) -> f32 {
    color.uniform().unwrap_or_else(|| luminance(color))
}
