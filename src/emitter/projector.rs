use std::f32::consts::PI;

use super::frustum::Frustum;
use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere, just_before};
use crate::math::{Color, Vec2, Vec3};
use crate::texture::{Param, Site, Textures};

/// Mitsuba's projector: the plane at distance 1 across the axis receives the irradiance π·texture.
#[derive(Clone, Debug)]
pub struct Projector {
    /// Where the picture is thrown.
    pub frustum: Frustum,
    /// The picture; times π it is the irradiance of the plane at distance 1.
    pub irradiance: Param,
}

impl Light for Projector {
    fn sample_direct(&self, textures: &Textures, p: Vec3, _u: Vec2) -> Option<DirectSample> {
        let beam = self.frustum.toward(p)?;
        // Intensity π·T/cos³: on the plane at depth z it gives π·T/z².
        let value =
            textures.eval(self.irradiance, &Site::flat(beam.uv)) * (PI / (beam.cos.powi(3) * beam.d2));
        let target = Some(just_before(self.frustum.position, beam.dir * beam.d2.sqrt()));
        (value.max_element() > 0.0).then_some(DirectSample { dir: beam.dir, target, value, pdf: 0.0 })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        _bounds: &EmissionBounds<'_>,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let (d, cos) = self.frustum.through(direction);
        let flux = textures.eval(self.irradiance, &Site::flat(direction)) * (PI * self.frustum.area());
        // Even on the picture, which covers cos³ of its area at distance 1.
        let density = 1.0 / (self.frustum.area() * cos.powi(3));
        (flux.max_element() > 0.0).then_some(Emission::from_point(self.frustum.position, d, flux, density))
    }

    fn place(&self, _: Vec2) -> Option<Vec3> {
        Some(self.frustum.position)
    }

    fn power(&self, textures: &Textures, _scene: &SceneSphere) -> Color {
        textures.mean(self.irradiance) * (PI * self.frustum.area())
    }
}
