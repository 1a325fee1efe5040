//! The sums of a picture over its passes, and what one pass adds to a pixel.

use super::aov::Aov;
use super::doublings::Doublings;
use super::layer::{LAYERS, Layer, Radiance};
use super::rejected::Rejected;
use super::stored::{ALPHA, SQUARE, STRIDE, luminance_sum};
use crate::math::Color;
use crate::spectrum::to_rgb;

/// Sums over passes. f64: after 10⁴ passes f32 sums would drop the small additions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pixels {
    /// Per pixel: layers × RGB, then alpha, then the square of the sample's luminance.
    sums: Vec<[f64; STRIDE]>,
    /// Camera samples that every pass took of a pixel.
    pub samples_a_pass: u32,
    doublings: Doublings,
    /// Sums of the pictures of surfaces, pixel by pixel; empty where none is asked for.
    aovs: Vec<f64>,
}

impl Pixels {
    /// Empty sums of `count` pixels.
    pub fn new(count: usize) -> Self {
        Self {
            sums: vec![[0.0; STRIDE]; count],
            samples_a_pass: 1,
            doublings: Doublings::default(),
            aovs: Vec::new(),
        }
    }

    /// Makes room for so many sums of AOVs a pixel, unless it is there already.
    pub fn hold_aovs(&mut self, numbers: usize) {
        self.aovs.resize(self.sums.len() * numbers, 0.0);
    }

    /// The sums of AOVs, pixel by pixel.
    pub fn aovs(&self) -> &[f64] {
        &self.aovs
    }

    /// All sums, to add to: those of light, and those of AOVs.
    pub fn parts_mut(&mut self) -> (&mut [[f64; STRIDE]], &mut [f64]) {
        (&mut self.sums, &mut self.aovs)
    }

    /// The channels of one of the AOVs of `list` after `passes`; empty when it is not among them.
    pub fn aov(&self, pixel: usize, aov: Aov, list: &[Aov], passes: u32) -> Vec<f64> {
        let Some(place) = aov.place_in(list) else { return Vec::new() };
        let first = pixel * Aov::numbers_of(list);
        aov.finish(&self.aovs[first + place.start..first + place.end], passes, self.samples_a_pass)
    }

    /// Pixels.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// Whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// The sums, row by row: layers × RGB, then alpha, then the square of the luminance.
    pub fn as_slice(&self) -> &[[f64; STRIDE]] {
        &self.sums
    }

    /// The same, to add to.
    pub fn as_mut_slice(&mut self) -> &mut [[f64; STRIDE]] {
        &mut self.sums
    }

    /// What the noise is estimated from.
    pub fn doublings(&self) -> &Doublings {
        &self.doublings
    }

    /// Puts back what a file kept.
    pub fn set_doublings(&mut self, doublings: Doublings) {
        self.doublings = doublings;
    }

    /// To be called after every pass, in order: what [`Self::relative_error`] is made of.
    pub fn pass_done(&mut self, passes: u32) {
        self.doublings.pass_done(&self.sums, passes);
    }

    /// Mean of a layer after `passes`.
    pub fn layer(&self, pixel: usize, layer: Layer, passes: u32) -> [f64; 3] {
        let at = 3 * layer as usize;
        let s = &self.sums[pixel];
        [s[at], s[at + 1], s[at + 2]].map(|v| v / f64::from(passes.max(1)))
    }

    /// Mean of the sum of all layers.
    pub fn beauty(&self, pixel: usize, passes: u32) -> [f64; 3] {
        let s = &self.sums[pixel];
        std::array::from_fn(|c| {
            (0..LAYERS.len()).map(|l| s[3 * l + c]).sum::<f64>() / f64::from(passes.max(1))
        })
    }

    /// Mean coverage after `passes`.
    pub fn alpha(&self, pixel: usize, passes: u32) -> f64 {
        self.sums[pixel][ALPHA] / f64::from(passes.max(1))
    }

    /// Variance of the mean luminance were the passes independent: the sample variance over passes divided
    /// by their number. They are stratified among each other, so the true one is smaller, by how much
    /// cannot be told pixel by pixel. The bias of photon mapping is not in this figure.
    pub fn variance(&self, pixel: usize, passes: u32) -> f64 {
        let n = f64::from(passes);
        if passes < 2 {
            return f64::INFINITY;
        }
        let mean = luminance_sum(&self.sums[pixel]) / n;
        ((self.sums[pixel][SQUARE] / n - mean * mean) / (n - 1.0)).max(0.0)
    }

    /// Standard error of a pixel's luminance after `passes`, root mean square over the picture, relative to
    /// the picture's mean. Honest for stratified passes, see [`Doublings`].
    pub fn relative_error(&self, passes: u32) -> f64 {
        let sum: f64 = self.sums.iter().map(|s| luminance_sum(s)).sum();
        let mean = sum / self.sums.len().max(1) as f64 / f64::from(passes.max(1));
        if mean > 0.0 { self.doublings.variance(passes).sqrt() / mean } else { f64::INFINITY }
    }
}

/// What a pass brings to a pixel: the mean of its samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean([f64; SQUARE]);

impl Mean {
    /// Adds one sample, `weight` being its filter's over the number of samples, or counts it in `rejected` and adds
    /// nothing when it is not finite.
    #[inline]
    pub fn add(&mut self, sample: &Radiance, weight: f32, rejected: &mut Rejected) {
        let layers = sample.layers.map(|layer| layer * weight);
        let total: Color = layers.iter().copied().sum();
        if !total.is_finite() {
            return reject(&layers, rejected);
        }
        for (l, layer) in layers.iter().enumerate() {
            for (c, value) in to_rgb(*layer).into_iter().enumerate() {
                self.0[3 * l + c] += f64::from(value);
            }
        }
        self.0[ALPHA] += f64::from(sample.alpha * weight);
    }

    /// Times a number.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|value| value * factor))
    }

    /// Adds it to a pixel's sums.
    #[inline]
    pub fn add_to(&self, sums: &mut [f64; STRIDE]) {
        for (sum, value) in sums.iter_mut().zip(&self.0) {
            *sum += value;
        }
        sums[SQUARE] += luminance_sum(&self.0).powi(2);
    }
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
