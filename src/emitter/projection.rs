use super::frustum::Frustum;
use super::table::Table;
use super::{DirectSample, Emission, EmissionBounds, Light, Picture, SceneSphere, just_before};
use crate::math::{Color, Vec2, Vec3};
use crate::spectrum::{luminance, rgb, to_rgb};
use crate::texture::Textures;

/// pbrt's projection light: a point light whose intensity is that of the picture's nearest pixel.
#[derive(Clone, Debug)]
pub struct Projection {
    frustum: Frustum,
    /// W/sr.
    picture: Picture,
    table: Table,
    power: Color,
}

impl Projection {
    /// With `power`, the picture is scaled so that the light's luminous share of its power is this.
    pub fn new(frustum: Frustum, mut picture: Picture, power: Option<f32>) -> Self {
        let (w, h) = (picture.width, picture.height);
        let size = Vec2::new(w as f32, h as f32);
        let solid = |x: usize, y: usize| {
            let corner = Vec2::new(x as f32, y as f32);
            frustum.solid_angle(corner / size, (corner + 1.0) / size)
        };
        let mut total = [0.0f64; 3];
        for y in 0..h {
            for x in 0..w {
                let (texel, solid) = (to_rgb(picture.texel(x, y)), solid(x, y));
                (0..3).for_each(|c| total[c] += f64::from(texel[c]) * solid);
            }
        }
        let mut total = rgb(total.map(|t| t as f32));
        if let Some(wanted) = power.filter(|_| luminance(total) > 0.0) {
            let factor = wanted / luminance(total);
            picture.scale(factor);
            total *= factor;
        }
        let table = Table::new(w, h, |x, y| f64::from(picture.luminance(x, y)) * solid(x, y));
        Self { frustum, picture, table, power: total }
    }
}

impl Light for Projection {
    fn sample_direct(&self, _textures: &Textures, p: Vec3, _u: Vec2) -> Option<DirectSample> {
        let beam = self.frustum.toward(p)?;
        let [x, y] = self.picture.at(beam.uv.x, beam.uv.y);
        let value = self.picture.texel(x, y) / beam.d2;
        let target = Some(just_before(self.frustum.position, beam.dir * beam.d2.sqrt()));
        (value.max_element() > 0.0).then_some(DirectSample { dir: beam.dir, target, value, pdf: 0.0 })
    }

    fn sample_emission(
        &self,
        _textures: &Textures,
        _bounds: &EmissionBounds<'_>,
        _place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let p = &self.picture;
        let size = Vec2::new(p.width as f32, p.height as f32);
        let (x, y, rest) = self.table.sample(direction);
        let corner = Vec2::new(x as f32, y as f32);
        let (d, cos) = self.frustum.through((corner + rest) / size);
        // Chosen by the pixel's light, then evenly on the picture.
        let solid = self.frustum.solid_angle(corner / size, (corner + 1.0) / size);
        let density = f64::from(p.luminance(x, y)) * solid / self.table.total();
        let cell = self.frustum.area() / (p.width * p.height) as f32;
        let weight = cell * cos.powi(3) / density as f32;
        let flux = p.texel(x, y) * weight;
        flux.is_finite().then_some(Emission::from_point(self.frustum.position, d, flux, 1.0 / weight))
    }

    fn place(&self, _: Vec2) -> Option<Vec3> {
        Some(self.frustum.position)
    }

    fn power(&self, _textures: &Textures, _scene: &SceneSphere) -> Color {
        self.power
    }
}
