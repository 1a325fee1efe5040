//! The camera samples of a pass, in bands of the picture that threads share.

use std::ops::Range;

use rayon::prelude::*;

use super::aovs::{Eye, Start};
use super::extra::Pixel;
use super::noise::{Noise, even_passes};
use super::sharing::{Place, Sharing, take};
use crate::film::{Aov, Mean, PassSums, Radiance, Rejected, StoredMean};
use crate::integrator::images::Images;
use crate::integrator::{CameraSample, Integrator, Scratch, Task};
use crate::math::{Color, Ray, Vec2, Vec3};
use crate::photon::trace::Halt;
use crate::sampling::{Sampler, mix};
use crate::scene::View;

/// Rows of a block: a unit of parallel work is a band of the picture this high, walked in squares so
/// that neighbouring lookups share cache lines.
const BLOCK: usize = 8;

/// Columns that are sampled together: enough to keep bundles of rays full when most paths have ended.
const SQUARE: usize = 32;

/// Bytes that a pass holds for each pixel while its samples share light.
pub const SHARED_BYTES: usize = size_of::<Place>();

/// What all bands of a pass share.
pub(super) struct Bands<'a, I: Integrator> {
    task: Task<'a>,
    eye: Option<Eye<'a>>,
    /// Of lamps that look smaller than a pixel.
    images: Option<&'a Images>,
    integrator: &'a I,
    shared: &'a I::Pass,
    pass: u32,
    /// Samples of each pixel in the passes that take as many in all.
    each: u32,
    /// How many passes those are; 0 for all.
    even: u32,
    /// Of each pixel in the other passes.
    counts: &'a [u16],
    /// Of a pixel, as a share of the film.
    pixel: Vec2,
    has_aperture: bool,
    halt: Halt<'a>,
}

/// Camera samples of a square of pixels, in the order in which they are drawn.
struct Square {
    samples: Vec<CameraSample>,
    /// Of the filter, for each sample.
    weights: Vec<f32>,
    /// Of each ray, where AOVs are made or lamps look small.
    starts: Vec<Start>,
    /// Pixels of the band.
    places: Vec<usize>,
    /// Where the samples of each of them begin, and where those of the last one end.
    first: Vec<usize>,
    /// Further samples of pixels, by the place of the pixel among `places`.
    extra: Vec<(usize, Vec<(Radiance, f32)>)>,
}

impl Square {
    fn of_pixel(&self, owner: usize) -> Range<usize> {
        self.first[owner]..self.first[owner + 1]
    }
}

impl<'a, I: Integrator> Bands<'a, I> {
    /// Of a pass. `counts` are the samples of each pixel in passes that do not take as many in all.
    pub fn new(
        task: Task<'a>,
        integrator: &'a I,
        shared: &'a I::Pass,
        pass: u32,
        counts: &'a [u16],
        halt: Halt<'a>,
    ) -> Self {
        let film = &task.view.film;
        Self {
            task,
            eye: Eye::new(task.scene, task.view),
            images: integrator.images(),
            integrator,
            shared,
            pass,
            each: integrator.samples_a_pass(),
            even: even_passes(integrator),
            counts,
            pixel: Vec2::new(1.0 / film.width as f32, 1.0 / film.height as f32),
            has_aperture: task.view.sensor.has_aperture(),
            halt,
        }
    }

    /// Samples every pixel into `sums`, and says of every band what it took, and whether all of it was sampled before a
    /// halt. What the samples brought is added to `noise`, unless that is empty.
    pub fn sample(&self, sums: &mut PassSums, noise: &mut [Noise]) -> Vec<(Scratch, Rejected, bool)> {
        let band = self.task.view.film.crop[2] as usize * BLOCK;
        let numbers = Aov::numbers_of(&self.task.view.aovs);
        let radius = self.integrator.sharing(self.pass);
        let mut places = vec![Place::NONE; radius.map_or(0, |_| sums.means.len())];
        let size = band.min(places.len());
        let bands = sums.means.chunks_mut(band).zip(chunks(&mut sums.aovs, band * numbers));
        let known = band.min(noise.len());
        let bands: Vec<_> = bands.zip(chunks(&mut places, size)).zip(chunks(noise, known)).collect();
        let sample = |(b, (((means, aovs), places), noise))| self.band(b, means, aovs, places, noise);
        let mut done: Vec<_> = bands.into_par_iter().enumerate().map(sample).collect();
        // Also where a halt has left some pixels out: what was taken from the others is theirs.
        if let Some(radius) = radius {
            let sharing = Sharing { task: self.task, pass: self.pass, radius };
            let (rays, rejected) = sharing.share(&mut places, &mut sums.means);
            if let Some((scratch, all, _)) = done.first_mut() {
                scratch.rays += rays;
                all.add(&rejected);
            }
        }
        done
    }

    /// Samples band `b`.
    fn band(
        &self,
        b: usize,
        means: &mut [StoredMean],
        aovs: &mut [f64],
        places: &mut [Place],
        noise: &mut [Noise],
    ) -> (Scratch, Rejected, bool) {
        let [_, _, width, height] = self.task.view.film.crop.map(|v| v as usize);
        let mut scratch = Scratch::default();
        let mut rejected = Rejected::default();
        aovs.fill(0.0);
        let rows = (height - b * BLOCK).min(BLOCK);
        let capacity = BLOCK * SQUARE;
        let mut square = Square {
            samples: Vec::with_capacity(capacity),
            weights: Vec::with_capacity(capacity),
            starts: Vec::new(),
            places: Vec::with_capacity(capacity),
            first: Vec::with_capacity(capacity + 1),
            extra: Vec::new(),
        };
        for column in (0..width).step_by(SQUARE) {
            if self.halt.stopped() || self.halt.late() {
                return (scratch, rejected, false);
            }
            self.draw(b, rows, column, &mut square);
            self.look_for_images(b, &mut square, &mut scratch);
            self.integrator.sample(self.shared, &mut square.samples, &mut scratch);
            let mut extra = std::mem::take(&mut square.extra).into_iter().peekable();
            for (owner, &at) in square.places.iter().enumerate() {
                let of_pixel = square.of_pixel(owner);
                let (samples, weights) = (&mut square.samples[of_pixel.clone()], &square.weights[of_pixel]);
                share(samples, weights, places.get_mut(at), noise.get_mut(at));
                let more = extra.next_if(|(of, _)| *of == owner).map(|(_, samples)| samples);
                means[at] = self.mean(samples, weights, more, &mut rejected);
            }
            if let Some(eye) = &self.eye {
                scratch.rays += self.look(eye, &square, aovs);
            }
        }
        (scratch, rejected, true)
    }

    /// Of the samples of a pixel, and of those that it takes more.
    #[inline(always)]
    fn mean(
        &self,
        samples: &mut [CameraSample],
        weights: &[f32],
        more: Option<Vec<(Radiance, f32)>>,
        rejected: &mut Rejected,
    ) -> StoredMean {
        samples.iter_mut().for_each(|sample| self.task.view.response.apply(&mut sample.out));
        if let ([only], [weight], None) = (&*samples, weights, &more) {
            return StoredMean::of_one(&only.out, *weight, rejected);
        }
        let each = samples.len() as f32;
        let mut mean = Mean::default();
        for (sample, weight) in samples.iter().zip(weights) {
            mean.add(&sample.out, weight / each, rejected);
        }
        for (mut out, weight) in more.into_iter().flatten() {
            self.task.view.response.apply(&mut out);
            mean.add(&out, weight / each, rejected);
        }
        mean.stored(1.0)
    }

    /// Takes the extra samples of those pixels of a square that see lamps smaller than themselves, and leaves the
    /// samples of the square their share of that light.
    fn look_for_images(&self, b: usize, square: &mut Square, scratch: &mut Scratch) {
        let Some(all) = self.images else { return };
        let film = &self.task.view.film;
        let [x0, y0, width, _] = film.crop.map(|v| v as usize);
        let full = film.size();
        for (owner, &place) in square.places.iter().enumerate() {
            let number = b * BLOCK * width + place;
            let images = all.of(number);
            let of_pixel = square.of_pixel(owner);
            let counts = [of_pixel.len() as f32, all.samples(number, self.each)];
            if counts[1] == 0.0 {
                continue;
            }
            let at = [x0 + number % width, y0 + number / width];
            let pixel = Pixel { task: self.task, images, at, pass: self.pass, counts };
            for (sample, start) in square.samples[of_pixel.clone()].iter_mut().zip(&square.starts[of_pixel]) {
                sample.rivals = pixel.weight(start.place * full).1;
            }
            square.extra.push((owner, pixel.samples(&mut scratch.rays)));
        }
    }

    /// Adds the samples of a square to the AOVs of the band, and counts the rays.
    fn look(&self, eye: &Eye<'_>, square: &Square, aovs: &mut [f64]) -> u64 {
        let numbers = Aov::numbers_of(&self.task.view.aovs);
        let mut rays = 0;
        for (owner, place) in square.places.iter().enumerate() {
            let (of_pixel, at) = (square.of_pixel(owner), place * numbers);
            let share = 1.0 / of_pixel.len() as f64;
            for i in of_pixel {
                let (sample, start, weight) = (&square.samples[i], square.starts[i], square.weights[i]);
                rays += eye.add(sample, start, weight, share, &mut aovs[at..at + numbers]);
            }
        }
        rays
    }

    /// Camera rays of the square of band `b` that begins at `column`.
    fn draw(&self, b: usize, rows: usize, column: usize, square: &mut Square) {
        let film = &self.task.view.film;
        let [x0, y0, width, _] = film.crop.map(|v| v as usize);
        square.samples.clear();
        square.weights.clear();
        square.starts.clear();
        square.places.clear();
        square.first.clear();
        for row in 0..rows {
            for x in column..(column + SQUARE).min(width) {
                let place = row * width + x;
                square.first.push(square.samples.len());
                let numbers = self.numbers(b * BLOCK * width + place);
                self.draw_pixel([x0 + x, y0 + b * BLOCK + row], numbers, square);
                square.places.push(place);
            }
        }
        square.first.push(square.samples.len());
    }

    /// Of the samples of a pixel in its sequence, where each pass goes on after the one before.
    #[inline(always)]
    fn numbers(&self, pixel: usize) -> Range<u32> {
        let (even, each) = if self.pass < self.even || self.counts.is_empty() {
            (0, self.each)
        } else {
            (self.even, u32::from(self.counts[pixel]))
        };
        let first = even.wrapping_mul(self.each).wrapping_add((self.pass - even).wrapping_mul(each));
        first..first.wrapping_add(each)
    }

    #[inline]
    fn draw_pixel(&self, [px, py]: [usize; 2], numbers: Range<u32>, square: &mut Square) {
        let View { sensor, filter, .. } = self.task.view;
        // Keyed by the place on the full film: a crop shows the same noise.
        let pixel = (py as u64) << 32 | px as u64;
        for index in numbers {
            let key = mix(self.task.settings.seed ^ mix(pixel));
            let sampler = Sampler::new(key, index).stratified(I::STRATIFIED_PAIRS);
            let ray = Ray::new(Vec3::ZERO, Vec3::Z);
            // Completed in its place: to copy numbers that were just written takes as long as to compute them.
            square.samples.push(CameraSample::new(ray, sampler));
            let sample = square.samples.last_mut().expect("a sample was pushed");
            let sampler = &mut sample.sampler;
            let (offset, weight) = filter.sample(sampler.next_2d());
            let place = (Vec2::new(px as f32 + 0.5, py as f32 + 0.5) + offset) * self.pixel;
            let aperture = if self.has_aperture { sampler.next_2d() } else { Vec2::ZERO };
            sample.ray = sensor.ray(place, aperture);
            square.weights.push(weight);
            if self.eye.is_some() || self.images.is_some() {
                square.starts.push(Start { place, aperture });
            }
        }
    }
}

/// Of a pixel: takes from its samples the light that is to be shared, if any is, and adds what they brought to its noise, if
/// that is wanted.
#[inline(always)]
fn share(
    samples: &mut [CameraSample],
    weights: &[f32],
    place: Option<&mut Place>,
    noise: Option<&mut Noise>,
) {
    let Some(noise) = noise else {
        if let Some(place) = place {
            *place = take(samples, weights);
        }
        return;
    };
    let all: Vec<Color> = samples.iter().map(|sample| sample.out.sum()).collect();
    if let Some(place) = place {
        *place = take(samples, weights);
    }
    for ((sample, all), weight) in samples.iter().zip(all).zip(weights) {
        noise.add(all * *weight, sample.out.sum() * *weight);
    }
}

/// Chunks of `size`; without end and empty where there are no numbers.
fn chunks<T>(list: &mut [T], size: usize) -> impl Iterator<Item = &mut [T]> {
    let empty = if size == 0 { usize::MAX } else { 0 };
    list.chunks_mut(size.max(1)).chain(std::iter::repeat_with(Default::default).take(empty))
}
