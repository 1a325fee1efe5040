use std::f32::consts::PI;

use super::{Arena, DirectSample, Emission, Light, SceneSphere};
use crate::math::{Color, Vec2, Vec3};
use crate::texture::Textures;

/// Parallel light from infinity; `irradiance` on a plane perpendicular to it, W/m².
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit direction of travel.
    pub direction: Vec3,
    pub irradiance: Color,
}

impl Light for Directional {
    fn sample_direct(&self, _textures: &Textures, _p: Vec3, _u: Vec2) -> Option<DirectSample> {
        Some(DirectSample { dir: -self.direction, target: None, value: self.irradiance, pdf: 0.0 })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        arena: &Arena<'_>,
        place: Vec2,
        _direction: Vec2,
    ) -> Option<Emission> {
        let (o, weight) = arena.enter(self.direction, place);
        Some(Emission { o, d: self.direction, flux: self.power(textures, &arena.sphere) * weight })
    }

    fn power(&self, _textures: &Textures, scene: &SceneSphere) -> Color {
        self.irradiance * (PI * scene.radius * scene.radius)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}
