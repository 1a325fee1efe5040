//! Sun and sky as a picture: for renderers that have no such light, and for the mean over a time.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::daylight::{Daylight, Sun, sun_direction};
use super::days::Days;
use crate::ir::{SunSky, Transform};

/// A picture by latitude and longitude: radiance at (longitude (x + ½)/width, latitude y/(height − 1)), linear between,
/// with Mitsuba's directions (+Y up, the middle is +Z).
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels.
    pub width: usize,
    /// Pixels; the first and the last row are the poles.
    pub height: usize,
    /// Rows from the zenith down.
    pub rgb: Vec<[f64; 3]>,
}

impl Picture {
    /// From the space of a picture (+Y up) to that of its [`SunSky`] (+Z up): a rotation.
    pub const TO_LOCAL: Transform =
        Transform([[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);

    fn black(height: usize) -> Self {
        let width = 2 * (height - 1);
        Self { width, height, rgb: vec![[0.0; 3]; width * height] }
    }

    /// The direction of a pixel, in the space of the light.
    fn direction(&self, x: usize, y: usize) -> [f64; 3] {
        let (sin_phi, cos_phi) = (TAU * (x as f64 + 0.5) / self.width as f64).sin_cos();
        let (sine, cosine) = (PI * y as f64 / (self.height - 1) as f64).sin_cos();
        // Exactly level where it is, so that rounding does not put it below the horizon.
        let cosine = if 2 * y + 1 == self.height { 0.0 } else { cosine };
        [-cos_phi * sine, sin_phi * sine, cosine]
    }

    /// The place of a direction of the light's space, in pixels.
    fn place(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let u = y.atan2(-x).rem_euclid(TAU) / TAU;
        let v = x.hypot(y).atan2(z) / PI;
        [u * self.width as f64 - 0.5, v * (self.height - 1) as f64]
    }

    /// Integral over all directions of what is 1 at a pixel of row `y` and falls linearly to 0 at its neighbours.
    fn weight(&self, y: usize) -> f64 {
        let step = PI / (self.height - 1) as f64;
        let angle = y as f64 * step;
        // ∫ (1 − |θ − θ₀|/step) sin θ dθ; at the poles half of it.
        let hat = if y == 0 || y + 1 == self.height {
            1.0 - step.sin() / step
        } else {
            angle.sin() * 2.0 * (1.0 - step.cos()) / step
        };
        hat * TAU / self.width as f64
    }

    /// Integral over all directions.
    pub(super) fn total(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for y in 0..self.height {
            let weight = self.weight(y);
            for rgb in &self.rgb[y * self.width..(y + 1) * self.width] {
                (0..3).for_each(|c| sum[c] += weight * rgb[c]);
            }
        }
        sum
    }

    fn bilinear(&self, [x, y]: [f64; 2]) -> [([usize; 2], f64); 4] {
        let (left, top) = (x.floor(), y.floor().min((self.height - 2) as f64));
        let (fx, fy) = (x - left, y - top);
        let column = |i: f64| (left + i).rem_euclid(self.width as f64) as usize;
        let row = top as usize;
        [
            ([column(0.0), row], (1.0 - fx) * (1.0 - fy)),
            ([column(1.0), row], fx * (1.0 - fy)),
            ([column(0.0), row + 1], (1.0 - fx) * fy),
            ([column(1.0), row + 1], fx * fy),
        ]
    }

    /// Between the pixels, towards a direction of the light's space.
    pub fn radiance(&self, d: [f64; 3]) -> [f64; 3] {
        self.at(self.place(d))
    }

    fn at(&self, place: [f64; 2]) -> [f64; 3] {
        let corners = self.bilinear(place);
        std::array::from_fn(|c| corners.iter().map(|([x, y], w)| w * self.rgb[y * self.width + x][c]).sum())
    }

    fn add_sky(&mut self, light: &Daylight, share: f64) {
        let rows = if light.shines_below() { self.height } else { self.height / 2 + 1 };
        for y in 0..rows {
            for x in 0..self.width {
                let sky = light.sky(self.direction(x, y));
                let pixel = &mut self.rgb[y * self.width + x];
                (0..3).for_each(|c| pixel[c] += share * sky[c]);
            }
        }
    }

    /// Light of `side`² places of the disc, which keeps its irradiance.
    fn add_sun(&mut self, sun: &Sun, share: f64, side: usize) {
        for (d, light) in sun.places(side) {
            for ([x, y], weight) in self.bilinear(self.place(d)) {
                let factor = share * weight / self.weight(y);
                let pixel = &mut self.rgb[y * self.width + x];
                (0..3).for_each(|c| pixel[c] += factor * light[c]);
            }
        }
    }

    /// Makes the integral that of the light itself.
    fn match_total(&mut self, wanted: [f64; 3]) {
        let own = self.total();
        let factor: [f64; 3] = std::array::from_fn(|c| if own[c] > 0.0 { wanted[c] / own[c] } else { 1.0 });
        self.rgb.iter_mut().flatten().zip(factor.into_iter().cycle()).for_each(|(v, f)| *v *= f);
    }
}

/// Rows of a picture that shows a sun: 0.18° each.
const SUNNY: usize = 1025;
/// Rows of a picture without one.
const SKY: usize = 513;
/// Rows and moments of the mean of a sky, which is smooth.
const MEAN: (usize, usize) = (129, 500);
/// Moments of a path of the sun, for the first day and for each one.
const PATH: (usize, usize) = (4096, 96);

/// The light over a ground of linear colour `albedo`. The integral over all directions is that of the light itself to
/// 10⁻³. `None` for a direction of the sun or a `to_world` without length.
pub fn picture(light: &SunSky, albedo: [f64; 3]) -> Option<Picture> {
    let mut all = Picture::black(if light.sun_scale > 0.0 { SUNNY } else { SKY });
    let Some(days) = Days::of(&light.sun) else {
        let daylight = Daylight::new(light, sun_direction(light)?, albedo);
        all.add_sky(&daylight, 1.0);
        all.match_total(daylight.sky_total());
        if let Some(sun) = daylight.sun() {
            all.add_sun(sun, 1.0, 64);
        }
        return Some(all);
    };
    // Suns of neighbouring days stand beside each other, not in line.
    let moments = PATH.0.max(PATH.1 * days.length()) + 1;
    let mut sun_only = SunSky { sky_scale: 0.0, ..light.clone() };
    for i in 0..moments {
        let toward = days.at((i as f64 + 0.5) / moments as f64);
        let daylight = Daylight::new(&sun_only, toward, albedo);
        if let Some(sun) = daylight.sun() {
            all.add_sun(sun, 1.0 / moments as f64, 12);
        }
    }
    sun_only.sky_scale = light.sky_scale;
    let sky_only = SunSky { sun_scale: 0.0, ..light.clone() };
    let mut sky = Picture::black(MEAN.0);
    let mut total = [0.0; 3];
    for i in 0..MEAN.1 {
        let share = 1.0 / MEAN.1 as f64;
        let daylight = Daylight::new(&sky_only, days.at((i as f64 + 0.5) * share), albedo);
        sky.add_sky(&daylight, share);
        let own = daylight.sky_total();
        (0..3).for_each(|c| total[c] += share * own[c]);
    }
    let mut fine = Picture::black(all.height);
    for y in 0..fine.height {
        for x in 0..fine.width {
            fine.rgb[y * fine.width + x] = sky.radiance(fine.direction(x, y));
        }
    }
    fine.match_total(total);
    all.rgb.iter_mut().flatten().zip(fine.rgb.iter().flatten()).for_each(|(a, b)| *a += b);
    Some(all)
}

impl Daylight {
    /// Integral of the radiance of the sky over all directions, by the midpoints of 128 × 256 cells of equal angles.
    pub fn sky_total(&self) -> [f64; 3] {
        const ROWS: usize = 128;
        let lowest = if self.shines_below() { PI } else { FRAC_PI_2 };
        let mut sum = [0.0; 3];
        for y in 0..ROWS {
            let edge = |y: usize| lowest * y as f64 / ROWS as f64;
            let (sine, cosine) = (0.5 * (edge(y) + edge(y + 1))).sin_cos();
            let weight = (edge(y).cos() - edge(y + 1).cos()) * TAU / (2 * ROWS) as f64;
            for x in 0..2 * ROWS {
                let (sin, cos) = (TAU * (x as f64 + 0.5) / (2 * ROWS) as f64).sin_cos();
                let sky = self.sky([sine * cos, sine * sin, cosine]);
                (0..3).for_each(|c| sum[c] += weight * sky[c]);
            }
        }
        sum
    }
}
