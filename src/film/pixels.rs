//! The sums of a picture over its passes.

use std::fmt;
use std::ops::Range;

use rayon::prelude::*;

use super::aov::Aov;
use super::binned::{Binned, BinnedSums, ROW};
use super::counts::Counts;
use super::doublings::Doublings;
use super::layer::{LAYERS, Layer};
use super::pass::{PassSums, StoredMean};
use super::stored::{ALPHA, LUMINANCE, SQUARE, STRIDE, place};

/// Sums of one number that are added to together: a unit of parallel work.
const TOGETHER: usize = 64 * ROW;

/// What all passes of a picture have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Common {
    /// Camera samples that every pass took of a pixel, or at first, see [`Pixels::counts`].
    pub samples_a_pass: u32,
    /// Passes that take as many in every pixel; 0 for all.
    pub even_passes: u32,
    /// Search radii of the global and of the caustic map in pass 0; 0 without a map.
    pub first_radii: [f32; 2],
}

impl fmt::Display for Common {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [global, caustic] = self.first_radii;
        write!(f, "{} samples a pixel", self.samples_a_pass)?;
        if self.even_passes > 0 {
            write!(f, " in {} passes and as noise asks for after them", self.even_passes)?;
        }
        write!(f, ", first radii {global} and {caustic}")
    }
}

/// Sums over passes, which do not depend on the order of the passes, see [`super::binned`].
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Pixels.
    count: usize,
    /// Per pixel: layers × RGB, then alpha, then the luminance of each pass and its square; [`place`] says where.
    light: BinnedSums,
    /// What all passes have in common.
    pub common: Common,
    doublings: Doublings,
    counts: Counts,
    /// Sums of the pictures of surfaces, pixel by pixel; empty where none is asked for.
    aovs: BinnedSums,
}

impl Pixels {
    /// Empty sums of `count` pixels.
    pub fn new(count: usize) -> Self {
        Self {
            count,
            light: BinnedSums::new(Self::sums_of_light(count)),
            common: Common { samples_a_pass: 1, even_passes: 0, first_radii: [0.0; 2] },
            doublings: Doublings::default(),
            counts: Counts::default(),
            aovs: BinnedSums::default(),
        }
    }

    /// Sums of light of so many pixels, in [`Pixels::sums`].
    pub fn sums_of_light(count: usize) -> usize {
        count.saturating_mul(STRIDE)
    }

    /// Of `count` pixels, from their sums of light and of AOVs, and what the noise is estimated from.
    pub fn from_parts(
        count: usize,
        [light, aovs]: [BinnedSums; 2],
        doublings: Doublings,
        common: Common,
        counts: Counts,
    ) -> Self {
        Self { count, light, common, doublings, counts, aovs }
    }

    /// Camera samples of pixels after the passes that take as many in every pixel.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Says how many there are.
    pub fn set_counts(&mut self, counts: Counts) {
        self.counts = counts;
    }

    /// Whether passes of both are of one render: the same in common, and samples of pixels that do not differ as far as they
    /// are known.
    pub fn agree(&self, other: &Self) -> bool {
        let counts = [&self.counts, &other.counts];
        self.common == other.common && (counts.iter().any(|c| c.each.is_empty()) || counts[0] == counts[1])
    }

    /// Camera samples of a pixel in some passes, of which `even` are among the first.
    pub fn samples(&self, pixel: usize, passes: u32, even: u32) -> u64 {
        let each = self.common.samples_a_pass;
        let later = self.counts.each.get(pixel).map_or(each, |count| u32::from(*count));
        u64::from(even) * u64::from(each) + u64::from(passes - even) * u64::from(later)
    }

    /// Makes room for so many sums of AOVs a pixel, unless it is there already.
    pub fn hold_aovs(&mut self, numbers: usize) {
        self.aovs.resize(self.len() * numbers);
    }

    /// Sums of AOVs of all pixels, of which [`Pixels::sums`] has the second.
    pub fn numbers_of_aovs(&self) -> usize {
        self.aovs.len()
    }

    /// The channels of one of the AOVs of `list` after `passes`; empty when it is not among them.
    pub fn aov(&self, pixel: usize, aov: Aov, list: &[Aov], passes: u32) -> Vec<f64> {
        let Some(place) = aov.place_in(list) else { return Vec::new() };
        let first = pixel * Aov::numbers_of(list);
        let sums: Vec<f64> = place.map(|i| self.aovs.get(first + i)).collect();
        aov.finish(&sums, passes, self.common.samples_a_pass)
    }

    /// Pixels.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let counts = size_of_val(self.counts.each.as_slice());
        self.light.bytes() + self.aovs.bytes() + self.doublings.bytes() + counts
    }

    /// The sums of light and of AOVs, for files.
    pub fn sums(&self) -> [&BinnedSums; 2] {
        [&self.light, &self.aovs]
    }

    /// What the noise is estimated from.
    pub fn doublings(&self) -> &Doublings {
        &self.doublings
    }

    /// Adds passes.
    pub fn add(&mut self, passes: &[PassSums]) {
        let means: Vec<&[StoredMean]> = passes.iter().map(|pass| pass.means.as_slice()).collect();
        self.add_means(&means);
        self.aovs.par_chunks_mut(TOGETHER).enumerate().for_each(|(chunk, mut sums)| {
            let first = chunk * TOGETHER;
            passes.iter().for_each(|pass| sums.add(&pass.aovs[first..first + sums.len()]));
        });
    }

    /// Adds some means to each pixel, each of the lists holding one.
    pub(super) fn add_means(&mut self, means: &[&[StoredMean]]) {
        let mut numbers: Vec<_> =
            self.light.all().chunks(self.count).map(|sums| sums.chunks(TOGETHER)).collect();
        let chunk = |first| {
            let range = first..self.count.min(first + TOGETHER);
            let means: Vec<_> = means.iter().map(|means| &means[range.clone()]).collect();
            (means, numbers.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>())
        };
        let chunks: Vec<_> = (0..self.count).step_by(TOGETHER).map(chunk).collect();
        chunks.into_par_iter().for_each(|(means, mut sums)| add_chunk(&means, &mut sums));
    }

    /// Sums of luminance.
    fn luminance(&self) -> BinnedSums {
        let mut sums = BinnedSums::default();
        sums.extend(&self.light, place(0, LUMINANCE, self.count)..place(0, LUMINANCE + 1, self.count));
        sums
    }

    /// To be called when the passes from `first` to `end`, which is not among them, are in the sums, and after each of
    /// them, in order: what [`Self::relative_error`] is made of.
    pub fn pass_done(&mut self, first: u32, end: u32) {
        if end.is_power_of_two() {
            let luminance = self.luminance();
            self.doublings.pass_done([first, end], self.count, luminance);
        }
    }

    /// Adds the sums of other passes. None of theirs is at or after `other_end`, none of ours at or after `end`.
    pub fn merge(&mut self, end: u32, other: &Self, other_end: u32) {
        let mut doublings = std::mem::take(&mut self.doublings);
        let totals = [&*self, other].map(|of| move || of.luminance());
        doublings.merge([end, other_end], [&totals[0], &totals[1]], &other.doublings);
        self.doublings = doublings;
        if self.counts.each.is_empty() {
            self.counts.clone_from(&other.counts);
        }
        self.light.merge(&other.light);
        self.aovs.merge(&other.aovs);
    }

    /// To be called with sums that end with pass `end` and come from a file, which does not keep what follows from them.
    pub fn mark_end(&mut self, end: u32) {
        if end.is_power_of_two() {
            self.doublings.mark(end, self.luminance());
        }
    }

    /// To be called when all of the first `passes` passes are in the sums.
    pub fn complete_until(&mut self, passes: u32) {
        self.doublings.close(passes, self.count);
    }

    /// Mean of a layer after `passes`.
    pub fn layer(&self, pixel: usize, layer: Layer, passes: u32) -> [f64; 3] {
        let at = 3 * layer as usize;
        [at, at + 1, at + 2].map(|at| self.sum(pixel, at) / f64::from(passes.max(1)))
    }

    /// All sums of light of a pixel: layers × RGB, then alpha, then the luminance of each pass and its square.
    pub fn numbers(&self, pixel: usize) -> [f64; STRIDE] {
        std::array::from_fn(|at| self.sum(pixel, at))
    }

    fn sum(&self, pixel: usize, at: usize) -> f64 {
        self.light.get(place(pixel, at, self.count))
    }

    /// Mean of the sum of all layers.
    pub fn beauty(&self, pixel: usize, passes: u32) -> [f64; 3] {
        std::array::from_fn(|c| {
            (0..LAYERS.len()).map(|l| self.sum(pixel, 3 * l + c)).sum::<f64>() / f64::from(passes.max(1))
        })
    }

    /// The same of every pixel.
    pub fn beauties(&self, passes: u32) -> impl Iterator<Item = [f64; 3]> {
        let rows = (0..self.count).step_by(ROW).map(|first| first..self.count.min(first + ROW));
        rows.flat_map(move |row| self.beauties_of(row, passes))
    }

    /// The same of some pixels.
    pub fn beauties_of(&self, pixels: Range<usize>, passes: u32) -> Vec<[f64; 3]> {
        let numbers: [[usize; 3]; LAYERS.len()] = std::array::from_fn(numbers_of);
        self.means(pixels, &numbers, passes)
    }

    /// Means of a layer of some pixels.
    pub fn layers_of(&self, pixels: Range<usize>, layer: Layer, passes: u32) -> Vec<[f64; 3]> {
        self.means(pixels, &[numbers_of(layer as usize)], passes)
    }

    /// Mean coverage of some pixels.
    pub fn alphas_of(&self, pixels: Range<usize>, passes: u32) -> Vec<[f64; 1]> {
        self.means(pixels, &[[ALPHA]], passes)
    }

    /// For each of some pixels the means of some numbers, of which the rows are added: number by number for some pixels
    /// at a time, as the sums lie in memory.
    fn means<const N: usize>(
        &self,
        pixels: Range<usize>,
        numbers: &[[usize; N]],
        passes: u32,
    ) -> Vec<[f64; N]> {
        let mut means = Vec::with_capacity(pixels.len());
        for first in pixels.clone().step_by(ROW) {
            let mut sums = [[0.0; ROW]; N];
            let count = ROW.min(pixels.end - first);
            for row in numbers {
                for (number, sums) in row.iter().zip(&mut sums) {
                    self.light.add_to(place(first, *number, self.count), &mut sums[..count]);
                }
            }
            let mean = |i: usize| std::array::from_fn(|c| sums[c][i] / f64::from(passes.max(1)));
            means.extend((0..count).map(mean));
        }
        means
    }

    /// Mean coverage after `passes`.
    pub fn alpha(&self, pixel: usize, passes: u32) -> f64 {
        self.sum(pixel, ALPHA) / f64::from(passes.max(1))
    }

    /// Variance of the mean luminance were the passes independent: the sample variance over passes divided
    /// by their number. They are stratified among each other, so the true one is smaller, by how much
    /// cannot be told pixel by pixel. The bias of photon mapping is not in this figure.
    pub fn variance(&self, pixel: usize, passes: u32) -> f64 {
        let n = f64::from(passes);
        if passes < 2 {
            return f64::INFINITY;
        }
        let mean = self.sum(pixel, LUMINANCE) / n;
        ((self.sum(pixel, SQUARE) / n - mean * mean) / (n - 1.0)).max(0.0)
    }

    /// Standard error of a pixel's luminance after `passes`, root mean square over the picture, relative to
    /// the picture's mean. Honest for stratified passes, see [`Doublings`]. Infinite where all is black, and where the
    /// sums do not begin with the first two passes.
    pub fn relative_error(&self, passes: u32) -> f64 {
        let mean = self.mean_luminance(passes);
        if mean > 0.0 { self.mean_variance(passes).sqrt() / mean } else { f64::INFINITY }
    }

    /// Mean over the picture of the variance of a pixel's luminance after `passes`; infinite where the sums do not begin
    /// with the first two passes.
    pub fn mean_variance(&self, passes: u32) -> f64 {
        self.doublings.variance(passes, self.common.even_passes, self.counts.gain)
    }

    /// Mean over the picture of the luminance after `passes`.
    pub fn mean_luminance(&self, passes: u32) -> f64 {
        let sum: f64 = (0..self.len()).map(|pixel| self.sum(pixel, LUMINANCE)).sum();
        sum / self.len().max(1) as f64 / f64::from(passes.max(1))
    }
}

/// Places of red, green and blue of a layer.
fn numbers_of(layer: usize) -> [usize; 3] {
    [3 * layer, 3 * layer + 1, 3 * layer + 2]
}

/// Adds means to as many pixels, of which `sums` has those of every number.
fn add_chunk(means: &[&[StoredMean]], sums: &mut [Binned<'_>]) {
    let mut rows = [[0.0; ROW]; STRIDE];
    let pixels = means.first().map_or(0, |means| means.len());
    for first in (0..pixels).step_by(ROW) {
        let range = first..pixels.min(first + ROW);
        for means in means {
            StoredMean::numbers(&means[range.clone()], &mut rows);
            for (sums, row) in sums.iter_mut().zip(&rows) {
                sums.part(range.clone()).add(&row[..range.len()]);
            }
        }
    }
}
