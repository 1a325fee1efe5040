use std::f32::consts::PI;

use super::table::Table;
use super::{DirectSample, Emission, EmissionBounds, Light, Picture, SceneSphere, equal_area, just_before};
use crate::math::{Color, Frame, Vec2, Vec3};
use crate::spectrum::scalar;
use crate::texture::Textures;

/// A point light whose intensity is scaled by the nearest pixel of an equal-area picture around it.
#[derive(Clone, Debug)]
pub struct Goniometric {
    /// In the world.
    pub position: Vec3,
    /// Orthonormal, possibly mirroring; `n` points to the middle of the picture.
    axes: Frame,
    /// W/sr where the picture is 1.
    intensity: Color,
    /// Gray.
    picture: Picture,
    table: Table,
}

impl Goniometric {
    /// Of the picture, the mean of the channels counts.
    pub fn new(position: Vec3, axes: Frame, intensity: Color, picture: &Picture) -> Self {
        let (w, h) = (picture.width, picture.height);
        let gray = |i: usize| [picture.texel(i % w, i / w).sum_of_lanes() / 3.0; 3];
        let picture = Picture::new(w, h, (0..w * h).map(gray).collect());
        let table = Table::new(w, h, |x, y| f64::from(scalar(picture.texel(x, y))));
        Self { position, axes, intensity, picture, table }
    }

    /// Power in W per lane, in closed form.
    pub fn flux(&self) -> Color {
        let pixels = (self.picture.width * self.picture.height) as f64;
        self.intensity * (4.0 * PI * (self.table.total() / pixels) as f32)
    }
}

impl Light for Goniometric {
    fn sample_direct(&self, _textures: &Textures, p: Vec3, _u: Vec2) -> Option<DirectSample> {
        let d = self.position - p;
        let d2 = d.length_squared();
        let dir = d / d2.sqrt();
        let uv = equal_area::to_square(self.axes.to_local(-dir));
        let [x, y] = self.picture.at(uv.x, uv.y);
        let value = self.intensity * (scalar(self.picture.texel(x, y)) / d2);
        (d2 > 0.0 && value.max_element() > 0.0).then_some(DirectSample {
            dir,
            target: Some(just_before(self.position, d)),
            value,
            pdf: 0.0,
        })
    }

    fn sample_emission(
        &self,
        _textures: &Textures,
        _bounds: &EmissionBounds<'_>,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let (x, y, rest) = self.table.sample(direction);
        let size = Vec2::new(self.picture.width as f32, self.picture.height as f32);
        let local = equal_area::to_direction((Vec2::new(x as f32, y as f32) + rest) / size);
        let (flux, d) = (self.flux(), self.axes.to_world(local));
        // Texels are chosen by their light and cover equal solid angles.
        let texels = (self.picture.width * self.picture.height) as f32;
        let density = scalar(self.picture.texel(x, y)) * texels / (4.0 * PI * self.table.total() as f32);
        (flux.max_element() > 0.0).then_some(Emission::from_point(self.position, d, flux, density))
    }

    fn place(&self, _: Vec2) -> Option<Vec3> {
        Some(self.position)
    }

    fn power(&self, _textures: &Textures, _scene: &SceneSphere) -> Color {
        self.flux()
    }
}
