use std::f32::consts::PI;

use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere, just_before};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Textures;

/// Isotropic point light; `intensity` in W/sr.
#[derive(Clone, Debug)]
pub struct Point {
    /// In the world.
    pub position: Vec3,
    /// W/sr.
    pub intensity: Color,
}

impl Light for Point {
    fn sample_direct(&self, _textures: &Textures, p: Vec3, _u: Vec2) -> Option<DirectSample> {
        let d = self.position - p;
        let d2 = d.length_squared();
        (d2 > 0.0).then(|| DirectSample {
            dir: d / d2.sqrt(),
            target: Some(just_before(self.position, d)),
            value: self.intensity / d2,
            pdf: 0.0,
        })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        bounds: &EmissionBounds<'_>,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let flux = self.power(textures, &bounds.sphere);
        let even = 1.0 / (4.0 * PI);
        let headed = bounds.head(self.position, direction, warp::sphere, |_| even);
        Emission::headed(headed, self.position, flux, even)
    }

    fn place(&self, _: Vec2) -> Option<Vec3> {
        Some(self.position)
    }

    fn power(&self, _textures: &Textures, _scene: &SceneSphere) -> Color {
        self.intensity * (4.0 * PI)
    }
}
