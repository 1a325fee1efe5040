use std::f32::consts::PI;

use super::{DirectSample, Emission, SceneSphere};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use crate::sampling::warp;

/// The same radiance from every direction.
#[derive(Clone, Debug)]
pub struct Constant {
    pub radiance: Rgb,
}

/// Density of [`Constant::sample_direct`] per solid angle.
const UNIFORM: f32 = 1.0 / (4.0 * PI);

impl Constant {
    pub fn sample_direct(&self, u: Vec2) -> Option<DirectSample> {
        Some(DirectSample {
            dir: warp::sphere(u),
            target: None,
            value: self.radiance / UNIFORM,
            pdf: UNIFORM,
        })
    }

    pub fn pdf_direct(&self) -> f32 {
        UNIFORM
    }

    /// A uniform direction, and a uniform place on the disk that the scene's sphere shows to it.
    pub fn sample_emission(&self, scene: &SceneSphere, place: Vec2, direction: Vec2) -> Option<Emission> {
        let d = warp::sphere(direction);
        let at = warp::disk(place) * scene.radius;
        let o = scene.center + Frame::from_normal(d).to_world(Vec3::new(at.x, at.y, -scene.radius));
        Some(Emission { o, d, flux: self.power(scene) })
    }

    pub fn power(&self, scene: &SceneSphere) -> Rgb {
        self.radiance * (4.0 * PI * PI * scene.radius * scene.radius)
    }
}
