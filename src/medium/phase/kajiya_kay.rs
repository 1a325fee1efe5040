use std::f32::consts::PI;

use super::{PhaseSample, Scatter};
use crate::math::{Vec2, Vec3, gauss_legendre};
use crate::medium::Volume;
use crate::sampling::warp;

/// Fibres as Mitsuba's `kkay` has them: the cone of Kajiya and Kay (1989) with an even part. Its integral is at most
/// kd + ks, which light across the fibre reaches.
#[derive(Clone, Debug)]
pub struct KajiyaKay {
    /// Share of the even part.
    pub diffuse: f32,
    /// Share of the cone, for light across the fibre.
    pub specular: f32,
    exponent: f32,
    norm: f32,
    /// Direction of the fibres; where it is 0, or without it, the even part alone is left.
    orientation: Option<Volume>,
}

impl KajiyaKay {
    /// See the fields; the exponent is 0 or greater.
    pub fn new(diffuse: f32, specular: f32, exponent: f32, orientation: Option<Volume>) -> Self {
        // ∫ sinᵉ(θ)·sin(θ) dθ: a Gauss rule of few points sees no cone narrower than this.
        let exponent = exponent.clamp(0.0, 1000.0);
        let integral: f64 = gauss_legendre(256)
            .iter()
            .map(|(x, w)| {
                let sin = (std::f64::consts::PI * x).sin();
                std::f64::consts::PI * w * sin.powf(f64::from(exponent)) * sin
            })
            .sum();
        let norm = (1.0 / (2.0 * std::f64::consts::PI * integral)) as f32;
        Self { diffuse, specular, exponent, norm, orientation }
    }
}

impl Scatter for KajiyaKay {
    #[inline(always)]
    fn eval(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
        let even = self.diffuse / (4.0 * PI);
        let fibre = self.orientation.as_ref().and_then(|o| o.vector(p).try_normalize());
        let Some(fibre) = fibre else { return even };
        // Both directions by their angles to the fibre; the cone is where they are opposite.
        let (ci, co) = (-wi.dot(fibre), wo.dot(fibre));
        let sines = ((1.0 - ci * ci).max(0.0) * (1.0 - co * co).max(0.0)).sqrt();
        let cos = (ci * co + sines).clamp(0.0, 1.0);
        even + cos.powf(self.exponent) * self.norm * self.specular
    }

    #[inline(always)]
    fn pdf(&self, _: Vec3, _: Vec3, _: Vec3) -> f32 {
        0.25 / PI
    }

    #[inline(always)]
    fn sample(&self, p: Vec3, wi: Vec3, _: f32, u: Vec2) -> Option<PhaseSample> {
        let wo = warp::sphere(u);
        let pdf = 0.25 / PI;
        let weight = self.eval(p, wi, wo) / pdf;
        (weight > 0.0).then_some(PhaseSample { wo, weight, pdf })
    }

    fn describe(&self) -> String {
        "phase function of Kajiya and Kay".to_owned()
    }
}
