//! What the lanes of a [`Color`] mean: linear Rec. 709 red, green and blue.

use crate::math::Color;

/// The colour of linear Rec. 709 components (red, green, blue).
#[inline(always)]
pub const fn rgb(components: [f32; 3]) -> Color {
    Color::from_lanes(components)
}

/// The linear Rec. 709 components (red, green, blue) of a colour.
#[inline(always)]
pub fn to_rgb(color: Color) -> [f32; 3] {
    color.lanes()
}

/// Weights of red, green and blue in [`luminance`]: Rec. 709, with the digits Mitsuba uses.
pub const LUMINANCE: [f32; 3] = [0.212671, 0.715160, 0.072169];

/// Rec. 709 luminance (Y), in the unit of the colour.
#[inline]
pub fn luminance(color: Color) -> f32 {
    let [r, g, b] = to_rgb(color);
    LUMINANCE[0] * r + LUMINANCE[1] * g + LUMINANCE[2] * b
}

/// The number to use where a scalar parameter is given as a colour: its luminance, or for a grey exactly the
/// value of its components, since the luminance weights do not sum to exactly 1 in `f32`.
#[inline]
pub fn scalar(color: Color) -> f32 {
    color.uniform().unwrap_or_else(|| luminance(color))
}
