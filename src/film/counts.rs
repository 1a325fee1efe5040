//! Camera samples of pixels that do not all take as many.

/// How many samples each pixel takes in the passes after the first ones, which take as many in every pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    /// Of each pixel; empty where all take as many in all passes, or where it is not known yet.
    pub each: Vec<u16>,
    /// Variance of the first passes over that of the others, as far as it is that of camera samples.
    pub gain: f32,
}

impl Default for Counts {
    fn default() -> Self {
        Self { each: Vec::new(), gain: 1.0 }
    }
}
