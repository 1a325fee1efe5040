use std::f32::consts::PI;

use super::{Arena, DirectSample, Emission, SceneSphere};
use crate::math::{Color, Vec2};
use crate::sampling::warp;

/// The same radiance from every direction.
#[derive(Clone, Debug)]
pub struct Constant {
    pub radiance: Color,
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

    /// A uniform direction, and a place on the disk that the scene's sphere shows to it.
    pub fn sample_emission(&self, arena: &Arena<'_>, place: Vec2, direction: Vec2) -> Option<Emission> {
        let d = warp::sphere(direction);
        let (o, weight) = arena.enter(d, place);
        Some(Emission { o, d, flux: self.power(&arena.sphere) * weight })
    }

    pub fn power(&self, scene: &SceneSphere) -> Color {
        self.radiance * (4.0 * PI * PI * scene.radius * scene.radius)
    }
}
