//! Colours as written → linear Rec.709, by the rule of the renderer a scene was made for.
//!
//! Mitsuba 2 and 3 integrate over 1000 points with weight 470/1000 and divide by a fixed ȳ
//! integral; Mitsuba 0.6 integrates exactly, and so do we for pbrt, whose own renderer is spectral:
//! reflectances are lit by D65, lights and indices by equal energy. Mitsuba 3 alone weights reflectances by D65 and tints
//! single-valued emission spectra. (0.6 tabulates the observer every nm instead of every 5 nm; that
//! changes the bluest blackbodies by 4e-4.)

use thiserror::Error;

use super::integrate::{exact_samples, exact_smooth, interpolate, lit_by_d65, thousand_points};
use super::{LibrarySpectrum, cie, library_spectrum, srgb_to_linear};
use crate::ir::{Color, ColorSlot, SpectrumRule};

/// Why a colour has no RGB value.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SpectrumError {
    /// A component is infinite or NaN.
    #[error("a colour must consist of finite numbers")]
    NotFinite,
    /// A bounded colour has a component outside 0..1.
    #[error("RGB reflectance ({}, {}, {}) must lie in the range [0, 1]", .0[0], .0[1], .0[2])]
    OutOfRange([f64; 3]),
    /// Wavelengths must ascend.
    #[error("wavelengths must increase, but {next} nm follows {previous} nm")]
    NotAscending {
        /// A wavelength.
        previous: f64,
        /// The one after it, which is not longer.
        next: f64,
    },
    /// A spectrum needs two samples.
    #[error("a spectrum needs at least two wavelengths, this one has {0}")]
    TooFewSamples(usize),
    /// A blackbody needs a temperature above zero.
    #[error("a blackbody temperature must be positive, not {0} K")]
    BadTemperature(f64),
    /// No spectrum has this name.
    #[error("no spectrum named `{0}`")]
    UnknownName(String),
}

/// The linear Rec.709 triple that the renderer behind `rule` uses for `color` in `slot`.
///
/// Mitsuba 2 and 3 cannot evaluate blackbodies in RGB; here they are integrated like any emission spectrum.
///
/// # Errors
/// For colours out of range where that renderer rejects them (RGB reflectances in Mitsuba 2 and 3, the `srgb`
/// plugin everywhere), for spectra with too few or unordered samples, and for unknown names.
pub fn to_linear_rgb(color: &Color, slot: ColorSlot, rule: SpectrumRule) -> Result<[f64; 3], SpectrumError> {
    let rgb = match color {
        Color::Gray(v) | Color::UniformPlugin(v) => [*v; 3],
        Color::UniformSpectrum(v) => {
            // An equal-energy spectrum has XYZ = (v, v, v); only Mitsuba 3 converts it.
            if rule == SpectrumRule::Mitsuba3 && slot == ColorSlot::Emission {
                xyz_to_rgb([*v; 3])
            } else {
                [*v; 3]
            }
        }
        Color::Rgb(rgb) => {
            finite(*rgb)?;
            if slot == ColorSlot::Reflectance && rule != SpectrumRule::Mitsuba06 {
                in_unit_range(*rgb)?;
            }
            *rgb
        }
        Color::BoundedRgb(rgb) => {
            finite(*rgb)?;
            in_unit_range(*rgb)?;
            *rgb
        }
        Color::Srgb(encoded) => encoded.map(srgb_to_linear),
        Color::Samples(samples) => {
            check_samples(samples)?;
            let d65 = rule == SpectrumRule::Mitsuba3 && slot != ColorSlot::Emission;
            let xyz = match rule {
                SpectrumRule::Pbrt if slot == ColorSlot::Reflectance => lit_by_d65(samples),
                SpectrumRule::Mitsuba06 | SpectrumRule::Pbrt => exact_samples(samples),
                _ => thousand_points(|nm| {
                    let illuminant = if d65 { cie::d65(nm) / D65_INTEGRAL } else { 1.0 };
                    interpolate(samples, nm) * illuminant
                }),
            };
            clamp(xyz_to_rgb(xyz), slot, rule)
        }
        Color::D65 { scale, color } => color.unwrap_or([1.0; 3]).map(|c| c * scale),
        Color::Blackbody { kelvin, scale } => {
            if !(kelvin.is_finite() && *kelvin > 0.0) {
                return Err(SpectrumError::BadTemperature(*kelvin));
            }
            let power = |nm| planck(nm, *kelvin);
            let xyz = match rule {
                SpectrumRule::Mitsuba06 | SpectrumRule::Pbrt => exact_smooth(power),
                _ => thousand_points(power),
            };
            clamp(xyz_to_rgb(xyz), ColorSlot::Emission, rule).map(|c| c * scale)
        }
        Color::Library(name) => match library_spectrum(name) {
            Some(LibrarySpectrum::Coefficient(rgb)) => rgb,
            Some(LibrarySpectrum::Index(index)) => [index; 3],
            Some(LibrarySpectrum::Illuminant([x, y])) => {
                clamp(xyz_to_rgb([x / y, 1.0, (1.0 - x - y) / y]), ColorSlot::Emission, rule)
            }
            None => return Err(SpectrumError::UnknownName(name.clone())),
        },
        Color::WithLuminance { spectrum, luminance: wanted } => {
            let rgb = to_linear_rgb(spectrum, ColorSlot::Emission, rule)?;
            let own = luminance(rgb);
            if own > 0.0 { rgb.map(|c| c * (wanted / own)) } else { [0.0; 3] }
        }
    };
    finite(rgb)?;
    Ok(rgb)
}

/// Luminance Y of a linear Rec.709 triple, with the weights Mitsuba uses.
pub fn luminance(rgb: [f64; 3]) -> f64 {
    0.212_671 * rgb[0] + 0.715_160 * rgb[1] + 0.072_169 * rgb[2]
}

/// Radiance of a blackbody at wavelength `nm`, in W·m⁻²·sr⁻¹·nm⁻¹ (CODATA 2018 constants).
pub fn planck(nm: f64, kelvin: f64) -> f64 {
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K: f64 = 1.380_649e-23;
    let metres = nm * 1e-9;
    let exponent = H * C / (metres * K * kelvin);
    2.0 * H * C * C / (metres.powi(5) * exponent.exp_m1()) * 1e-9
}

/// The greatest [`planck`] of a temperature over all wavelengths (Wien's displacement law; CODATA 2018).
pub fn greatest_planck(kelvin: f64) -> f64 {
    const WIEN: f64 = 2.897_771_955e-3;
    planck(WIEN / kelvin * 1e9, kelvin)
}

/// Mean of ȳ-weighted D65 in Mitsuba 3, so that white has luminance 1.
const D65_INTEGRAL: f64 = 98.997_417_518_762_55;

fn finite(rgb: [f64; 3]) -> Result<(), SpectrumError> {
    rgb.iter().all(|c| c.is_finite()).then_some(()).ok_or(SpectrumError::NotFinite)
}

fn in_unit_range(rgb: [f64; 3]) -> Result<(), SpectrumError> {
    rgb.iter().all(|c| (0.0..=1.0).contains(c)).then_some(()).ok_or(SpectrumError::OutOfRange(rgb))
}

fn check_samples(samples: &[[f64; 2]]) -> Result<(), SpectrumError> {
    if samples.len() < 2 {
        return Err(SpectrumError::TooFewSamples(samples.len()));
    }
    if samples.iter().flatten().any(|v| !v.is_finite()) {
        return Err(SpectrumError::NotFinite);
    }
    match samples.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        Some(pair) => Err(SpectrumError::NotAscending { previous: pair[0][0], next: pair[1][0] }),
        None => Ok(()),
    }
}

/// Negative components come from the small gamut and are clamped; reflectances above one are clamped by
/// Mitsuba 2 and 3 only.
fn clamp(rgb: [f64; 3], slot: ColorSlot, rule: SpectrumRule) -> [f64; 3] {
    let bounded = slot == ColorSlot::Reflectance && rule != SpectrumRule::Mitsuba06;
    let top = if bounded { 1.0 } else { f64::INFINITY };
    rgb.map(|c| c.clamp(0.0, top))
}

/// Linear Rec.709 of light of one wavelength in nm whose power is 1, in the units of the observer's curves.
pub(crate) fn wavelength_rgb(nm: f64) -> [f64; 3] {
    xyz_to_rgb(cie::observer(nm))
}

/// XYZ → linear Rec.709 (D65 white), with Mitsuba's rounding of the matrix.
pub(super) fn xyz_to_rgb([x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        3.240_479 * x - 1.537_150 * y - 0.498_535 * z,
        -0.969_256 * x + 1.875_991 * y + 0.041_556 * z,
        0.055_648 * x - 0.204_043 * y + 1.057_311 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::super::cornell;
    use super::*;
    use ColorSlot::{Emission, Reflectance, Unbounded};
    use SpectrumRule::{Mitsuba2, Mitsuba3, Mitsuba06};

    fn samples(pairs: &[(f64, f64)]) -> Color {
        Color::Samples(pairs.iter().map(|&(nm, v)| [nm, v]).collect())
    }

    fn cornell(values: &[f64]) -> Color {
        Color::Samples(values.iter().enumerate().map(|(i, &v)| [400.0 + 4.0 * i as f64, v]).collect())
    }

    /// Relative tolerance: `1e-5` is five significant digits, coarser where fewer were published.
    fn check(color: &Color, slot: ColorSlot, rule: SpectrumRule, expected: [f64; 3], tol: f64) {
        let rgb = to_linear_rgb(color, slot, rule).expect("a valid colour");
        for (got, want) in rgb.iter().zip(expected) {
            assert!((got - want).abs() <= tol * want.abs(), "{color:?} {rgb:?} {expected:?}");
        }
    }

    fn luminaire() -> Color {
        samples(&[(400.0, 0.0), (500.0, 8.0), (600.0, 15.6), (700.0, 18.4)])
    }

    #[test]
    fn cornell_box_as_mitsuba_3_measures_it() {
        let mi3 = |color: &Color, expected| check(color, Reflectance, Mitsuba3, expected, 5e-6);
        mi3(&cornell(&cornell::WHITE), [0.735013, 0.735625, 0.736264]);
        mi3(&cornell(&cornell::RED), [0.491320, 0.0492281, 0.0509219]);
        mi3(&cornell(&cornell::GREEN), [0.0682825, 0.397760, 0.0862909]);
        mi3(&samples(&[(400.0, 0.78), (700.0, 0.78)]), [0.776367, 0.779810, 0.776029]);
        check(&luminaire(), Emission, Mitsuba3, [20.7108, 10.8546, 2.77115], 5e-6);
    }

    #[test]
    fn spectra_as_mitsuba_3_measures_them() {
        let flat = |nm0, nm1, v| samples(&[(nm0, v), (nm1, v)]);
        let (half, one) = (flat(400.0, 700.0, 0.5), flat(360.0, 830.0, 1.0));
        check(&half, Reflectance, Mitsuba3, [0.497671, 0.499878, 0.497455], 5e-6);
        check(&one, Reflectance, Mitsuba3, [0.998985, 0.998874, 0.998802], 5e-6);
        check(&one, Emission, Mitsuba3, [1.20488, 0.948228, 0.909267], 5e-6);
        let visible = flat(400.0, 700.0, 1.0);
        check(&visible, Emission, Mitsuba3, [1.19969, 0.949520, 0.903443], 5e-6);
        let bumpy = samples(&[(400.0, 0.56), (500.0, 0.18), (600.0, 0.58), (700.0, 0.24)]);
        check(&bumpy, Reflectance, Mitsuba3, [0.612992, 0.333443, 0.348005], 5e-6);
        check(&bumpy, Emission, Mitsuba3, [0.704161, 0.320474, 0.320468], 5e-6);
        check(&flat(400.0, 700.0, 1.5), Unbounded, Mitsuba3, [1.49301, 1.49963, 1.49236], 5e-6);
        let two = Color::UniformSpectrum(2.0);
        check(&two, Emission, Mitsuba3, [2.40959, 1.89658, 1.81783], 5e-6);
        for rule in [Mitsuba06, Mitsuba2] {
            check(&two, Emission, rule, [2.0; 3], 0.0);
        }
        check(&two, Unbounded, Mitsuba3, [2.0; 3], 0.0);
    }

    /// The published values have three digits and were normalised by 3.x's ȳ integral, 0.1 % lower.
    #[test]
    fn cornell_box_in_mitsuba_06() {
        let old = |color: &Color, expected| check(color, Reflectance, Mitsuba06, expected, 2.2e-3);
        old(&cornell(&cornell::WHITE), [0.886, 0.700, 0.667]);
        old(&cornell(&cornell::RED), [0.570, 0.0431, 0.0444]);
        old(&cornell(&cornell::GREEN), [0.1053, 0.3785, 0.0764]);
        old(&samples(&[(400.0, 0.78), (700.0, 0.78)]), [0.937, 0.741, 0.7055]);
        check(&luminaire(), Emission, Mitsuba06, [20.73, 10.865, 2.774], 1.1e-3);
        let eta = samples(&[(400.0, 1.5), (700.0, 1.5)]);
        check(&eta, Unbounded, Mitsuba06, [1.7996, 1.4242, 1.3554], 5e-5);
    }

    #[test]
    fn blackbodies() {
        let table = [
            (2700.0, [314.192, 130.498, 31.168]),
            (3000.0, [733.113, 349.569, 112.709]),
            (5000.0, [15263.1, 12082.6, 9592.58]),
            (6500.0, [43918.7, 41407.3, 43582.8]),
        ];
        for (kelvin, expected) in table {
            let body = Color::Blackbody { kelvin, scale: 1.0 };
            check(&body, Emission, Mitsuba06, expected, 1.5e-5);
            let bright = Color::Blackbody { kelvin, scale: 10.0 };
            check(&bright, Emission, Mitsuba3, expected.map(|c| c * 10.0), 2e-5);
        }
        let cold = Color::Blackbody { kelvin: 0.0, scale: 1.0 };
        let error = to_linear_rgb(&cold, Emission, Mitsuba06);
        assert_eq!(error, Err(SpectrumError::BadTemperature(0.0)));
    }

    #[test]
    fn mitsuba_2_does_not_weight_by_d65() {
        let visible = samples(&[(400.0, 0.5), (700.0, 0.5)]);
        check(&visible, Reflectance, Mitsuba2, [0.599845, 0.474760, 0.451721], 1e-5);
    }

    /// White must stay white to the six digits of the matrix; Mitsuba 3's quadrature is 0.1 % off.
    #[test]
    fn pbrt_reflectances_are_lit_by_d65() {
        let one = samples(&[(300.0, 1.0), (900.0, 1.0)]);
        check(&one, Reflectance, SpectrumRule::Pbrt, [1.0; 3], 3e-6);
        let red = cornell(&cornell::RED);
        check(&red, Reflectance, SpectrumRule::Pbrt, [0.491320, 0.0492281, 0.0509219], 3e-3);
        check(&one, Emission, SpectrumRule::Pbrt, [1.2048, 0.9482, 0.9091], 1e-3);
    }

    #[test]
    fn pbrt_lights_have_the_luminance_that_is_asked_for() {
        let body = Color::Blackbody { kelvin: 3000.0, scale: 7.0 };
        let light = Color::WithLuminance { spectrum: Box::new(body.clone()), luminance: 2.0 };
        let rgb = to_linear_rgb(&light, Emission, SpectrumRule::Pbrt).expect("valid");
        let own = to_linear_rgb(&body, Emission, SpectrumRule::Pbrt).expect("valid");
        assert!((luminance(rgb) - 2.0).abs() < 1e-12);
        assert!((rgb[0] / rgb[2] - own[0] / own[2]).abs() < 1e-9);
        let glass = Color::Library("glass-BK7".to_owned());
        check(&glass, Unbounded, SpectrumRule::Pbrt, [1.5168; 3], 1e-9);
        let d65 = Color::Library("stdillum-D65".to_owned());
        check(&d65, Emission, SpectrumRule::Pbrt, [1.0; 3], 1e-3);
        let none = to_linear_rgb(&Color::Library("x".to_owned()), Emission, SpectrumRule::Pbrt);
        assert_eq!(none, Err(SpectrumError::UnknownName("x".to_owned())));
    }

    #[test]
    fn plain_colours_pass_through() {
        for rule in [Mitsuba06, Mitsuba2, Mitsuba3] {
            check(&Color::Gray(3.0), Emission, rule, [3.0; 3], 0.0);
            check(&Color::UniformPlugin(3.0), Emission, rule, [3.0; 3], 0.0);
            check(&Color::Rgb([5.0, 0.0, 1.0]), Emission, rule, [5.0, 0.0, 1.0], 0.0);
            let white = Color::D65 { scale: 2.0, color: None };
            check(&white, Emission, rule, [2.0; 3], 0.0);
            let tinted = Color::D65 { scale: 2.0, color: Some([0.5, 1.0, 0.0]) };
            check(&tinted, Emission, rule, [1.0, 2.0, 0.0], 0.0);
        }
        let srgb = Color::Srgb([1.0, 64.0 / 255.0, 0.0]);
        check(&srgb, Reflectance, Mitsuba06, [1.0, 0.0512695, 0.0], 1e-5);
    }

    #[test]
    fn what_mitsuba_rejects() {
        let bright = Color::Rgb([1.5, 0.0, 0.0]);
        let range = Err(SpectrumError::OutOfRange([1.5, 0.0, 0.0]));
        assert_eq!(to_linear_rgb(&bright, Reflectance, Mitsuba3), range);
        assert!(to_linear_rgb(&bright, Reflectance, Mitsuba06).is_ok());
        assert!(to_linear_rgb(&bright, Unbounded, Mitsuba3).is_ok());
        let plugin = Color::BoundedRgb([1.5, 0.0, 0.0]);
        assert_eq!(to_linear_rgb(&plugin, Emission, Mitsuba3), range);
        let back = samples(&[(500.0, 1.0), (400.0, 1.0)]);
        let order = SpectrumError::NotAscending { previous: 500.0, next: 400.0 };
        assert_eq!(to_linear_rgb(&back, Emission, Mitsuba3), Err(order));
        let single = to_linear_rgb(&samples(&[(500.0, 1.0)]), Emission, Mitsuba3);
        assert_eq!(single, Err(SpectrumError::TooFewSamples(1)));
        for bad in [Color::Gray(f64::NAN), Color::Rgb([f64::INFINITY, 0.0, 0.0])] {
            let error = to_linear_rgb(&bad, Emission, Mitsuba3);
            assert_eq!(error, Err(SpectrumError::NotFinite));
        }
    }

    #[test]
    fn negative_components_are_cut() {
        let cyan = samples(&[(480.0, 1.0), (520.0, 1.0)]);
        for rule in [Mitsuba06, Mitsuba2, Mitsuba3] {
            let rgb = to_linear_rgb(&cyan, Emission, rule).expect("valid");
            assert_eq!(rgb[0], 0.0);
            assert!(rgb[1] > 0.0);
        }
    }
}
