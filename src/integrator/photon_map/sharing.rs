//! How far samples of a pass share indirect light.

use crate::settings::{Indirect, Pixels, Settings};

/// Radius in the first pass: in pixels, and as a part of the shorter side of the picture, since in a small one pixels are
/// large.
const FIRST: f32 = 4.0;
const PART: f32 = 1.0 / 20.0;

/// It falls with this power of the number of the pass: variance goes with 1/(n·r²) and the square of bias with r⁴, so that
/// the error after n passes is least with r ~ n^(−1/6). Below the last of these nothing is shared.
const SHRINKS: f32 = -1.0 / 6.0;
const LEAST: f32 = 1.25;

/// In pixels, for pass `pass` of a picture whose shorter side has so many; `None` where each sample keeps its own light.
pub(super) fn radius(settings: &Settings, side: u32, pass: u32) -> Option<f32> {
    if settings.indirect == Indirect::Density {
        return None;
    }
    let Pixels(given) = settings.gather_radius;
    let radius = given.unwrap_or(FIRST.min(PART * side as f32)) * (pass as f32 + 1.0).powf(SHRINKS);
    (radius >= LEAST).then_some(radius)
}
