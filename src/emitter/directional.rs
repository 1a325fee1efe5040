use std::f32::consts::PI;

use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::Density;
use crate::texture::Textures;

/// Parallel light from infinity; `irradiance` on a plane perpendicular to it, W/m².
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit direction of travel.
    pub direction: Vec3,
    /// W/m² on a plane across `direction`.
    pub irradiance: Color,
}

impl Light for Directional {
    fn sample_direct(&self, _textures: &Textures, _p: Vec3, _u: Vec2) -> Option<DirectSample> {
        Some(DirectSample { dir: -self.direction, target: None, value: self.irradiance, pdf: 0.0 })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        bounds: &EmissionBounds<'_>,
        place: Vec2,
        _direction: Vec2,
    ) -> Option<Emission> {
        let entry = bounds.enter(self.direction, place);
        let flux = self.power(textures, &bounds.sphere) * entry.weight;
        Some(Emission::from_infinity(entry, self.direction, flux, Density::Delta))
    }

    fn power(&self, _textures: &Textures, scene: &SceneSphere) -> Color {
        self.irradiance * (PI * scene.radius * scene.radius)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}
