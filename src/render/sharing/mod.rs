//! Camera samples of a pass share the indirect light that they find: path space filtering (Keller, Dahm and Binder 2014).
//! On a diffuse surface that light differs little from one pixel to the next, while what the few rays of a sample bring
//! is mostly noise. The light around each pixel is fitted by local linear regression, whose error, like that of a photon
//! map, vanishes with the radius.

mod fit;

use rayon::prelude::*;

use crate::film::{Layer, Radiance, Rejected, StoredMean};
use crate::integrator::{CameraSample, DiffusePoint, Task};
use crate::math::{Color, Frame, Ray, Vec3, lifted};
use crate::sampling::{Sampler, mix, warp};

use fit::Fit;

/// Cosine of the angle between normals that share light.
const SAME: f32 = 0.995;

/// Distance from the plane of a surface to what counts as the same surface, as a share of the whole distance.
const FLAT: f32 = 0.1;

/// What a pixel sees of a diffuse surface, and the light that its samples found there.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The mean of its samples. Its scale is their sum, by the weights of the filter; its depth is 0 where there is none.
    point: DiffusePoint,
    /// Radiance, its mean over the hemisphere by the cosine: irradiance over π.
    light: Color,
    /// Inverse distance to other surfaces: at first in one direction, then the mean of those around.
    nearness: f32,
}

impl Place {
    /// No place.
    pub const NONE: Self = Self {
        point: DiffusePoint { p: Vec3::ZERO, n: Vec3::ZERO, depth: 0, apart: 0.0, scale: Color::ZERO },
        light: Color::ZERO,
        nearness: 0.0,
    };
}

/// Whether two points lie on the same surface, so near that light is shared.
#[inline(always)]
fn same(a: &DiffusePoint, b: &DiffusePoint, within: f32) -> bool {
    let d = b.p - a.p;
    let (square, off) = (d.length_squared(), d.dot(a.n));
    a.depth == b.depth
        && a.n.dot(b.n) > SAME
        && square <= within * within
        && off * off <= FLAT * FLAT * square
}

/// Takes the indirect light of a pixel's samples from them where it is to be shared: of all that lie on the surface of
/// the first one. `weights` are those of the film's filter.
pub fn take(samples: &mut [CameraSample], weights: &[f32]) -> Place {
    let first = samples.iter().find_map(|sample| sample.diffuse);
    let Some(first) = first else { return Place::NONE };
    let each = 1.0 / samples.len() as f32;
    let mut place = Place::NONE;
    let mut count = 0.0;
    for (sample, weight) in samples.iter_mut().zip(weights) {
        let indirect = &mut sample.out.layers[Layer::Indirect as usize];
        let Some(point) = sample.diffuse.filter(|point| same(&first, point, PIXEL * first.apart)) else {
            continue;
        };
        if indirect.is_finite() {
            place.light += *indirect / point.scale;
            place.point.p += point.p - first.p;
            place.point.scale += point.scale * (weight * each);
            *indirect = Color::ZERO;
            count += 1.0;
        }
    }
    if count > 0.0 {
        place.light /= count;
        place.point = DiffusePoint { p: first.p + place.point.p / count, scale: place.point.scale, ..first };
    }
    place
}

/// Most distance between samples of a pixel, as a factor on that to the next pixel.
const PIXEL: f32 = 2.0;

/// How the samples of a pass share light.
pub struct Sharing<'a> {
    /// What is rendered.
    pub task: Task<'a>,
    /// Its number.
    pub pass: u32,
    /// In pixels.
    pub radius: f32,
}

impl Sharing<'_> {
    /// Gives every pixel its share of the light that was taken from all. Returns how many rays it took, and what was not
    /// finite.
    pub fn share(&self, places: &mut [Place], means: &mut [StoredMean]) -> (u64, Rejected) {
        let width = self.task.view.film.crop[2] as usize;
        let look = |(row, places): (usize, &mut [Place])| self.look_around(row, places);
        let rays = places.par_chunks_mut(width).enumerate().map(look).sum();
        let fit = Fit { width, radius: self.radius, places };
        let nearness = fit.nearness();
        places.iter_mut().zip(nearness).for_each(|(place, nearness)| place.nearness = nearness);
        let fit = Fit { width, radius: self.radius, places };
        let give = |(row, means): (usize, &mut [StoredMean])| {
            let mut rejected = Rejected::default();
            for (x, mean) in means.iter_mut().enumerate() {
                let i = row * width + x;
                if let Some(light) = fit.light(i) {
                    let mut out = Radiance::default();
                    out.add(Layer::Indirect, light * fit.places[i].point.scale);
                    self.task.view.response.apply(&mut out);
                    mean.add(&out, &mut rejected);
                }
            }
            rejected
        };
        let given: Vec<Rejected> = means.par_chunks_mut(width).enumerate().map(give).collect();
        let mut rejected = Rejected::default();
        given.iter().for_each(|row| rejected.add(row));
        (rays, rejected)
    }

    /// How near a surface around each place is, by a ray of its own: told from those that found light, light from near would
    /// weigh more or less than other light. Returns how many rays.
    fn look_around(&self, row: usize, places: &mut [Place]) -> u64 {
        let (scene, settings) = (self.task.scene, self.task.settings);
        let [x0, y0, ..] = self.task.view.film.crop.map(u64::from);
        let (mut rays, mut owners) = (Vec::new(), Vec::new());
        for (i, place) in places.iter().enumerate().filter(|(_, place)| place.point.depth > 0) {
            let DiffusePoint { p, n, .. } = place.point;
            let frame = Frame::from_normal(n);
            let key = mix(settings.seed ^ AROUND ^ mix((y0 + row as u64) << 32 | (x0 + i as u64)));
            let d = frame.to_world(warp::cosine_hemisphere(Sampler::new(key, self.pass).next_2d()));
            rays.push(Ray::new(lifted(p, n), d));
            owners.push(i);
        }
        let all: Vec<usize> = (0..rays.len()).collect();
        let mut hits = vec![None; rays.len()];
        scene.geometry.closest_each(&rays, &all, &mut hits);
        for ((ray, hit), &owner) in rays.iter().zip(&hits).zip(&owners) {
            let Some(hit) = hit else { continue };
            let sharp = scene.material(&scene.surface(ray, hit)).nature().sharper_than(settings.glossy);
            let factor = if sharp { FOCUSING } else { 1.0 };
            let place = &mut places[owner];
            place.nearness = factor / hit.t.max(NEAREST * place.point.apart);
        }
        rays.len() as u64
    }
}

/// Tells the random numbers of these rays from those of paths.
const AROUND: u64 = 0x100c_a400;

/// Specular surfaces count as so many times nearer: light that they focus changes faster.
const FOCUSING: f32 = 4.0;

/// No surface counts as nearer than this share of the distance between pixels.
const NEAREST: f32 = 0.01;
