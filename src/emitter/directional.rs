use std::f32::consts::PI;

use super::{DirectSample, Emission, SceneSphere};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use crate::sampling::warp;

/// Parallel light from infinity; `irradiance` on a plane perpendicular to it, W/m².
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit direction of travel.
    pub direction: Vec3,
    pub irradiance: Rgb,
}

impl Directional {
    pub fn sample_direct(&self) -> Option<DirectSample> {
        Some(DirectSample { dir: -self.direction, target: None, value: self.irradiance, pdf: 0.0 })
    }

    pub fn sample_emission(&self, scene: &SceneSphere, place: Vec2) -> Option<Emission> {
        let d = warp::disk(place) * scene.radius;
        let frame = Frame::from_normal(self.direction);
        let o = scene.center + frame.to_world(Vec3::new(d.x, d.y, -scene.radius));
        Some(Emission { o, d: self.direction, flux: self.power(scene) })
    }

    pub fn power(&self, scene: &SceneSphere) -> Rgb {
        self.irradiance * (PI * scene.radius * scene.radius)
    }
}
