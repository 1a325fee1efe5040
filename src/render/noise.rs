//! How noisy pixels are, and how many samples that makes them take.

use rayon::prelude::*;

use crate::film::{Counts, FilmSize};
use crate::integrator::Integrator;
use crate::math::{Color, LANES};
use crate::sampling::mix;

/// Camera samples of a pixel from which its noise is told.
const ENOUGH: u32 = 8;

/// Samples of a pixel of usual noise, for each that it takes in the first passes: what the noisy ones take more is
/// compensated in part. (With 1 and 0.5 the error after equal time is up to a tenth larger, on eight scenes.)
const USUAL: f64 = 0.7;

/// Most samples of a pixel in a pass, for each that it takes in the first passes.
const MOST: f64 = 8.0;

/// Luminance below this share of the picture's mean counts as if it were this.
const DARK: f64 = 0.1;

/// Pixels to each side that the noise of a pixel is told from: eight samples alone say little of it.
const AROUND: usize = 1;

/// Of the variance of light that samples nearby share, the part that is left.
const SHARED: f32 = 0.1;

/// Bytes that a render holds for each pixel until it knows the noise, and what it makes of it.
pub const NOISE_BYTES: usize = size_of::<Noise>() + size_of::<u16>();

/// Mean and sum of squared differences from it.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    mean: f32,
    squares: f32,
}

impl Moments {
    /// Adds the `n`-th value (Welford 1962).
    fn add(&mut self, value: f32, n: f32) {
        let before = value - self.mean;
        self.mean += before / n;
        self.squares += before * (value - self.mean);
    }
}

/// What the samples of a pixel brought in the first passes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    count: f32,
    all: Moments,
    /// Without what is shared.
    own: Moments,
}

impl Noise {
    /// Adds a sample: all of its light, and what it does not share. What is not finite never reaches the film.
    pub fn add(&mut self, all: Color, own: Color) {
        let [all, own] = [all, own].map(|c| c.sum_of_lanes() / LANES as f32);
        if all.is_finite() && own.is_finite() {
            self.count += 1.0;
            self.all.add(all, self.count);
            self.own.add(own, self.count);
        }
    }

    /// Variance of a sample.
    fn variance(&self) -> f32 {
        if self.count < 2.0 {
            return 0.0;
        }
        let [all, own] = [self.all, self.own].map(|moments| moments.squares / (self.count - 1.0));
        own + SHARED * (all - own).max(0.0)
    }
}

/// Passes of a render which take as many samples in every pixel, before others do not; 0 where all do.
pub(super) fn even_passes(integrator: &impl Integrator) -> u32 {
    if integrator.follows_noise() { ENOUGH.div_ceil(integrator.samples_a_pass()) } else { 0 }
}

/// Samples of each pixel in a pass, from what was found with `each` of them: as many as are in proportion to the
/// standard deviation relative to what is seen, which for a given number of all samples leaves the least relative error.
pub(super) fn counts(noise: &[Noise], film: &FilmSize, each: u32, seed: u64) -> Counts {
    // In f64, since squares of all pixels are added.
    let mean = noise.iter().map(|n| f64::from(n.all.mean)).sum::<f64>() / noise.len().max(1) as f64;
    let [x0, y0, width, height] = film.crop.map(|v| v as usize);
    let deviation = |i: usize| {
        let range = |at: usize, end: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(end);
        let (mut variance, mut light, mut pixels) = (0.0, 0.0, 0.0);
        for row in range(i / width, height) {
            for one in &noise[row * width..][range(i % width, width)] {
                variance += f64::from(one.variance());
                light += f64::from(one.all.mean);
                pixels += 1.0;
            }
        }
        let square = (light / pixels).powi(2) + (DARK * mean).powi(2);
        if square > 0.0 { (variance / pixels / square).sqrt() } else { 0.0 }
    };
    let deviations: Vec<f64> = (0..noise.len()).into_par_iter().map(deviation).collect();
    let usual = deviations.iter().sum::<f64>() / deviations.len().max(1) as f64;
    let each = f64::from(each);
    let count = |(i, deviation): (usize, &f64)| {
        // Squares of the brightest light leave the range of f32: then nothing is known of the noise.
        let wanted = if usual.is_normal() { USUAL * each * deviation / usual } else { 0.0 };
        // As many on average as are wanted.
        let place = ((y0 + i / width) as u64) << 32 | (x0 + i % width) as u64;
        let part = mix(seed ^ mix(PART ^ place)) as f64 / 2f64.powi(64);
        (wanted.clamp(each, MOST * each) + part).floor().min(f64::from(u16::MAX)) as u16
    };
    let counts: Vec<u16> = deviations.iter().enumerate().map(count).collect();
    let (mut first, mut later) = (0.0, 0.0);
    for (noise, count) in noise.iter().zip(&counts) {
        let variance = f64::from(noise.variance());
        first += variance / each;
        later += variance / f64::from(*count);
    }
    let ratio = (first / later) as f32;
    let gain = if ratio.is_normal() { ratio } else { 1.0 };
    Counts { each: counts, gain }
}

/// Tells these random numbers from those of samples.
const PART: u64 = 0x0b5e_55ed_0a1f_c041;
