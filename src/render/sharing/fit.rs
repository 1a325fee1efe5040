//! Light at each place: local linear regression of what the places around it have found.

use rayon::prelude::*;

use super::{Place, same};
use crate::math::{Color, Frame, Vec3};

/// How far away places share light, as a share of the distance that it comes from (as in irradiance caching: Ward,
/// Rubinstein and Clear 1988): in corners light changes fast.
const REACH: f32 = 0.15;

/// Pixels around a place over which that distance is averaged. That of a single place is noise, and light from near is
/// darker or brighter than other light: choosing by it would be biased.
const SMOOTH: f32 = 2.5;

/// What slopes lose where few places, or places in a row, would tell them badly: in units of the places around, and of one
/// place.
const RIDGE: [f32; 2] = [0.005, 0.1];

/// The places of all pixels, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Fit<'a> {
    /// Pixels of a row.
    pub width: usize,
    /// In pixels.
    pub radius: f32,
    /// Of each pixel.
    pub places: &'a [Place],
}

/// Sums of a regression on two coordinates: of the weights, and of weighted light alone and times each coordinate.
#[derive(Clone, Copy, Debug)]
struct Sums {
    w: f32,
    x: f32,
    y: f32,
    xx: f32,
    xy: f32,
    yy: f32,
    light: [Color; 3],
}

impl Sums {
    const NONE: Self = Self { w: 0.0, x: 0.0, y: 0.0, xx: 0.0, xy: 0.0, yy: 0.0, light: [Color::ZERO; 3] };

    fn add(&mut self, weight: f32, [x, y]: [f32; 2], light: Color) {
        self.w += weight;
        self.x += weight * x;
        self.y += weight * y;
        self.xx += weight * x * x;
        self.xy += weight * x * y;
        self.yy += weight * y * y;
        for (sum, factor) in self.light.iter_mut().zip([1.0, x, y]) {
            *sum += light * (weight * factor);
        }
    }

    /// The value at the origin: the first row of the normal equations, solved by the adjugate of their matrix.
    fn solve(&self) -> Color {
        let Self { w, x, y, xy, .. } = *self;
        let ridge = RIDGE[0] * w + RIDGE[1];
        let (xx, yy) = (self.xx + ridge, self.yy + ridge);
        let [a, b, c] = [xx * yy - xy * xy, y * xy - x * yy, x * xy - y * xx];
        let determinant = w * a + x * b + y * c;
        let [light, along_x, along_y] = self.light;
        // Not where rounding has eaten it.
        if determinant <= w * xx * yy * 1e-5 {
            return light / w;
        }
        (light * a + along_x * b + along_y * c) / determinant
    }
}

impl Fit<'_> {
    /// The nearness of other surfaces at every place, averaged over the places around.
    pub fn nearness(&self) -> Vec<f32> {
        (0..self.places.len()).into_par_iter().with_min_len(256).map(|i| self.smooth_nearness(i)).collect()
    }

    fn smooth_nearness(&self, i: usize) -> f32 {
        let (mut weight, mut sum) = (0.0, 0.0);
        self.around(i, SMOOTH, |place, w, _| {
            sum += w * place.nearness;
            weight += w;
        });
        if weight > 0.0 { sum / weight } else { 0.0 }
    }

    /// What all places around tell of the light at place `i`, never less than nothing; `None` where there is none.
    pub fn light(&self, i: usize) -> Option<Color> {
        let place = &self.places[i];
        if place.point.depth == 0 {
            return None;
        }
        let frame = Frame::from_normal(place.point.n);
        // Coordinates of about 1, so that sums of their squares neither overflow nor vanish.
        let scale = 1.0 / (self.radius * place.point.apart);
        let mut sums = Sums::NONE;
        self.around(i, self.radius, |other, w, d| {
            // Light changes fast around one of them.
            let nearness = place.nearness.max(other.nearness);
            if d.length_squared() * nearness * nearness <= REACH * REACH {
                sums.add(w, [d.dot(frame.s) * scale, d.dot(frame.t) * scale], other.light);
            }
        });
        Some(sums.solve().map(|v| v.max(0.0)))
    }

    /// Calls `f` for the places on the surface of place `i` within a radius in pixels: with their weight, and the way to
    /// them.
    #[inline(always)]
    fn around(&self, i: usize, radius: f32, mut f: impl FnMut(&Place, f32, Vec3)) {
        let here = &self.places[i].point;
        if here.depth == 0 {
            return;
        }
        let (columns, rows) = (self.width, self.places.len() / self.width);
        let (x, y) = (i % columns, i / columns);
        let reach = radius as usize;
        let across = x.saturating_sub(reach)..(x + reach + 1).min(columns);
        // Pixels next to each other may show far ends of one plane.
        let within = FAR * (radius + 1.0) * here.apart;
        let shrink = 1.0 / (radius * radius);
        for v in y.saturating_sub(reach)..(y + reach + 1).min(rows) {
            let dy = v.abs_diff(y);
            for u in across.clone() {
                let dx = u.abs_diff(x);
                let w = 1.0 - (dx * dx + dy * dy) as f32 * shrink;
                let other = &self.places[v * columns + u];
                if w > 0.0 && same(here, &other.point, within) {
                    f(other, w, other.point.p - here.p);
                }
            }
        }
    }
}

/// Most distance to a place, as a factor on that of so many pixels.
const FAR: f32 = 2.0;
