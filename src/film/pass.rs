//! What one pass adds to a picture.

use super::binned::ROW;
use super::layer::{LAYERS, Layer, Radiance};
use super::rejected::Rejected;
use super::stored::{ALPHA, LUMINANCE, LUMINANCE_WEIGHTS, SQUARE, STRIDE};
use crate::math::Color;
use crate::spectrum::to_rgb;

/// What a pass brings to a pixel: the mean of its samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean([f64; LUMINANCE]);

impl Mean {
    /// Adds one sample, `weight` being its filter's over the number of samples, or counts it in `rejected` and adds
    /// nothing when it is not finite.
    #[inline]
    pub fn add(&mut self, sample: &Radiance, weight: f32, rejected: &mut Rejected) {
        if let Some(numbers) = numbers_of(sample, weight, rejected) {
            self.0.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += f64::from(number));
        }
    }

    /// The same times a number, in single precision: its error is far below that of a sample.
    #[inline]
    pub fn stored(&self, factor: f64) -> StoredMean {
        let most = f64::from(f32::MAX);
        let mut stored = [0.0; LUMINANCE];
        // `map` makes no SIMD of this.
        for (stored, value) in stored.iter_mut().zip(self.0) {
            *stored = (value * factor).max(-most).min(most) as f32;
        }
        StoredMean(stored)
    }
}

/// A [`Mean`] that is kept until its pass is whole.
#[derive(Clone, Copy, Debug, Default)]
pub struct StoredMean([f32; LUMINANCE]);

impl StoredMean {
    /// What a [`Mean`] of this sample alone is stored as.
    #[inline]
    pub fn of_one(sample: &Radiance, weight: f32, rejected: &mut Rejected) -> Self {
        // A sum that begins with 0 is never −0.
        Self(
            numbers_of(sample, weight, rejected).map_or([0.0; LUMINANCE], |numbers| numbers.map(|x| x + 0.0)),
        )
    }

    /// Adds light that was not in the mean.
    pub fn add(&mut self, light: &Radiance, rejected: &mut Rejected) {
        if let Some(numbers) = numbers_of(light, 1.0, rejected) {
            self.0.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        }
    }

    /// What is added to the sums of pixels: a row for each number, in which each of the pixels has a place.
    #[inline]
    pub(super) fn numbers(means: &[Self], rows: &mut [[f64; ROW]; STRIDE]) {
        // Number by number, and by column of the row, which is SIMD.
        for (number, row) in rows[..LUMINANCE].iter_mut().enumerate() {
            row.iter_mut().zip(means).for_each(|(to, mean)| *to = f64::from(mean.0[number]));
        }
        let mut luminance = [0.0; ROW];
        for (c, weight) in LUMINANCE_WEIGHTS.into_iter().enumerate() {
            let mut channel = [0.0; ROW];
            for layer in 0..LAYERS.len() {
                channel.iter_mut().zip(&rows[3 * layer + c]).for_each(|(sum, number)| *sum += number);
            }
            luminance.iter_mut().zip(channel).for_each(|(sum, channel)| *sum += weight * channel);
        }
        rows[LUMINANCE] = luminance;
        rows[SQUARE] = luminance.map(|luminance| luminance * luminance);
    }
}

/// Layers and alpha of a sample times `weight`; `None` when they are not finite, which is counted in `rejected`.
#[inline(always)]
fn numbers_of(sample: &Radiance, weight: f32, rejected: &mut Rejected) -> Option<[f32; LUMINANCE]> {
    let layers = sample.layers.map(|layer| layer * weight);
    let total: Color = layers.iter().copied().sum();
    if !total.is_finite() {
        reject(&layers, rejected);
        return None;
    }
    let mut numbers = [0.0; LUMINANCE];
    for (l, layer) in layers.iter().enumerate() {
        numbers[3 * l..3 * l + 3].copy_from_slice(&to_rgb(*layer));
    }
    numbers[ALPHA] = sample.alpha * weight;
    Some(numbers)
}

#[cold]
fn reject(layers: &[Color; LAYERS.len()], rejected: &mut Rejected) {
    let layer = |bad: &dyn Fn(&Color) -> bool| LAYERS.iter().find(|(l, _)| bad(&layers[*l as usize]));
    if let Some((l, _)) = layer(&|l| l.is_nan()) {
        rejected.sample(*l, true);
    } else {
        // Finite layers may still have a sum beyond f32: the largest counts.
        let largest = layers.iter().map(|l| l.max_element()).fold(0.0, f32::max);
        let found = layer(&|l| !l.is_finite()).or_else(|| layer(&|l| l.max_element() == largest));
        rejected.sample(found.map_or(Layer::Emission, |(l, _)| *l), false);
    }
}

/// What a pass brings to all pixels. It is added to their sums when it is whole: a pass that is cut changes nothing.
#[derive(Clone, Debug, Default)]
pub struct PassSums {
    /// For each pixel.
    pub means: Vec<StoredMean>,
    /// Sums over the samples of a pixel that show its surfaces, pixel by pixel.
    pub aovs: Vec<f64>,
}

impl PassSums {
    /// An empty pass of so many pixels, with so many sums for their surfaces in all.
    pub fn new(pixels: usize, aovs: usize) -> Self {
        Self { means: vec![StoredMean::default(); pixels], aovs: vec![0.0; aovs] }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.means.as_slice()) + size_of_val(self.aovs.as_slice())
    }
}
