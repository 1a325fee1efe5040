use std::f32::consts::PI;

use super::{Arena, DirectSample, Emission, Light, SceneSphere};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Textures;

/// The same radiance from every direction.
#[derive(Clone, Debug)]
pub struct Constant {
    pub radiance: Color,
}

/// Density of [`Constant::sample_direct`] per solid angle.
const UNIFORM: f32 = 1.0 / (4.0 * PI);

impl Constant {
    pub fn pdf_direct(&self) -> f32 {
        UNIFORM
    }
}

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
        arena: &Arena<'_>,
        place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let d = warp::sphere(direction);
        let (o, weight) = arena.enter(d, place);
        Some(Emission { o, d, flux: self.power(textures, &arena.sphere) * weight })
    }

    fn power(&self, _textures: &Textures, scene: &SceneSphere) -> Color {
        self.radiance * (4.0 * PI * PI * scene.radius * scene.radius)
    }

    fn is_infinite(&self) -> bool {
        true
    }
}
