use std::f32::consts::PI;

use super::{PhaseSample, Scatter, around};
use crate::math::{Vec2, Vec3};

/// The phase function of Henyey and Greenstein (1941).
#[derive(Clone, Copy, Debug)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// Beyond this |g| a lobe is narrower than what f32 tells from a straight line.
    const MOST: f32 = 0.9999;

    /// From the mean cosine, above 0 for forward scattering.
    pub fn new(g: f32) -> Self {
        Self { g: g.clamp(-Self::MOST, Self::MOST) }
    }

    /// The mean cosine.
    pub fn g(&self) -> f32 {
        self.g
    }
}

impl Scatter for HenyeyGreenstein {
    #[inline(always)]
    fn eval(&self, _: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        // 1 − cos to the lobe's axis, from the difference of the vectors: exact for narrow lobes.
        let g = self.g.abs();
        let off = if self.g >= 0.0 { wi + wo } else { wo - wi };
        let h = 0.5 * off.length_squared();
        let d = (1.0 - g) * (1.0 - g) + 2.0 * g * h;
        (1.0 - g) * (1.0 + g) / (4.0 * PI * d * d.sqrt())
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        let g = self.g.abs();
        let axis = if self.g >= 0.0 { -wi } else { wi };
        // The inverse of the distribution of the cosine, solved for 1 − cos so that nothing cancels for g near 0 or 1.
        let width = 1.0 - g + 2.0 * g * u.x;
        let s = (1.0 - g) * (1.0 + g) / width;
        let h = (1.0 - g) * (1.0 - u.x) * (s + 1.0 - g) / width;
        let wo = around(axis, h.clamp(0.0, 2.0), u.y);
        Some(PhaseSample { wo, weight: 1.0, pdf: self.eval(p, wi, wo) })
    }

    fn describe(&self) -> String {
        format!("Henyey-Greenstein phase function, g {}", self.g)
    }
}
