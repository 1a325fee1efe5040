use std::f64::consts::PI;

use super::table::{Table, linear};
use super::{DirectSample, Emission, EmissionBounds, Light, Picture, SceneSphere, equal_area};
use crate::math::{Color, Frame, Vec2, Vec3};
use crate::spectrum::{luminance, rgb, to_rgb};
use crate::texture::Textures;

/// Radiance from infinity by a picture. Directions are drawn in proportion to luminance exactly, as it
/// is looked up, so the density needs no table.
#[derive(Clone, Debug)]
pub struct Environment {
    picture: Picture,
    mapping: Mapping,
    /// The light's own axes in the world; they may mirror.
    axes: Frame,
    table: Table,
    /// Of each row of cells, the mean sine of the polar angle (1 for equal areas).
    sines: Vec<f32>,
    /// Mean over the square of luminance times `sines`.
    mean: f32,
    /// ∫L dω, W/m² per channel.
    total: Color,
}

/// How directions lie on the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// Mitsuba's: u = atan2(x, −z)/2π, v = acos(y)/π. Texel centres at (i + ½)/width; the first and last
    /// row lie on the poles. Bilinear.
    LatLong,
    /// pbrt's: see [`equal_area`]. The nearest texel.
    EqualArea,
}

/// Sines below this count as this: the density of a pole has no bound.
const POLE: f32 = 1e-6;

impl Environment {
    /// `axes`: orthonormal images of the light's X, Y and Z, not necessarily right-handed.
    pub fn new(picture: Picture, mapping: Mapping, axes: Frame) -> Self {
        let (w, h) = (picture.width, picture.height);
        let luminance_at = |x: usize, y: usize| f64::from(picture.luminance(x, y));
        match mapping {
            Mapping::EqualArea => {
                let table = Table::new(w, h, luminance_at);
                let cell = 4.0 * PI / (w * h) as f64;
                let total = sum(&picture, |_| cell);
                let mean = (table.total() / (w * h) as f64) as f32;
                Self { sines: vec![1.0; h], picture, mapping, axes, table, mean, total }
            }
            Mapping::LatLong => {
                let rows = (h - 1).max(1);
                let step = PI / rows as f64;
                let angle = |y: usize| y as f64 * step;
                let sine = |y: usize| (angle(y).cos() - angle(y + 1).cos()) / step;
                let below = |y: usize| (y + 1).min(h - 1);
                let corners = |x: usize, y: usize| {
                    let right = (x + 1) % w;
                    luminance_at(x, y)
                        + luminance_at(right, y)
                        + luminance_at(x, below(y))
                        + luminance_at(right, below(y))
                };
                let table = Table::new(w, rows, |x, y| 0.25 * corners(x, y) * sine(y));
                // ∫ sinθ·(θ − θ₀)/step dθ over the row that begins at θ₀: the share of its lower texels.
                let lower = |y: usize| (angle(y + 1).sin() - angle(y).sin()) / step - angle(y + 1).cos();
                let upper = |y: usize| angle(y).cos() - angle(y + 1).cos() - lower(y);
                let column = 2.0 * PI / w as f64;
                let total = sum(&picture, |y| {
                    let share = if h == 1 {
                        2.0
                    } else {
                        let under = if y < rows { upper(y) } else { 0.0 };
                        under + if y > 0 { lower(y - 1) } else { 0.0 }
                    };
                    share * column
                });
                let mean = (table.total() / (w * rows) as f64) as f32;
                let sines = (0..rows).map(|y| sine(y) as f32).collect();
                Self { picture, mapping, axes, table, sines, mean, total }
            }
        }
    }

    /// Scales the light so that a plane facing the light's +Z receives the illuminance `wanted`, in units
    /// of the picture's luminance (equal-area pictures only, as pbrt has them). pbrt counts a texel with
    /// 2π/N sr, half of what it covers, and so makes the light twice as bright; its pictures are matched.
    pub fn set_illuminance(&mut self, wanted: f32) {
        let (w, h) = (self.picture.width, self.picture.height);
        let mut received = 0.0f64;
        for y in 0..h {
            for x in 0..w {
                let uv = (Vec2::new(x as f32, y as f32) + 0.5) / Vec2::new(w as f32, h as f32);
                let cosine = equal_area::to_direction(uv).z.max(0.0);
                received += f64::from(self.picture.luminance(x, y) * cosine);
            }
        }
        received *= 2.0 * PI / (w * h) as f64;
        if received > 0.0 {
            let factor = (f64::from(wanted) / received) as f32;
            self.picture.scale(factor);
            self.mean *= factor;
            self.total *= factor;
        }
    }

    /// Radiance of a point of the square, and the row of cells it lies in.
    #[inline]
    fn look_up(&self, uv: Vec2) -> (Color, usize) {
        let p = &self.picture;
        if self.mapping == Mapping::EqualArea {
            let [x, y] = p.at(uv.x, uv.y);
            return (p.texel(x, y), y);
        }
        let x = uv.x * p.width as f32 - 0.5;
        // Half a texel left of the first one comes the last.
        let (x0, fx) = if x < 0.0 { (p.width - 1, x + 1.0) } else { (x as usize, x.fract()) };
        let x0 = x0.min(p.width - 1);
        let y = (uv.y * (p.height - 1) as f32).max(0.0);
        let y0 = (y as usize).min(self.sines.len() - 1);
        (between(self.corners(x0, y0), Vec2::new(fx, (y - y0 as f32).min(1.0))), y0)
    }

    /// Texels around a cell: left and right of the upper row, then of the lower one.
    #[inline]
    fn corners(&self, x: usize, y: usize) -> [Color; 4] {
        let p = &self.picture;
        let (x1, y1) = (if x + 1 == p.width { 0 } else { x + 1 }, (y + 1).min(p.height - 1));
        [p.texel(x, y), p.texel(x1, y), p.texel(x, y1), p.texel(x1, y1)]
    }

    /// The place on the square of a unit direction of the world, and the sine of its polar angle.
    fn place(&self, d: Vec3) -> (Vec2, f32) {
        let l = self.axes.to_local(d);
        if self.mapping == Mapping::EqualArea {
            return (equal_area::to_square(l), 1.0);
        }
        let sine = l.x.hypot(l.z);
        let u = l.x.atan2(-l.z) * std::f32::consts::FRAC_1_PI * 0.5;
        let v = sine.atan2(l.y) * std::f32::consts::FRAC_1_PI;
        (Vec2::new(if u < 0.0 { u + 1.0 } else { u }, v), sine)
    }

    /// Per solid angle, with which [`Environment::sample_direct`] chooses a direction.
    fn density(&self, radiance: Color, row: usize, sine: f32) -> f32 {
        use std::f32::consts::PI;
        let square = luminance(radiance) * self.sines[row] / self.mean;
        match self.mapping {
            Mapping::EqualArea => square / (4.0 * PI),
            Mapping::LatLong => square / (2.0 * PI * PI * sine.max(POLE)),
        }
    }

    /// A direction, its radiance divided by its density, and the density.
    fn sample(&self, u: Vec2) -> Option<(Vec3, Color, f32)> {
        let p = &self.picture;
        let (x, y, rest) = self.table.sample(u);
        let (radiance, row, local, sine) = match self.mapping {
            Mapping::EqualArea => {
                let cell = Vec2::new(x as f32, y as f32) + rest;
                let uv = cell / Vec2::new(p.width as f32, p.height as f32);
                let (radiance, row) = self.look_up(uv);
                (radiance, row, equal_area::to_direction(uv), 1.0)
            }
            Mapping::LatLong => {
                let corners = self.corners(x, y);
                let [a, b, c, d] = corners.map(luminance);
                let fy = linear(rest.y, a + b, c + d);
                let fx = linear(rest.x, a + (c - a) * fy, b + (d - b) * fy);
                let radiance = between(corners, Vec2::new(fx, fy));
                let v = (y as f32 + fy) / self.sines.len() as f32;
                let u = (x as f32 + 0.5 + fx) / p.width as f32;
                let u = if u >= 1.0 { u - 1.0 } else { u };
                let (sine, cosine) = (std::f32::consts::PI * v).sin_cos();
                let (sin, cos) = (2.0 * std::f32::consts::PI * u).sin_cos();
                (radiance, y, Vec3::new(sine * sin, cosine, -sine * cos), sine)
            }
        };
        let pdf = self.density(radiance, row, sine);
        (pdf > 0.0 && pdf.is_finite()).then(|| (self.axes.to_world(local).normalize(), radiance / pdf, pdf))
    }

    /// Memory of the picture and of its sampling table.
    pub fn bytes(&self) -> usize {
        self.picture.bytes() + self.table.bytes()
    }
}

impl Light for Environment {
    fn sample_direct(&self, _textures: &Textures, _p: Vec3, u: Vec2) -> Option<DirectSample> {
        Some(DirectSample::of_background(self.sample(u)?))
    }

    /// A direction as for direct light, and a place on the disk that the scene's sphere shows to it.
    fn sample_emission(
        &self,
        _textures: &Textures,
        bounds: &EmissionBounds<'_>,
        place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        Some(Emission::of_background(self.sample(direction)?, bounds, place))
    }

    #[inline(always)]
    fn background(&self, d: Vec3) -> (Color, f32) {
        let (uv, sine) = self.place(d);
        let (radiance, row) = self.look_up(uv);
        (radiance, self.density(radiance, row, sine))
    }

    fn power(&self, _textures: &Textures, scene: &SceneSphere) -> Color {
        self.total * scene.disk()
    }

    fn is_infinite(&self) -> bool {
        true
    }
}

/// Bilinear, of [`Environment::corners`].
#[inline]
fn between([a, b, c, d]: [Color; 4], at: Vec2) -> Color {
    let top = a * (1.0 - at.x) + b * at.x;
    let bottom = c * (1.0 - at.x) + d * at.x;
    top * (1.0 - at.y) + bottom * at.y
}

/// Sum over the texels, each row with its weight.
fn sum(picture: &Picture, weight: impl Fn(usize) -> f64) -> Color {
    let mut total = [0.0f64; 3];
    for y in 0..picture.height {
        let w = weight(y);
        for x in 0..picture.width {
            let texel = to_rgb(picture.texel(x, y));
            (0..3).for_each(|c| total[c] += w * f64::from(texel[c]));
        }
    }
    rgb(total.map(|t| t as f32))
}

#[cfg(test)]
mod tests;
