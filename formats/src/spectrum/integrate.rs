//! Spectra to XYZ: the quadratures of the renderers, and exact ones.

use super::cie;

/// Integral of ȳ in Mitsuba 2 and 3.
const Y_INTEGRAL: f64 = 106.750_259_399_414_062_5;

/// Value of piecewise linear samples at `nm`, zero outside their range.
pub(super) fn interpolate(samples: &[[f64; 2]], nm: f64) -> f64 {
    let end = samples.partition_point(|sample| sample[0] < nm);
    if end == 0 {
        return if samples[0][0] == nm { samples[0][1] } else { 0.0 };
    }
    let Some(&[nm1, v1]) = samples.get(end) else { return 0.0 };
    let [nm0, v0] = samples[end - 1];
    v0 + (v1 - v0) * ((nm - nm0) / (nm1 - nm0))
}

/// XYZ by the quadrature of Mitsuba 2 and 3: its weight is 1/1000 of the range although the 1000
/// points span it with 999 gaps, which makes everything 0.1 % darker.
pub(super) fn thousand_points(power: impl Fn(f64) -> f64) -> [f64; 3] {
    const POINTS: u32 = 1000;
    let range = cie::LAST - cie::FIRST;
    let mut xyz = [0.0; 3];
    for i in 0..POINTS {
        let nm = cie::FIRST + range * f64::from(i) / f64::from(POINTS - 1);
        accumulate(&mut xyz, power(nm), cie::observer(nm));
    }
    xyz.map(|c| c * range / f64::from(POINTS) / Y_INTEGRAL)
}

/// XYZ of piecewise linear samples, exact: between two nodes of either curve the product is a
/// parabola, which Simpson's rule integrates without error.
pub(super) fn exact_samples(samples: &[[f64; 2]]) -> [f64; 3] {
    over_segments(samples, |_, value| value).map(|c| c / exact_y_integral())
}

/// ∫ power(λ, value) · (x̄, ȳ, z̄) between the first and the last sample, by Simpson's rule from node to
/// node of samples and tables.
fn over_segments(samples: &[[f64; 2]], power: impl Fn(f64, f64) -> f64) -> [f64; 3] {
    let (first, last) = (samples[0][0], samples[samples.len() - 1][0]);
    let inside = |nm: &f64| *nm >= first.max(cie::FIRST) && *nm <= last.min(cie::LAST);
    let nodes = (0..cie::OBSERVER.len()).map(|i| cie::FIRST + cie::STEP * i as f64);
    let mut breaks: Vec<f64> = nodes.chain(samples.iter().map(|sample| sample[0])).filter(inside).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    let mut xyz = [0.0; 3];
    for pair in breaks.windows(2) {
        simpson(&mut xyz, pair[0], pair[1], |nm| power(nm, interpolate(samples, nm)));
    }
    xyz
}

/// XYZ of a reflectance lit by D65, so scaled that a reflectance of 1 gives the XYZ of (1, 1, 1).
/// Between two nodes the product of the three lines is a cubic, which Simpson's rule still integrates
/// without error.
pub(super) fn lit_by_d65(samples: &[[f64; 2]]) -> [f64; 3] {
    let white = rgb_to_xyz_of_white();
    let total = over_segments(&[[cie::FIRST, 1.0], [cie::LAST, 1.0]], |nm, v| v * cie::d65(nm));
    let lit = over_segments(samples, |nm, v| v * cie::d65(nm));
    std::array::from_fn(|i| lit[i] / total[i] * white[i])
}

/// The XYZ that [`super::convert::xyz_to_rgb`] takes to (1, 1, 1), to its six digits: D65.
pub(super) fn rgb_to_xyz_of_white() -> [f64; 3] {
    [0.950_456, 1.0, 1.088_754]
}

/// XYZ of a smooth curve over the whole table, Simpson's rule in steps of 1 nm.
pub(super) fn exact_smooth(power: impl Fn(f64) -> f64) -> [f64; 3] {
    let mut xyz = [0.0; 3];
    for nm in cie::FIRST as u32..cie::LAST as u32 {
        simpson(&mut xyz, f64::from(nm), f64::from(nm + 1), &power);
    }
    xyz.map(|c| c / exact_y_integral())
}

/// Integral of the tabulated ȳ by the trapezoid rule, 106.857: the curve is linear between samples.
fn exact_y_integral() -> f64 {
    cie::OBSERVER.windows(2).map(|pair| (pair[0][1] + pair[1][1]) / 2.0 * cie::STEP).sum()
}

/// Adds ∫ power · (x̄, ȳ, z̄) over `a..b`.
fn simpson(xyz: &mut [f64; 3], a: f64, b: f64, power: impl Fn(f64) -> f64) {
    let weight = (b - a) / 6.0;
    for (nm, factor) in [(a, weight), ((a + b) / 2.0, 4.0 * weight), (b, weight)] {
        accumulate(xyz, power(nm) * factor, cie::observer(nm));
    }
}

fn accumulate(sum: &mut [f64; 3], weight: f64, value: [f64; 3]) {
    for (s, v) in sum.iter_mut().zip(value) {
        *s += weight * v;
    }
}
