use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use std::sync::Arc;

use super::table::Table;
use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere};
use crate::math::{Color, Frame, Vec2, Vec3};
use crate::sampling::warp;
use crate::spectrum::luminance;
use crate::texture::Textures;

/// Radiance of a sky and its sun by unit direction, +Z up.
pub trait Dome: fmt::Debug + Send + Sync {
    /// Of the sky alone.
    fn sky(&self, d: Vec3) -> Color;

    /// Of the sun, towards a direction on its disc.
    fn sun(&self, d: Vec3) -> Color;
}

/// Light from infinity by a formula, with a disc of much larger radiance in it. Directions are drawn from a table of
/// the sky's luminance or evenly from the disc; radiance is exact.
#[derive(Clone, Debug)]
pub struct SunSky {
    dome: Arc<dyn Dome>,
    /// The light's own axes in the world; they may mirror.
    axes: Frame,
    /// Angle from the zenith where the sky ends.
    lowest: f32,
    table: Table,
    /// Of each cell of the table, per solid angle.
    densities: Vec<f32>,
    disc: Option<Disc>,
    /// Probability that a direction is drawn from the disc.
    sun_share: f32,
    /// ∫L dω, W/m² per channel.
    total: Color,
}

/// The disc of the sun in the light's own space.
#[derive(Clone, Copy, Debug)]
struct Disc {
    frame: Frame,
    /// 1 − cos of half of its angle.
    one_minus_cos: f32,
    /// Per solid angle, of an even choice.
    density: f32,
}

/// Where the sun stands in a [`Dome`], and what it sends.
#[derive(Clone, Copy, Debug)]
pub struct SunDisc {
    /// Of its middle; unit.
    pub direction: Vec3,
    /// Half of its full angle, in radians.
    pub half_angle: f32,
    /// On a plane that faces it, W/m² per channel.
    pub irradiance: Color,
}

/// Cells by angle from the zenith in a quarter of the sky, and around it.
const ROWS: usize = 128;
const COLUMNS: usize = 256;

/// Share of the sky's directions that are drawn evenly, so that a place darker than the middle of its cell cannot get a
/// large weight.
const EVEN: f64 = 0.05;

impl SunSky {
    /// `axes`: orthonormal images of the light's X, Y and Z, not necessarily right-handed. The sky ends at the horizon
    /// unless it `shines_below`.
    pub fn new(dome: Arc<dyn Dome>, axes: Frame, sun: Option<SunDisc>, shines_below: bool) -> Self {
        let (rows, lowest) = if shines_below { (2 * ROWS, PI) } else { (ROWS, FRAC_PI_2) };
        let step = f64::from(lowest) / rows as f64;
        let solid = |y: usize| {
            // cos a − cos b without cancellation at the zenith.
            let middle = (y as f64 + 0.5) * step;
            2.0 * middle.sin() * (0.5 * step).sin() * f64::from(TAU) / COLUMNS as f64
        };
        let mut sums = [0.0f64; 3];
        let mut means = Vec::with_capacity(rows * COLUMNS);
        for y in 0..rows {
            for x in 0..COLUMNS {
                let light = cell_mean(&*dome, [x, y], step as f32);
                means.push(f64::from(luminance(light)));
                (0..3).for_each(|c| sums[c] += solid(y) * f64::from(light.lanes()[c]));
            }
        }
        let sky = Color::from_lanes(sums.map(|s| s as f32));
        let whole: f64 = f64::from(TAU) * (1.0 - f64::from(lowest).cos());
        let even = EVEN * f64::from(luminance(sky)) / whole;
        let weight = |x: usize, y: usize| ((1.0 - EVEN) * means[y * COLUMNS + x] + even) * solid(y);
        let table = Table::new(COLUMNS, rows, weight);
        let density = |i: usize| weight(i % COLUMNS, i / COLUMNS) / solid(i / COLUMNS) / table.total();
        let densities = (0..means.len()).map(|i| if table.total() > 0.0 { density(i) as f32 } else { 0.0 });
        let densities = densities.collect();
        let disc = sun.map(|sun| {
            let one_minus_cos = 2.0 * (0.5 * sun.half_angle).sin().powi(2);
            let frame = Frame::from_normal(sun.direction);
            Disc { frame, one_minus_cos, density: 1.0 / (TAU * one_minus_cos) }
        });
        let sun = sun.map_or(Color::ZERO, |sun| sun.irradiance);
        let total = sky + sun;
        let share = luminance(sun) / luminance(total);
        let sun_share = if share.is_finite() && disc.is_some() { share } else { 0.0 };
        Self { dome, axes, lowest, table, densities, disc, sun_share, total }
    }

    /// Radiance arriving from a direction of the light's own space, and the density per solid angle of drawing it.
    fn look_up(&self, local: Vec3) -> (Color, f32) {
        let rows = self.densities.len() / COLUMNS;
        let zenith = local.x.hypot(local.y).atan2(local.z);
        let mut light = self.dome.sky(local);
        let mut pdf = 0.0;
        if zenith <= self.lowest {
            let turn = local.y.atan2(local.x) / TAU;
            let turn = if turn < 0.0 { turn + 1.0 } else { turn };
            let x = ((turn * COLUMNS as f32) as usize).min(COLUMNS - 1);
            let y = ((zenith / self.lowest * rows as f32) as usize).min(rows - 1);
            pdf = (1.0 - self.sun_share) * self.densities[y * COLUMNS + x];
        }
        if let Some(disc) = &self.disc {
            // The square of the chord: a cosine this close to 1 would know the angle to a percent only.
            if (local - disc.frame.n).length_squared() <= 2.0 * disc.one_minus_cos {
                light += self.dome.sun(local);
                pdf += self.sun_share * disc.density;
            }
        }
        (light, pdf)
    }

    /// A direction of the light's own space.
    fn draw(&self, u: Vec2) -> Option<Vec3> {
        if let Some(disc) = self.disc.filter(|_| u.x < self.sun_share) {
            let place = Vec2::new(u.x / self.sun_share, u.y);
            return Some(disc.frame.to_world(warp::cone(place, disc.one_minus_cos)).normalize());
        }
        if self.table.total() <= 0.0 {
            return None;
        }
        let place = Vec2::new((u.x - self.sun_share) / (1.0 - self.sun_share), u.y);
        let rows = self.densities.len() / COLUMNS;
        let (x, y, rest) = self.table.sample(place.clamp(Vec2::ZERO, Vec2::splat(1.0 - f32::EPSILON)));
        let step = self.lowest / rows as f32;
        // Even by solid angle within the cell: between the two cosines. 1 − cos keeps its digits at the zenith.
        let down = |angle: f32| 2.0 * (0.5 * angle).sin().powi(2);
        let (top, bottom) = (down(y as f32 * step), down((y + 1) as f32 * step));
        let below = top + (bottom - top) * rest.y;
        let sine = (below * (2.0 - below)).max(0.0).sqrt();
        let (sin, cos) = (TAU * (x as f32 + rest.x) / COLUMNS as f32).sin_cos();
        Some(Vec3::new(sine * cos, sine * sin, 1.0 - below))
    }

    /// A direction of the world, its radiance divided by its density, and the density.
    fn sample(&self, u: Vec2) -> Option<(Vec3, Color, f32)> {
        let local = self.draw(u)?;
        let (light, pdf) = self.look_up(local);
        (pdf > 0.0 && light.max_element() > 0.0)
            .then(|| (self.axes.to_world(local).normalize(), light / pdf, pdf))
    }
}

/// Mean of the sky over a cell, by Gauss's two points in each direction.
fn cell_mean(dome: &dyn Dome, [x, y]: [usize; 2], step: f32) -> Color {
    const POINTS: [f32; 2] = [0.211_324_87, 0.788_675_13];
    let mut sum = Color::ZERO;
    let mut weights = 0.0;
    for a in POINTS {
        let (sine, cosine) = ((y as f32 + a) * step).sin_cos();
        for b in POINTS {
            let (sin, cos) = (TAU * (x as f32 + b) / COLUMNS as f32).sin_cos();
            sum += dome.sky(Vec3::new(sine * cos, sine * sin, cosine)) * sine;
            weights += sine;
        }
    }
    sum / weights
}

impl Light for SunSky {
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
        self.look_up(self.axes.to_local(d))
    }

    fn power(&self, _textures: &Textures, scene: &SceneSphere) -> Color {
        self.total * scene.disk()
    }

    fn is_infinite(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests;
