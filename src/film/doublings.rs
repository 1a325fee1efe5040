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

use super::stored::{STRIDE, luminance_sum};

/// What each doubling of the passes took from the mean variance of a pixel's luminance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Doublings {
    /// Sums of luminance when the number of passes last was a power of two.
    luminance: Vec<f64>,
    /// Δ₁ (from 1 to 2 passes), Δ₂, …
    steps: Vec<f64>,
}

/// Slowest and fastest fall of the variance. Stratified passes are no worse than independent ones, and of
/// samples in so many dimensions none falls faster than n⁻².
const SLOPES: [f64; 2] = [1.0, 2.0];

impl Doublings {
    /// The numbers that make one again, for files.
    pub fn parts(&self) -> (&[f64], &[f64]) {
        (&self.luminance, &self.steps)
    }

    /// From what [`Doublings::parts`] gave.
    pub fn from_parts(luminance: Vec<f64>, steps: Vec<f64>) -> Self {
        Self { luminance, steps }
    }

    pub(super) fn pass_done(&mut self, sums: &[[f64; STRIDE]], passes: u32) {
        if !passes.is_power_of_two() {
            return;
        }
        let now: Vec<f64> = sums.iter().map(|s| luminance_sum(s)).collect();
        if passes > 1 {
            let half = f64::from(passes / 2);
            let square = |(now, before): (&f64, &f64)| ((now - 2.0 * before) / half).powi(2) / 4.0;
            let sum: f64 = now.iter().zip(&self.luminance).map(square).sum();
            self.steps.push(sum / now.len().max(1) as f64);
        }
        self.luminance = now;
    }

    /// Mean over the picture of the variance of a pixel's luminance after `passes`; infinite before two.
    pub fn variance(&self, passes: u32) -> f64 {
        let Some(last) = self.steps.last() else { return f64::INFINITY };
        let slope = self.slope();
        let doubled = f64::from(1u32 << self.steps.len().min(31));
        last / (slope.exp2() - 1.0) * (doubled / f64::from(passes.max(1))).powf(slope)
    }

    /// s of V ∝ n⁻ˢ over the last doublings.
    fn slope(&self) -> f64 {
        /// More would mix what the first passes do with what the last ones do.
        const STEPS: usize = 3;
        let recent = &self.steps[self.steps.len().saturating_sub(STEPS)..];
        let [Some(first), Some(last)] = [recent.first(), recent.last()] else { return SLOPES[0] };
        if recent.len() < 2 || *last <= 0.0 {
            return SLOPES[0];
        }
        ((first / last).log2() / (recent.len() - 1) as f64).clamp(SLOPES[0], SLOPES[1])
    }
}
