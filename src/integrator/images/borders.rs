//! Lamps that the camera sees without a detour: pixels on the border of a lamp, seen directly or in mirrors and glass, and
//! lamps smaller than a pixel. Nothing else of what a pixel sees differs as much within it, and a sample that finds out costs
//! a few rays.

use rayon::prelude::*;

use super::super::Task;
use super::Image;
use super::shine::{Shine, shine};
use crate::emitter::SceneSphere;
use crate::math::{Mat2, Vec2};
use crate::sampling::{Sampler, mix};
use crate::spectrum::luminance;

/// A pixel sees a border if its darkest corner sees less than this share of what its brightest one sees.
const DARKER: f32 = 0.5;

/// The same for the square around a small lamp, as a multiple of its radius: seen at an angle it is longer.
const MARGIN: f32 = 1.2;

/// Lamps of a larger radius, in pixels, have a corner of a pixel in them wherever they are.
const SMALL: f32 = 1.0;

/// Lamps that are looked at: of more, most are part of something larger.
const MOST: usize = 4096;

/// Squares around those of `lamps` that the camera sees directly and that no corner of a pixel may lie in.
pub fn seen_small(task: Task<'_>, lamps: &[SceneSphere]) -> Vec<Image> {
    let sensor = &task.view.sensor;
    let film = &task.view.film;
    let square = |lamp: &SceneSphere| {
        let place = sensor.connect(lamp.center, Vec2::ZERO)?.importance.film;
        let distance = sensor.depth(lamp.center);
        let radius = lamp.radius / sensor.pixel_footprint(film.height, distance);
        let mut sampler = Sampler::new(task.settings.seed, 0).stratified(0);
        let mut shines =
            || shine(task, sensor.ray(place, Vec2::ZERO), &mut sampler, |_| 1.0).light.max_element() > 0.0;
        let least = film.size().max_element() * (4.0 * f32::EPSILON);
        let half = Vec2::splat(MARGIN * radius + least);
        if radius < SMALL && shines() {
            Image::new(place * film.size(), Mat2::from_diagonal(half))
        } else {
            None
        }
    };
    lamps.iter().take(MOST).filter_map(square).collect()
}

/// Light of a lamp is rare if camera samples see it along ways of less chance than this.
const RARE: f32 = 0.5;

/// What the corners of pixels see.
pub struct Borders {
    /// Squares of the pixels of which some corners see a lamp and others do not, or one that is much darker, or one along
    /// a rare way.
    pub seen: Vec<Image>,
    /// Numbers of other pixels of which a corner has rare ways, which could see a lamp from elsewhere in the pixel.
    pub rare: Vec<usize>,
}

/// What is seen along the corner of a pixel: little, since all of the picture's are held at once.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// Luminance of lamps.
    light: f32,
    /// Most of it, in the mean square, comes along rare ways.
    rarely: bool,
    /// There are rare ways.
    ways: bool,
}

impl Corner {
    fn of(seen: &Shine) -> Self {
        let light = luminance(seen.light);
        Self { light, rarely: light * light < RARE * seen.square, ways: seen.rarest < RARE }
    }
}

/// Looks along the corners of all pixels.
pub fn borders(task: Task<'_>) -> Borders {
    let film = &task.view.film;
    let [x0, y0, width, height] = film.crop;
    let size = film.size();
    let corner = |x: u32, y: u32| {
        // Where glass splits light too often, ways are chosen by chance.
        let key = mix(task.settings.seed ^ 0x0b04_de45);
        let mut sampler = Sampler::new(key, y * (width + 1) + x).stratified(0);
        let at = Vec2::new((x0 + x) as f32, (y0 + y) as f32);
        let ray = task.view.sensor.ray(at / size, Vec2::ZERO);
        Corner::of(&shine(task, ray, &mut sampler, |_| 1.0))
    };
    let rows: Vec<Vec<Corner>> =
        (0..=height).into_par_iter().map(|y| (0..=width).map(|x| corner(x, y)).collect()).collect();
    let square = |x: usize, y: usize| {
        let centre = Vec2::new((x0 as usize + x) as f32 + 0.5, (y0 as usize + y) as f32 + 0.5);
        Image::new(centre, Mat2::from_diagonal(Vec2::splat(0.5)))
    };
    let pairs = rows.windows(2).enumerate();
    let pixels = pairs.flat_map(|(y, rows)| {
        (0..width as usize).map(move |x| (x, y, [rows[0][x], rows[0][x + 1], rows[1][x], rows[1][x + 1]]))
    });
    let differ = |corners: &[Corner; 4]| {
        let light = corners.map(|corner| corner.light);
        let [least, most] = light.iter().fold([f32::INFINITY, 0.0], |[a, b], c| [a.min(*c), b.max(*c)]);
        least < DARKER * most || corners.iter().any(|corner| corner.rarely)
    };
    let mut borders = Borders { seen: Vec::new(), rare: Vec::new() };
    for (x, y, corners) in pixels {
        if differ(&corners) {
            borders.seen.extend(square(x, y));
        } else if corners.iter().any(|corner| corner.ways) {
            borders.rare.push(y * width as usize + x);
        }
    }
    borders
}
