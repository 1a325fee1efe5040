use super::{PhaseSample, Scatter};
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Scatters alike in all directions.
#[derive(Clone, Copy, Debug)]
pub struct Isotropic;

/// 1/(4π).
const EVEN: f32 = 0.25 * std::f32::consts::FRAC_1_PI;

impl Scatter for Isotropic {
    #[inline(always)]
    fn eval(&self, _: Vec3, _: Vec3, _: Vec3) -> f32 {
        EVEN
    }

    #[inline(always)]
    fn sample(&self, _: Vec3, _: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        Some(PhaseSample { wo: warp::sphere(u), weight: 1.0, pdf: EVEN })
    }

    fn describe(&self) -> String {
        "isotropic phase function".to_owned()
    }
}
