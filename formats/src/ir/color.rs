//! Colours as an author wrote them. `crate::spectrum::to_linear_rgb` turns them into linear Rec.709.

use serde::{Deserialize, Serialize};

use super::table::plain;

/// A colour in the units of the file it came from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Color {
    /// A plain number: gray in every slot.
    Gray(f64),
    /// Linear Rec.709 components.
    Rgb([f64; 3]),
    /// sRGB-encoded components in 0..1 (Mitsuba 0.6 `<srgb>`).
    Srgb([f64; 3]),
    /// One value at all wavelengths, `<spectrum value="v"/>`; on an emitter Mitsuba 3 tints it.
    UniformSpectrum(f64),
    /// The `uniform` spectrum plugin: gray in every slot, never tinted.
    UniformPlugin(f64),
    /// The `srgb` spectrum plugin: linear components that must lie in 0..1.
    BoundedRgb([f64; 3]),
    /// Wavelength in nm (ascending) and value, linearly interpolated, zero outside.
    Samples(Vec<[f64; 2]>),
    /// CIE D65 scaled, optionally coloured: white (1, 1, 1) at scale 1.
    D65 {
        /// Factor on all wavelengths.
        scale: f64,
        /// Linear components.
        color: Option<[f64; 3]>,
    },
    /// Planck radiance in W·m⁻²·sr⁻¹·nm⁻¹ times `scale` (Mitsuba 0.6).
    Blackbody {
        /// Temperature.
        kelvin: f64,
        /// Factor on all wavelengths.
        scale: f64,
    },
    /// A spectrum of pbrt's library: `metal-Cu-eta`, `glass-BK7`, `stdillum-A` (luminance 1), …
    Library(String),
    /// The spectrum scaled to luminance `luminance` (pbrt's lights).
    WithLuminance {
        /// Its shape.
        spectrum: Box<Color>,
        /// Y of the result.
        luminance: f64,
    },
}

/// Which renderer's rule turns spectra into RGB; they differ by up to 20 % (Mitsuba 3 weights
/// reflectance spectra by D65, 0.6 does not; pbrt's are lit by D65 as well).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpectrumRule {
    /// Mitsuba 0.x.
    Mitsuba06,
    /// Mitsuba 2.x.
    Mitsuba2,
    /// Mitsuba 3.x.
    Mitsuba3,
    /// pbrt-v4.
    Pbrt,
}

/// What a colour is used for; decides weighting and clamping in [`crate::spectrum::to_linear_rgb`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorSlot {
    /// Bounded to 0..1.
    Reflectance,
    /// eta, k and other coefficients: only bounded below.
    Unbounded,
    /// Radiance, intensity or irradiance.
    Emission,
}

plain! { Color }
