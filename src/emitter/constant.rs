use std::f32::consts::PI;

use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::{Density, warp};
use crate::texture::Textures;

/// The same radiance from every direction.
#[derive(Clone, Debug)]
pub struct Constant {
    /// W/(m²·sr).
    pub radiance: Color,
}

/// Density of [`Constant::sample_direct`] per solid angle.
const UNIFORM: f32 = 1.0 / (4.0 * PI);

impl Light for Constant {
    fn sample_direct(&self, _textures: &Textures, _p: Vec3, u: Vec2) -> Option<DirectSample> {
        Some(DirectSample {
            dir: warp::sphere(u),
            target: None,
            value: self.radiance / UNIFORM,
            pdf: UNIFORM,
        })
    }

    /// A uniform direction, and a place on the disk that the scene's sphere shows to it.
    fn sample_emission(
        &self,
        textures: &Textures,
        bounds: &EmissionBounds<'_>,
        place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let d = warp::sphere(direction);
        let entry = bounds.enter(d, place);
        let flux = self.power(textures, &bounds.sphere) * entry.weight;
        Some(Emission::from_infinity(entry, d, flux, Density::Finite(UNIFORM)))
    }

    #[inline(always)]
    fn background(&self, _d: Vec3) -> (Color, f32) {
        (self.radiance, UNIFORM)
    }

    fn power(&self, _textures: &Textures, scene: &SceneSphere) -> Color {
        self.radiance * (4.0 * PI * PI * scene.radius * scene.radius)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}
