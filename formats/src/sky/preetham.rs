//! The sun of Preetham, Shirley and Smits ("A practical analytic model for daylight", 1999), which Mitsuba 0.6 has:
//! the solar spectrum outside of the atmosphere, dimmed by what the light passes through. The tables are those of
//! the paper (its appendix, after Iqbal, "An introduction to solar radiation", 1983).

use crate::ir::{Color, ColorSlot, SpectrumRule};
use crate::spectrum::to_linear_rgb;

/// Radiance of the sun without the atmosphere from 380 nm in steps of 10 nm, W·m⁻²·sr⁻¹·nm⁻¹.
#[rustfmt::skip]
const SOLAR: [f64; 38] = [
    16559.0, 16233.7, 21127.5, 25888.2, 25829.1, 24232.3, 26760.5, 29658.3, 30545.4, 30057.5,
    30663.7, 28830.4, 28712.1, 27825.0, 27100.6, 27233.6, 26361.3, 25503.8, 25060.2, 25311.6,
    25355.9, 25134.2, 24631.5, 24173.2, 23685.3, 23212.1, 22827.7, 22339.8, 21970.2, 21526.7,
    21097.9, 20728.3, 20240.4, 19870.8, 19427.2, 19072.4, 18628.9, 18259.2,
];

/// Absorption by ozone, cm⁻¹: below 445 nm (nothing from 355 nm), up to 610 nm, and beyond.
#[rustfmt::skip]
const OZONE: [(f64, f64, &[f64]); 3] = [
    (350.0, 5.0, &[0.007, 0.0]),
    (445.0, 5.0, &[
        0.003, 0.003, 0.004, 0.006, 0.008, 0.009, 0.012, 0.014, 0.017, 0.021, 0.025, 0.03, 0.035, 0.04,
        0.045, 0.048, 0.057, 0.063, 0.07, 0.075, 0.08, 0.085, 0.095, 0.103, 0.11, 0.12, 0.122, 0.12,
        0.118, 0.115, 0.12, 0.125, 0.13, 0.12,
    ]),
    (620.0, 10.0, &[
        0.105, 0.09, 0.079, 0.067, 0.057, 0.048, 0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.01, 0.009,
        0.007, 0.004, 0.0, 0.0,
    ]),
];

/// Absorption by mixed gases, cm⁻¹.
const GASES: [[f64; 2]; 4] = [[759.0, 0.0], [760.0, 3.0], [770.0, 0.21], [771.0, 0.0]];

/// Absorption by water vapour, cm⁻¹.
#[rustfmt::skip]
const WATER: [[f64; 2]; 13] = [
    [689.0, 0.0], [690.0, 0.016], [700.0, 0.024], [710.0, 0.0125], [720.0, 1.0], [730.0, 0.87], [740.0, 0.061],
    [750.0, 0.001], [760.0, 1e-5], [770.0, 1e-5], [780.0, 6e-4], [790.0, 0.0175], [800.0, 0.036],
];

/// Linear between the samples, zero outside.
fn at(samples: &[[f64; 2]], nm: f64) -> f64 {
    let Some(i) = samples.windows(2).position(|pair| (pair[0][0]..=pair[1][0]).contains(&nm)) else {
        return 0.0;
    };
    let ([a, x], [b, y]) = (samples[i], samples[i + 1]);
    x + (y - x) * (nm - a) / (b - a)
}

/// Linear Rec. 709 radiance of the sun at an angle from the zenith (radians), by the rule of Mitsuba 0.6.
pub(super) fn radiance(zenith: f64, turbidity: f64) -> [f64; 3] {
    let degrees = zenith.to_degrees();
    if degrees >= 93.885 {
        return [0.0; 3];
    }
    let haze = (0.046_083_658_220_5 * turbidity - 0.045_860_259_285_22).max(0.0);
    // Length of the way through the atmosphere, of that straight down.
    let mass = 1.0 / (zenith.cos() + 0.15 * (93.885 - degrees).powf(-1.253));
    let ozone: Vec<[f64; 2]> = OZONE
        .iter()
        .flat_map(|&(first, step, list)| {
            list.iter().zip(0..).map(move |(v, i)| [first + step * f64::from(i), *v])
        })
        .collect();
    let solar: Vec<[f64; 2]> = SOLAR.iter().zip(38..).map(|(v, i)| [10.0 * f64::from(i), *v]).collect();
    let band = |k: f64| 1.0 / (1.0 + k).powf(0.45);
    let samples = (70..=160).map(|i| {
        let nm = 5.0 * f64::from(i);
        let (gases, water) = (at(&GASES, nm) * mass, 2.0 * at(&WATER, nm) * mass);
        let depth = mass * 0.008_735 * (nm / 1000.0).powf(-4.08)
            + mass * haze * (nm / 1000.0).powf(-1.3)
            + mass * 0.35 * at(&ozone, nm)
            + 1.41 * gases * band(118.93 * gases)
            + 0.2385 * water * band(20.07 * water);
        [nm, at(&solar, nm) * (-depth).exp()]
    });
    let spectrum = Color::Samples(samples.collect());
    to_linear_rgb(&spectrum, ColorSlot::Emission, SpectrumRule::Mitsuba06)
        .expect("the samples are finite and their wavelengths ascend")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected: the formulas of the paper evaluated in Python with Mitsuba's tables of the observer, by a sum in steps
    /// of 1 nm, which misses the triangles of the 5 nm tables by less than 2·10⁻³.
    #[test]
    fn the_sun_is_that_of_the_paper() {
        for (height, turbidity, expected) in [
            (40.0f64, 2.0, [20938.0, 17573.0, 14552.0]),
            (20.0, 3.0, [13038.0, 9504.0, 5969.0]),
            (60.0, 6.0, [15400.0, 12051.0, 9124.0]),
            (5.0, 1.0, [10562.0, 6264.0, 2167.0]),
        ] {
            let rgb = radiance((90.0 - height).to_radians(), turbidity);
            for (got, want) in rgb.into_iter().zip(expected) {
                assert!((got / want - 1.0).abs() < 3e-3, "{height} {turbidity}: {rgb:?}");
            }
        }
        assert_eq!(radiance(1.7, 3.0), [0.0; 3]);
    }
}
