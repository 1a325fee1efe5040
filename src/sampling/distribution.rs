use super::Guide;

/// A discrete distribution over `0..n`, sampled by inversion of its CDF, so that stratified numbers stay
/// stratified.
#[derive(Clone, Debug)]
pub struct Discrete {
    /// Normalised CDF of n + 1 entries, from 0 to 1; f64 because thousands of weights may span nine orders of
    /// magnitude.
    cdf: Vec<f64>,
    /// 1/probability of each item, so that sampling needs no division.
    inverse: Vec<f64>,
    /// Of many items.
    guide: Option<Guide>,
    total: f64,
}

impl Discrete {
    /// One item for each weight. Weights must be finite and non-negative; if all are zero, every item is equally
    /// likely.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut cdf = vec![0.0];
        let mut sum = 0.0;
        for w in weights {
            sum += w;
            cdf.push(sum);
        }
        let n = cdf.len() - 1;
        for (i, c) in cdf.iter_mut().enumerate() {
            *c = if sum > 0.0 { *c / sum } else { i as f64 / n.max(1) as f64 };
        }
        let inverse = cdf.windows(2).map(|w| 1.0 / (w[1] - w[0])).collect();
        let guide = (cdf.len() > SHORT).then(|| Guide::new(&cdf, cdf.len()));
        Self { cdf, inverse, guide, total: sum }
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.cdf.len() - 1
    }

    /// Whether there are no items.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sum of the weights as given.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Probability of item `i`.
    #[inline]
    pub fn probability(&self, i: usize) -> f32 {
        (self.cdf[i + 1] - self.cdf[i]) as f32
    }

    /// The item selected by `u` in [0, 1), and the position of `u` within that item's share of the CDF, rescaled
    /// to [0, 1). Items of probability 0 are never selected. There must be at least one item.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        let upper = match &self.guide {
            Some(guide) => guide.count(&self.cdf, 0, u),
            // A linear count has no branch to mispredict.
            None => self.cdf.iter().fold(0, |n, &c| n + usize::from(c <= f64::from(u))),
        };
        let u = f64::from(u);
        let upper = upper.min(self.len());
        let i = upper.saturating_sub(1);
        let rest = (u - self.cdf[i]) * self.inverse[i];
        (i, (rest as f32).clamp(0.0, 1.0 - f32::EPSILON))
    }
}

/// Up to this many CDF entries, a linear count is faster than a guided search.
const SHORT: usize = 9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampling_follows_the_weights_and_skips_zeros() {
        let d = Discrete::new([1.0, 0.0, 3.0]);
        let n = 4000;
        let mut counts = [0; 3];
        for i in 0..n {
            let (item, rest) = d.sample((i as f32 + 0.5) / n as f32);
            assert!((0.0..1.0).contains(&rest));
            counts[item] += 1;
        }
        assert_eq!(counts, [1000, 0, 3000]);
        assert_eq!(Discrete::new([0.0, 0.0]).probability(1), 0.5);
    }
}
