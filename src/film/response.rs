use super::Radiance;
use crate::math::Color;
use crate::spectrum::to_rgb;

/// What the film stores of radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Response {
    /// That times a number.
    Ratio(f32),
    /// The images of red, green and blue.
    Colors([Color; 3]),
}

impl Response {
    /// Turns radiance into what the film stores, in place.
    #[inline]
    pub fn apply(&self, radiance: &mut Radiance) {
        match self {
            Self::Ratio(ratio) => radiance.map(|c| c * *ratio),
            Self::Colors([r, g, b]) => radiance.map(|c| {
                let [red, green, blue] = to_rgb(c);
                *r * red + *g * green + *b * blue
            }),
        }
    }
}
