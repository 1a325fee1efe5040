//! The camera samples of a pass, in bands of the picture that threads share.

use rayon::prelude::*;

use super::aovs::{Eye, Start};
use super::extra::Pixel;
use super::sharing::{Place, Sharing, take};
use crate::film::{Aov, Mean, PassSums, Radiance, Rejected, StoredMean};
use crate::integrator::images::Images;
use crate::integrator::{CameraSample, Integrator, Scratch, Task};
use crate::math::{Ray, Vec2, Vec3};
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
    pub task: Task<'a>,
    pub eye: Option<Eye<'a>>,
    /// Of lamps that look smaller than a pixel.
    pub images: Option<&'a Images>,
    pub integrator: &'a I,
    pub shared: &'a I::Pass,
    pub pass: u32,
    /// Samples of each pixel.
    pub each: u32,
    /// Of a pixel, as a share of the film.
    pub pixel: Vec2,
    pub has_aperture: bool,
    pub halt: Halt<'a>,
}

/// Camera samples of a square of pixels, in the order in which they are drawn.
struct Square {
    samples: Vec<CameraSample>,
    /// Of the filter, for each sample.
    weights: Vec<f32>,
    /// Of each ray, where AOVs are made or lamps look small.
    starts: Vec<Start>,
    /// Pixels of the band; each has as many samples as the integrator takes in a pass.
    places: Vec<usize>,
    /// Further samples of pixels, by the place of the pixel among `places`.
    extra: Vec<(usize, Vec<(Radiance, f32)>)>,
}

impl<I: Integrator> Bands<'_, I> {
    /// Samples every pixel into `sums`, and says of every band what it took, and whether all of it was sampled before a
    /// halt.
    pub fn sample(&self, sums: &mut PassSums) -> Vec<(Scratch, Rejected, bool)> {
        let band = self.task.view.film.crop[2] as usize * BLOCK;
        let numbers = Aov::numbers_of(&self.task.view.aovs);
        let radius = self.integrator.sharing(self.pass);
        let mut places = vec![Place::NONE; radius.map_or(0, |_| sums.means.len())];
        let size = band.min(places.len());
        let bands = sums.means.chunks_mut(band).zip(chunks(&mut sums.aovs, band * numbers));
        let bands: Vec<_> = bands.zip(chunks(&mut places, size)).collect();
        let sample = |(b, ((means, aovs), places))| self.band(b, means, aovs, places);
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
    ) -> (Scratch, Rejected, bool) {
        let [_, _, width, height] = self.task.view.film.crop.map(|v| v as usize);
        let each = self.each as usize;
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
            extra: Vec::new(),
        };
        for column in (0..width).step_by(SQUARE) {
            if self.halt.stopped() || self.halt.late() {
                return (scratch, rejected, false);
            }
            self.draw(b, rows, column, &mut square);
            self.look_for_images(b, &mut square, &mut scratch);
            self.integrator.sample(self.shared, &mut square.samples, &mut scratch);
            let mut extra = square.extra.drain(..).peekable();
            let pixels = square.samples.chunks_mut(each).zip(square.weights.chunks(each)).zip(&square.places);
            for (owner, ((samples, weights), &at)) in pixels.enumerate() {
                if let Some(place) = places.get_mut(at) {
                    *place = take(samples, weights);
                }
                samples.iter_mut().for_each(|sample| self.task.view.response.apply(&mut sample.out));
                let more = extra.next_if(|(of, _)| *of == owner);
                if let ([only], [weight], None) = (&*samples, weights, &more) {
                    means[at] = StoredMean::of_one(&only.out, *weight, &mut rejected);
                    continue;
                }
                let mut mean = Mean::default();
                for (sample, weight) in samples.iter().zip(weights) {
                    mean.add(&sample.out, weight / each as f32, &mut rejected);
                }
                for (mut out, weight) in more.into_iter().flat_map(|(_, samples)| samples) {
                    self.task.view.response.apply(&mut out);
                    mean.add(&out, weight / each as f32, &mut rejected);
                }
                means[at] = mean.stored(1.0);
            }
            drop(extra);
            if let Some(eye) = &self.eye {
                scratch.rays += self.look(eye, &square, aovs);
            }
        }
        (scratch, rejected, true)
    }

    /// Takes the extra samples of those pixels of a square that see lamps smaller than themselves, and leaves the
    /// samples of the square their share of that light.
    fn look_for_images(&self, b: usize, square: &mut Square, scratch: &mut Scratch) {
        let Some(all) = self.images else { return };
        let film = &self.task.view.film;
        let [x0, y0, width, _] = film.crop.map(|v| v as usize);
        let (full, each) = (film.size(), self.each as usize);
        for (owner, &place) in square.places.iter().enumerate() {
            let number = b * BLOCK * width + place;
            let images = all.of(number);
            let counts = [self.each as f32, all.samples(number, self.each)];
            if counts[1] == 0.0 {
                continue;
            }
            let at = [x0 + number % width, y0 + number / width];
            let pixel = Pixel { task: self.task, images, at, pass: self.pass, counts };
            let of_pixel = owner * each..(owner + 1) * each;
            for (sample, start) in square.samples[of_pixel.clone()].iter_mut().zip(&square.starts[of_pixel]) {
                sample.rivals = pixel.weight(start.place * full).1;
            }
            square.extra.push((owner, pixel.samples(&mut scratch.rays)));
        }
    }

    /// Adds the samples of a square to the AOVs of the band, and counts the rays.
    fn look(&self, eye: &Eye<'_>, square: &Square, aovs: &mut [f64]) -> u64 {
        let (each, numbers) = (self.each as usize, Aov::numbers_of(&self.task.view.aovs));
        let mut rays = 0;
        let samples = square.samples.iter().zip(&square.weights).zip(&square.starts).enumerate();
        for (i, ((sample, weight), start)) in samples {
            let at = square.places[i / each] * numbers;
            rays += eye.add(sample, *start, *weight, 1.0 / each as f64, &mut aovs[at..at + numbers]);
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
        for row in 0..rows {
            for x in column..(column + SQUARE).min(width) {
                self.draw_pixel(x0 + x, y0 + b * BLOCK + row, square);
                square.places.push(row * width + x);
            }
        }
    }

    #[inline]
    fn draw_pixel(&self, px: usize, py: usize, square: &mut Square) {
        let View { sensor, filter, .. } = self.task.view;
        // Keyed by the place on the full film: a crop shows the same noise.
        let pixel = (py as u64) << 32 | px as u64;
        for number in 0..self.each {
            let index = self.pass.wrapping_mul(self.each).wrapping_add(number);
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

/// Chunks of `size`; without end and empty where there are no numbers.
fn chunks<T>(list: &mut [T], size: usize) -> impl Iterator<Item = &mut [T]> {
    let empty = if size == 0 { usize::MAX } else { 0 };
    list.chunks_mut(size.max(1)).chain(std::iter::repeat_with(Default::default).take(empty))
}
