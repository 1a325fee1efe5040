//! The noise of a picture whose passes are not independent.
//!
//! The samples of a pixel are points of a scrambled sequence, stratified over passes: their scatter says
//! more than the noise that is left in their mean. Let V(n) be the variance of the mean of n passes and
//! n = 2ᵐ. The halves of a pixel's passes, A and B, are both scrambled nets: of one distribution, with
//! variance V(n/2), and their mean has V(n) = V(n/2)/2 + Cov(A, B)/2. So
//!
//! E(A − B)²/4 = (V(n/2) − Cov(A, B))/2 = V(n/2) − V(n) = Δₘ.
//!
//! What a doubling took from the variance is thus known, by the mean of (A − B)²/4 over the picture, and
//! how that falls from one doubling to the next says how V does: where it falls as n⁻ˢ, so does V, and
//! V(n) = Δₘ/(2ˢ − 1). Independent passes have s = 1 and V(n) = Δₘ, also when later passes are noisier
//! than earlier ones, as those of progressive photon mapping are: E(A − B)²/4 is (V_A + V_B)/4 then.
//!
//! Of passes that begin with another than the first, the sums of luminance up to each power of two are kept, so that
//! parts of a render which are merged give the estimate of one run. A part from pass A to pass B keeps one for each
//! power of two between them, which are log₂(B/A) + 1 at most.

use std::collections::BTreeMap;

use super::binned::BinnedSums;

/// What each doubling of the passes took from the mean variance of a pixel's luminance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Doublings {
    /// Δ₁ (from 1 to 2 passes), Δ₂, …
    steps: Vec<f64>,
    /// Sums of luminance over those of the passes that come before a power of two. Once the step that ends at a power
    /// is known, what comes before the power is no longer kept.
    marks: BTreeMap<u32, BinnedSums>,
}

/// Slowest and fastest fall of the variance. Stratified passes are no worse than independent ones, and of
/// samples in so many dimensions none falls faster than n⁻².
const SLOPES: [f64; 2] = [1.0, 2.0];

impl Doublings {
    /// The numbers that make one again, for files.
    pub fn parts(&self) -> (&[f64], &BTreeMap<u32, BinnedSums>) {
        (&self.steps, &self.marks)
    }

    /// From what [`Doublings::parts`] gave.
    pub fn from_parts(steps: Vec<f64>, marks: BTreeMap<u32, BinnedSums>) -> Self {
        Self { steps, marks }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.marks.values().map(BinnedSums::bytes).sum()
    }

    /// `luminance` holds the sums over the passes from the first to a power of two, of so many pixels.
    pub(super) fn pass_done(&mut self, [first, end]: [u32; 2], pixels: usize, luminance: BinnedSums) {
        self.mark(end, luminance);
        self.close(if first == 0 { end } else { 0 }, pixels);
    }

    /// `luminance` holds the sums over all passes before `power`.
    pub(super) fn mark(&mut self, power: u32, luminance: BinnedSums) {
        self.marks.insert(power, luminance);
    }

    /// Adds what was found of other passes. `ends` are those of the passes of both; `totals` give the sums of luminance
    /// over all of them.
    pub(super) fn merge(&mut self, ends: [u32; 2], totals: [&dyn Fn() -> BinnedSums; 2], other: &Self) {
        // What is known already to the part that begins with pass 0.
        let closed = [&*self, other].map(|of| of.steps.len()).into_iter().max().unwrap_or(0);
        let first = 1u32 << closed.min(31);
        self.marks.retain(|power, _| *power >= first);
        let last = ends[0].max(ends[1]);
        for power in (0..u32::BITS).map(|e| 1u32 << e).filter(|power| (first..=last).contains(power)) {
            let theirs = match other.marks.get(&power) {
                None if power >= ends[1] => Some(totals[1]()),
                mark => mark.cloned(),
            };
            if power >= ends[0] {
                self.marks.entry(power).or_insert_with(totals[0]);
            }
            match (self.marks.get_mut(&power), theirs) {
                (Some(ours), Some(theirs)) => ours.merge(&theirs),
                (None, Some(theirs)) => drop(self.marks.insert(power, theirs)),
                (_, None) => {}
            }
        }
        if self.steps.is_empty() {
            self.steps.clone_from(&other.steps);
        }
    }

    /// Finds the steps up to `passes`, all of which are known.
    pub(super) fn close(&mut self, passes: u32, pixels: usize) {
        loop {
            let half = 1u32 << self.steps.len().min(30);
            let whole = 2 * half;
            let Some(now) = self.marks.get(&whole).filter(|_| whole <= passes) else { return };
            let Some(before) = self.marks.get(&half) else { return };
            let square = |i: usize| ((now.get(i) - 2.0 * before.get(i)) / f64::from(half)).powi(2) / 4.0;
            let sum: f64 = (0..pixels).map(square).sum();
            self.steps.push(sum / pixels.max(1) as f64);
            self.marks.remove(&half);
        }
    }

    /// Mean over the picture of the variance of a pixel's luminance after `passes`; infinite before two. The first `even`
    /// passes have `gain` times the variance of the others.
    pub fn variance(&self, passes: u32, even: u32, gain: f32) -> f64 {
        let Some(last) = self.steps.last() else { return f64::INFINITY };
        // Of the mean of n passes, were they independent.
        let independent = |n: f64| (n + (f64::from(gain) - 1.0) * n.min(f64::from(even))) / (n * n);
        let slope = self.slope(independent);
        let doubled = f64::from(1u32 << self.steps.len().min(31));
        let n = f64::from(passes.max(1));
        let later = independent(n) / independent(doubled) * (doubled / n).powf(slope - 1.0);
        last / (slope.exp2() - 1.0) * later
    }

    /// s of V ∝ n⁻ˢ over the last doublings, were all passes alike.
    fn slope(&self, independent: impl Fn(f64) -> f64) -> f64 {
        /// More would mix what the first passes do with what the last ones do.
        const STEPS: usize = 3;
        let first = self.steps.len().saturating_sub(STEPS);
        let [Some(before), Some(last)] = [self.steps.get(first), self.steps.last()] else { return SLOPES[0] };
        let steps = self.steps.len() - 1 - first;
        if steps == 0 || *last <= 0.0 {
            return SLOPES[0];
        }
        let alone = |steps: usize| independent((steps as f64).exp2());
        let expected = alone(first + 1) / alone(self.steps.len());
        (1.0 + (before / last / expected).log2() / steps as f64).clamp(SLOPES[0], SLOPES[1])
    }
}
