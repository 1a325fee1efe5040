use std::f32::consts::PI;

use super::{DirectSample, Emission, just_before};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;

/// Isotropic point light; `intensity` in W/sr.
#[derive(Clone, Debug)]
pub struct Point {
    pub position: Vec3,
    pub intensity: Color,
}

impl Point {
    pub fn sample_direct(&self, p: Vec3) -> Option<DirectSample> {
        let d = self.position - p;
        let d2 = d.length_squared();
        (d2 > 0.0).then(|| DirectSample {
            dir: d / d2.sqrt(),
            target: Some(just_before(self.position, d)),
            value: self.intensity / d2,
            pdf: 0.0,
        })
    }

    pub fn sample_emission(&self, direction: Vec2) -> Option<Emission> {
        Some(Emission { o: self.position, d: warp::sphere(direction), flux: self.power() })
    }

    pub fn power(&self) -> Color {
        self.intensity * (4.0 * PI)
    }
}
