use std::f32::consts::PI;

use super::{Arena, DirectSample, Emission, SceneSphere};
use crate::math::{Color, Vec2, Vec3};

/// Parallel light from infinity; `irradiance` on a plane perpendicular to it, W/m².
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit direction of travel.
    pub direction: Vec3,
    pub irradiance: Color,
}

impl Directional {
    pub fn sample_direct(&self) -> Option<DirectSample> {
        Some(DirectSample { dir: -self.direction, target: None, value: self.irradiance, pdf: 0.0 })
    }

    pub fn sample_emission(&self, arena: &Arena<'_>, place: Vec2) -> Option<Emission> {
        let (o, weight) = arena.enter(self.direction, place);
        Some(Emission { o, d: self.direction, flux: self.power(&arena.sphere) * weight })
    }

    pub fn power(&self, scene: &SceneSphere) -> Color {
        self.irradiance * (PI * scene.radius * scene.radius)
    }
}
