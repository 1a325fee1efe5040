//! Medians, slopes, the time to reach an error, and their uncertainty.

use serde::Serialize;

/// The median and the quartiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub median: f64,
    pub low: f64,
    pub high: f64,
}

impl Spread {
    /// The spread of some values; zeros if there are none.
    pub fn of(values: &[f64]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        Self { median: quantile(&sorted, 0.5), low: quantile(&sorted, 0.25), high: quantile(&sorted, 0.75) }
    }
}

/// Quantile of sorted values by linear interpolation; 0 if there are none.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let place = share.clamp(0.0, 1.0) * last as f64;
    let (below, rest) = (place.floor() as usize, place.fract());
    let above = (below + 1).min(last);
    sorted[below] * (1.0 - rest) + sorted[above] * rest
}

/// A line fitted to the logarithms: `y ≈ scale · x^slope`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PowerLaw {
    pub slope: f64,
    pub scale: f64,
    /// Standard error of the slope; `None` for fewer than three points.
    pub slope_error: Option<f64>,
}

/// Least squares on logarithms; `None` without two different x, or if a value is not positive.
pub fn power_law(points: &[(f64, f64)]) -> Option<PowerLaw> {
    if points.iter().any(|(x, y)| *x <= 0.0 || *y <= 0.0) {
        return None;
    }
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let xx: f64 = logs.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let xy: f64 = logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    if logs.len() < 2 || xx < 1e-9 {
        return None;
    }
    let slope = xy / xx;
    let residual: f64 = logs.iter().map(|p| (p.1 - my - slope * (p.0 - mx)).powi(2)).sum();
    Some(PowerLaw {
        slope,
        scale: (my - slope * mx).exp(),
        slope_error: (logs.len() > 2).then(|| (residual / (n - 2.0) / xx).sqrt()),
    })
}

/// When a curve of error over time reaches an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reach {
    /// Interpolated between two budgets.
    At(f64),
    /// Extrapolated beyond the largest budget.
    About(f64),
    /// Before this time: the smallest budget is already better.
    Before(f64),
    /// After this time: the largest budget is not good enough.
    After(f64),
}

impl Reach {
    /// The time, or its bound.
    pub fn seconds(self) -> f64 {
        match self {
            Self::At(t) | Self::About(t) | Self::Before(t) | Self::After(t) => t,
        }
    }
}

/// The first time at which a curve is at or below `error`. The curve holds points (seconds, error) sorted by
/// time and is interpolated linearly in logarithms. `None` without points.
pub fn time_to_error(curve: &[(f64, f64)], error: f64) -> Option<Reach> {
    let first = curve.first()?;
    if first.1 <= error {
        return Some(Reach::Before(first.0));
    }
    for pair in curve.windows(2) {
        let [(t0, e0), (t1, e1)] = [pair[0], pair[1]];
        if e1 <= error {
            // e1 may be 0 (a picture equal to its reference): its logarithm is kept finite.
            let (l0, l1, l) = (e0.ln(), e1.max(1e-300).ln(), error.max(1e-300).ln());
            let share = if l0 > l1 { ((l0 - l) / (l0 - l1)).clamp(0.0, 1.0) } else { 1.0 };
            return Some(Reach::At((t0.ln() + share * (t1.ln() - t0.ln())).exp()));
        }
    }
    curve.last().map(|p| Reach::After(p.0))
}

/// Slopes above this are those of a curve that has stopped falling: no time is extrapolated from them.
const FLAT: f64 = -0.05;
/// Points at the end of a curve whose power law is followed beyond it.
const LAST: usize = 3;

/// As [`time_to_error`], but followed beyond the last point, by the slope of the last points, as long as the error
/// still falls.
pub fn reach(curve: &[(f64, f64)], error: f64) -> Option<Reach> {
    let found = time_to_error(curve, error)?;
    let (Reach::After(_), Some((t, e))) = (found, curve.last()) else { return Some(found) };
    let law = power_law(&curve[curve.len().saturating_sub(LAST)..]);
    let falling = law.filter(|law| law.slope < FLAT && error > 0.0);
    Some(falling.map_or(found, |law| Reach::About(t * (error / e).powf(1.0 / law.slope))))
}

/// Measurements of one configuration: for each budget the (seconds, error) of its seeds.
pub type Curve = Vec<Vec<(f64, f64)>>;

/// The medians (seconds, error) of each budget, sorted by time.
pub fn medians(curve: &Curve) -> Vec<(f64, f64)> {
    let median = |points: &[(f64, f64)], f: fn(&(f64, f64)) -> f64| {
        Spread::of(&points.iter().map(f).collect::<Vec<_>>()).median
    };
    let budgets = curve.iter().filter(|p| !p.is_empty());
    let mut out: Vec<_> = budgets.map(|p| (median(p, |v| v.0), median(p, |v| v.1))).collect();
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    out
}

/// How many times as long one curve takes as another to reach an error: estimate and 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    /// Whether a time is only a bound, in the estimate or in a resample.
    pub bound: bool,
}

/// Resamples of the bootstrap.
const RESAMPLES: usize = 1000;

/// The ratio of the times to `error`. The interval is that of a bootstrap, which draws seeds with replacement
/// in each budget. `None` if either curve is empty.
pub fn time_ratio(curve: &Curve, base: &Curve, error: f64) -> Option<Ratio> {
    let reach = |c: &Curve| time_to_error(&medians(c), error);
    let (a, b) = (reach(curve)?, reach(base)?);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut ratios = Vec::with_capacity(RESAMPLES);
    let mut bound = !matches!((a, b), (Reach::At(_), Reach::At(_)));
    for _ in 0..RESAMPLES {
        let (Some(x), Some(y)) = (reach(&resample(curve, &mut random)), reach(&resample(base, &mut random)))
        else {
            continue;
        };
        bound |= !matches!((x, y), (Reach::At(_), Reach::At(_)));
        ratios.push(x.seconds() / y.seconds());
    }
    ratios.sort_by(f64::total_cmp);
    Some(Ratio {
        value: a.seconds() / b.seconds(),
        low: quantile(&ratios, 0.025),
        high: quantile(&ratios, 0.975),
        bound,
    })
}

fn resample(curve: &Curve, random: &mut Random) -> Curve {
    let draw = |points: &Vec<(f64, f64)>, random: &mut Random| {
        points.iter().map(|_| points[random.below(points.len())]).collect::<Vec<_>>()
    };
    curve.iter().map(|points| draw(points, random)).collect()
}

/// SplitMix64 with a fixed seed: every run draws the same resamples.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((u128::from(z ^ (z >> 31)) * n as u128) >> 64) as usize
    }
}

/// An error inside every curve if there is one: halfway (in logarithms) between the least error that all
/// reach and the greatest that all start above. Otherwise the least error that all reach. A curve that never
/// gets below the start of the first, because its renderer misses some light, is left out.
pub fn common_error(curves: &[Vec<(f64, f64)>]) -> Option<f64> {
    let ends = |c: &Vec<(f64, f64)>| {
        let best = c.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        c.first().map(|first| (first.1, best))
    };
    let mut ends: Vec<(f64, f64)> = curves.iter().filter_map(ends).collect();
    let begins = ends.first()?.0;
    ends.retain(|e| e.1 <= begins);
    let reached = ends.iter().map(|e| e.1).reduce(f64::max)?;
    let start = ends.iter().map(|e| e.0).reduce(f64::min)?;
    Some(if start > reached && reached > 0.0 { (start * reached).sqrt() } else { reached })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_of_few_values() {
        assert_eq!(Spread::of(&[3.0, 1.0, 2.0]), Spread { median: 2.0, low: 1.5, high: 2.5 });
        assert_eq!(Spread::of(&[5.0]).high, 5.0);
        assert_eq!(Spread::of(&[]).median, 0.0);
    }

    #[test]
    fn slope_of_monte_carlo() {
        let points: Vec<_> = [1.0f64, 4.0, 16.0, 64.0].map(|t| (t, 0.3 * t.powf(-0.5))).to_vec();
        let law = power_law(&points).unwrap();
        assert!((law.slope + 0.5).abs() < 1e-12 && (law.scale - 0.3).abs() < 1e-12);
        assert!(law.slope_error.unwrap() < 1e-9);
        assert_eq!(power_law(&[(1.0, 2.0)]), None);
        assert_eq!(power_law(&[(2.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(power_law(&[(1.0, 0.0), (2.0, 1.0)]), None);
        assert_eq!(power_law(&[(1.0, 1.0), (4.0, 0.5)]).unwrap().slope_error, None);
    }

    #[test]
    fn slope_error_as_in_a_textbook() {
        // y = x with residuals ±ln 2: variance of the slope is (4 ln²2 / 2) / Σ(x − mean)².
        let points: Vec<_> = [(0.0, 1.0), (1.0, -1.0), (2.0, -1.0), (3.0, 1.0)]
            .map(|(x, s)| (f64::exp(x), f64::exp(x + s * 2f64.ln())))
            .to_vec();
        let law = power_law(&points).unwrap();
        assert!((law.slope - 1.0).abs() < 1e-12);
        assert!((law.slope_error.unwrap() - (2.0 * 2f64.ln().powi(2) / 5.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn time_between_budgets_is_interpolated_in_logarithms() {
        let curve = [(1.0, 0.4), (4.0, 0.2), (16.0, 0.1)];
        assert_eq!(time_to_error(&curve, 0.5), Some(Reach::Before(1.0)));
        assert_eq!(time_to_error(&curve, 0.05), Some(Reach::After(16.0)));
        let Some(Reach::At(t)) = time_to_error(&curve, 0.4 / 2f64.sqrt()) else { panic!() };
        assert!((t - 2.0).abs() < 1e-12, "{t}");
        let Some(Reach::At(t)) = time_to_error(&curve, 0.1) else { panic!() };
        assert!((t - 16.0).abs() < 1e-9);
        assert_eq!(time_to_error(&[], 0.1), None);
        assert!(matches!(time_to_error(&[(1.0, 1.0), (2.0, 0.0)], 0.5), Some(Reach::At(_))));
    }

    #[test]
    fn times_beyond_the_curve_follow_its_power_law() {
        // error = 0.4 / √t: 0.05 is reached at 64, 0.2 at 4.
        let curve = [1.0f64, 2.0, 8.0, 16.0].map(|t| (t, 0.4 / t.sqrt()));
        let Some(Reach::About(t)) = reach(&curve, 0.05) else { panic!() };
        assert!((t - 64.0).abs() < 1e-9, "{t}");
        let Some(Reach::At(t)) = reach(&curve, 0.2) else { panic!() };
        assert!((t - 4.0).abs() < 1e-9, "{t}");
        assert_eq!(reach(&curve, 0.4), Some(Reach::Before(1.0)));
        assert_eq!(reach(&curve, 0.0), Some(Reach::After(16.0)));
        // The error has stopped falling, or nothing is known of how it falls.
        assert_eq!(reach(&[(1.0, 0.4), (4.0, 0.1), (8.0, 0.1), (16.0, 0.1)], 0.05), Some(Reach::After(16.0)));
        assert_eq!(reach(&[(16.0, 0.1)], 0.05), Some(Reach::After(16.0)));
    }

    #[test]
    fn the_interval_holds_the_true_ratio() {
        // The one curve takes 4 times as long as the other to any error; both are noisy.
        let noise = [0.93, 1.02, 1.06, 0.98, 1.01];
        let curve = |factor: f64| -> Curve {
            let budgets = [1.0, 2.0, 4.0, 8.0];
            budgets.map(|t| noise.map(|n| (t * factor, n * t.powf(-0.5))).to_vec()).to_vec()
        };
        let ratio = time_ratio(&curve(4.0), &curve(1.0), 0.5).unwrap();
        assert!((ratio.value - 4.0).abs() < 1e-9, "{ratio:?}");
        assert!(ratio.low < 4.0 && ratio.high > 4.0 && ratio.high - ratio.low < 2.0, "{ratio:?}");
        assert!(!ratio.bound);
        assert!(time_ratio(&curve(4.0), &curve(1.0), 1e-3).unwrap().bound);
        assert_eq!(time_ratio(&Vec::new(), &curve(1.0), 0.5), None);
        assert_eq!(time_ratio(&curve(4.0), &curve(1.0), 0.5), Some(ratio), "the same in every run");
    }

    #[test]
    fn an_error_that_all_curves_cross() {
        let a = vec![(1.0, 0.4), (4.0, 0.1)];
        let b = vec![(1.0, 0.9), (4.0, 0.2)];
        let e = common_error(&[a.clone(), b]).unwrap();
        assert!((e - (0.4f64 * 0.2).sqrt()).abs() < 1e-12);
        let never = vec![(1.0, 0.9), (4.0, 0.6)];
        assert_eq!(common_error(&[a.clone(), never.clone()]), Some(0.2), "as of the first alone");
        assert_eq!(common_error(&[a, vec![(1.0, 0.35), (4.0, 0.3)], never]), Some((0.35f64 * 0.3).sqrt()));
        assert_eq!(common_error(&[]), None);
    }
}
