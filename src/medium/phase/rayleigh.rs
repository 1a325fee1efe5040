use std::f32::consts::PI;

use super::{PhaseSample, Scatter, around};
use crate::math::{Vec2, Vec3};

/// Scattering by particles smaller than the wavelength: 1 + cos².
#[derive(Clone, Copy, Debug)]
pub struct Rayleigh;

impl Scatter for Rayleigh {
    #[inline(always)]
    fn eval(&self, _: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let cos = wi.dot(wo);
        3.0 / (16.0 * PI) * (1.0 + cos * cos)
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        // The cosine solves c³ + 3c = 8u − 4 (Cardano).
        let z = 4.0 * u.x - 2.0;
        let a = (z.abs() + (z * z + 1.0).sqrt()).cbrt();
        let cos = (a - 1.0 / a).copysign(z).clamp(-1.0, 1.0);
        let wo = around(wi, 1.0 - cos, u.y);
        Some(PhaseSample { wo, weight: 1.0, pdf: self.eval(p, wi, wo) })
    }

    fn describe(&self) -> String {
        "Rayleigh phase function".to_owned()
    }
}
