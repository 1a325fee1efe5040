//! The search for images of lamps: Newton's method over film positions.
//!
//! A camera ray is followed through specular surfaces, and the direction in which it leaves the last of them is
//! compared with that to the lamp. Two neighbouring rays tell how the difference changes with the film position, hence
//! where it vanishes, and how large the lamp's image is there (as in manifold walks, Jakob and Marschner 2012, with
//! differences in place of derivatives).

use std::collections::HashMap;

use rayon::prelude::*;

use super::super::Task;
use super::borders::{Borders, borders, seen_small};
use super::{Image, Images};
use crate::bsdf::Transport;
use crate::emitter::SceneSphere;
use crate::math::{Frame, Mat2, Ray, Vec2};
use crate::sampling::{CounterRng, mix};
use crate::transport::Vertex;

/// Most film positions that searches begin from, all over the picture.
const STARTS: u64 = 1 << 14;

/// Further searches around each image that is found, each time it is done: bumpy glass shows a lamp many times.
const AROUND: u64 = 8;

/// How often that is done at most, and images above which it ends.
const ROUNDS: u64 = 3;
const ENOUGH: usize = 1 << 13;

/// Steps of Newton's method.
const STEPS: u32 = 8;

/// Distance of the neighbouring rays, in pixels: far above what rounding does to a direction.
const APART: f32 = 1.0 / 64.0;

/// Rays that miss the lamp by more (an angle in radians, or nearly) are not bent towards it.
const FAR: f32 = 0.7;

/// Images of more area (in pixels) are found by camera samples.
const LARGE: f32 = 1.0;

/// Parallelograms are so many times as large as they would be if rays changed linearly with the film position.
const MARGIN: f32 = 1.5;

/// Most rays of a camera path that are followed.
const LONGEST: u32 = 12;

/// The images of lamps smaller than a pixel, and the pixels that see the border of a larger one; `None` where a scene can
/// have none, or has none. The same task gives the same images.
pub fn search(task: Task<'_>) -> Option<Images> {
    let Task { scene, facts, view, .. } = task;
    // A lens blurs what it sees, and in media paths may end anywhere.
    if facts.media || view.sensor.has_aperture() {
        return None;
    }
    let lamps = scene.geometry.extents(|shape| scene.shapes[shape as usize].emitter.is_some());
    if lamps.is_empty() {
        return None;
    }
    let Borders { seen: mut images, rare } = borders(task);
    images.extend(seen_small(task, &lamps));
    if facts.specular {
        images.extend(small(task, lamps));
    }
    let images = Images::new(&images, &rare, &view.film, &view.filter);
    (!images.is_empty()).then_some(images)
}

/// The images of lamps smaller than a pixel.
fn small(task: Task<'_>, lamps: Vec<SceneSphere>) -> Vec<Image> {
    let Task { view, settings, .. } = task;
    let pixels = view.film.pixel_count() as u64;
    let starts = pixels.min(STARTS);
    let spacing = (pixels as f32 / starts.max(1) as f32).sqrt();
    let searcher = Search { task, lamps, spacing, longest: LONGEST.min(settings.max_depth.0) };
    let [x0, y0, width, height] = view.film.crop.map(|v| v as f32);
    let (low, size) = (Vec2::new(x0, y0), Vec2::new(width, height));
    let columns = (width / spacing).ceil().max(1.0);
    let place = |i: u64, rng: &mut CounterRng| {
        let cell = Vec2::new(i as f32 % columns, (i as f32 / columns).floor());
        low + ((cell + Vec2::from(rng.next_2d())) * spacing).min(size)
    };
    let mut found = Found::default();
    searcher.look(&mut found, 0, starts, place);
    let mut known = 0;
    for round in 1..=ROUNDS {
        let centres: Vec<Vec2> = found.images[known..].iter().map(|image| image.centre).collect();
        if centres.is_empty() || found.images.len() >= ENOUGH {
            break;
        }
        known = found.images.len();
        searcher.look(&mut found, round, centres.len() as u64 * AROUND, |i, rng| {
            centres[(i / AROUND) as usize] + (Vec2::from(rng.next_2d()) * 2.0 - 1.0) * spacing
        });
    }
    found.images
}

struct Search<'a> {
    task: Task<'a>,
    lamps: Vec<SceneSphere>,
    /// Of the starts, in pixels.
    spacing: f32,
    longest: u32,
}

/// A camera ray behind the last specular surface that it met.
struct Exit {
    ray: Ray,
    /// Of the shapes that it met.
    way: u64,
    at_lamp: bool,
}

/// How a camera ray misses a lamp.
struct Slopes {
    /// Its direction less that to the middle of the lamp, across the latter.
    miss: Vec2,
    /// How that changes with the film position, per pixel.
    slopes: Mat2,
    /// Radius of the lamp over its distance.
    reach: f32,
}

/// The images so far.
#[derive(Default)]
struct Found {
    images: Vec<Image>,
    /// By the pixel that holds the centre of each.
    by_pixel: HashMap<[i32; 2], Vec<usize>>,
}

impl Found {
    /// Adds an image unless its centre lies in one that is known: the same image is found from many places.
    fn add(&mut self, image: Image) {
        let centre = image.centre;
        let pixel = centre.floor().as_ivec2().to_array();
        let known = self.by_pixel.entry(pixel).or_default();
        if !known.iter().any(|&i| self.images[i].contains(centre)) {
            known.push(self.images.len());
            self.images.push(image);
        }
    }
}

impl Search<'_> {
    /// Searches from `count` places.
    fn look(
        &self,
        found: &mut Found,
        round: u64,
        count: u64,
        place: impl Fn(u64, &mut CounterRng) -> Vec2 + Sync,
    ) {
        let search = |i: u64| {
            let key = mix(self.task.settings.seed ^ mix(0x1a3b_1a6e + round) ^ i);
            let mut rng = CounterRng::new(key, 0);
            self.image(place(i, &mut rng), key)
        };
        let images: Vec<Image> =
            (0..count as u32).into_par_iter().with_min_len(64).filter_map(|i| search(u64::from(i))).collect();
        images.into_iter().for_each(|image| found.add(image));
    }

    /// The image near a film position, in pixels, along the way that `key` chooses where surfaces split light.
    fn image(&self, start: Vec2, key: u64) -> Option<Image> {
        // A chain of a few steps, none of them longer than the places where searches begin lie apart.
        let longest = 2.0 * self.spacing;
        let mut at = start;
        let mut here = self.follow(at, key)?;
        let lamp = self.nearest_lamp(&here)?;
        for step in 0..STEPS {
            let Slopes { miss, slopes, reach } = self.slopes(at, &here, key, lamp)?;
            let inverse = slopes.inverse();
            let newton = -(inverse * miss);
            // The image of a square around the lamp.
            let sides = inverse * reach;
            let area = 4.0 * sides.determinant().abs();
            let hopeless = step == 0 && newton.length() > 2.0 * longest;
            if hopeless || !newton.is_finite() || area.is_nan() || area > LARGE {
                return None;
            }
            // The slopes are those at a place that sees the lamp's middle half, or nearly so.
            if miss.length() < 0.5 * reach {
                return self.checked(at + newton, sides, key);
            }
            at += newton.clamp_length_max(longest);
            here = self.follow(at, key)?;
        }
        None
    }

    /// How a camera ray misses the lamp; `None` where neighbouring rays take other ways, or are parallel to it.
    fn slopes(&self, at: Vec2, here: &Exit, key: u64, lamp: &SceneSphere) -> Option<Slopes> {
        let to_lamp = lamp.center - here.ray.o;
        let frame = Frame::from_normal(to_lamp.normalize_or_zero());
        let miss = |exit: &Exit| {
            let off = frame.to_local(exit.ray.d - (lamp.center - exit.ray.o).normalize_or_zero());
            Vec2::new(off.x, off.y)
        };
        let miss_here = miss(here);
        if miss_here.length() > FAR {
            return None;
        }
        let slope = |way: Vec2| {
            let there = self.follow(at + way, key).filter(|there| there.way == here.way)?;
            Some((miss(&there) - miss_here) / APART)
        };
        let slopes = Mat2::from_cols(slope(Vec2::X * APART)?, slope(Vec2::Y * APART)?);
        let sound = slopes.determinant().abs() > f32::MIN_POSITIVE;
        sound.then_some(Slopes { miss: miss_here, slopes, reach: lamp.radius / to_lamp.length() })
    }

    /// The image around a film position, where the lamp is seen indeed.
    fn checked(&self, at: Vec2, sides: Mat2, key: u64) -> Option<Image> {
        // Film positions are numbers of single precision.
        let least = Mat2::from_diagonal(self.task.view.film.size() * (4.0 * f32::EPSILON));
        let image = Image::new(at, sides * MARGIN + least)?;
        self.follow(at, key)?.at_lamp.then_some(image)
    }

    /// The lamp that a ray misses least, if that is ahead of it.
    fn nearest_lamp(&self, exit: &Exit) -> Option<&SceneSphere> {
        let cosine = |lamp: &SceneSphere| (lamp.center - exit.ray.o).normalize_or_zero().dot(exit.ray.d);
        let nearest = self.lamps.iter().max_by(|a, b| cosine(a).total_cmp(&cosine(b)))?;
        (cosine(nearest) > 0.0).then_some(nearest)
    }

    /// The camera ray through a film position behind the last specular surface that it meets; `None` where it meets
    /// none.
    fn follow(&self, at: Vec2, key: u64) -> Option<Exit> {
        let Task { scene, view, .. } = self.task;
        let mut exit =
            Exit { ray: view.sensor.ray(at / view.film.size(), Vec2::ZERO), way: 0, at_lamp: false };
        let mut choice = CounterRng::new(key, 1);
        for _ in 0..self.longest {
            let Some(hit) = scene.geometry.closest(&exit.ray) else { break };
            let s = scene.surface(&exit.ray, &hit);
            if scene.is_lamp(&s) {
                exit.at_lamp = true;
                break;
            }
            let vertex = Vertex::new(scene, &s, -exit.ray.d);
            let straight = choice.next_f32() < vertex.closure.transparency();
            let deltas = vertex.closure.deltas(vertex.wi, Transport::Radiance);
            // All branches alike, however little light they carry: an image in glass may outshine what is behind it.
            let pick = choice.next_f32();
            let wo = if straight {
                -vertex.wi
            } else {
                let count = deltas.iter().count();
                let Some(lobe) = deltas.iter().nth((pick * count as f32) as usize) else { break };
                exit.way = mix(exit.way ^ u64::from(s.shape) << 1 ^ u64::from(lobe.wo.z * vertex.wi.z > 0.0));
                lobe.wo
            };
            exit.ray = s.leave(s.frame.to_world(wo));
        }
        (exit.way != 0).then_some(exit)
    }
}
