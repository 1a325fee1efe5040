use crate::pixels::{Pixels, luminance};
use rayon::prelude::*;
use serde::Serialize;

/// The values that a z-test compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Space {
    /// Red, green and blue.
    Rgb,
    /// CIE XYZ, as in Mitsuba's render tests.
    Xyz,
    /// Luminance alone, three times.
    Luminance,
}

impl Space {
    /// The values of this space.
    fn of(self, rgb: [f32; 3]) -> [f64; 3] {
        match self {
            Self::Rgb => rgb.map(f64::from),
            Self::Xyz => rgb_to_xyz(rgb.map(f64::from)),
            Self::Luminance => [f64::from(luminance(rgb)); 3],
        }
    }
}

/// What is known of the noise of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Of what the variances are.
    pub space: Space,
    /// Variance of the difference of the pictures, pixel by pixel; above 0.
    pub variance: Vec<[f64; 3]>,
}

/// Settings of the z-test; the defaults are those of Mitsuba's `test_renders.py`.
#[derive(Clone, Debug, PartialEq)]
pub struct ZTestOptions {
    /// Probability that any pixel of a correct image is rejected; the Šidák correction makes it that of one
    /// pixel.
    pub significance: f64,
    /// Share of all (pixel, channel) pairs that must be accepted.
    pub required_share: f64,
}

impl Default for ZTestOptions {
    fn default() -> Self {
        Self { significance: 0.01, required_share: 0.9975 }
    }
}

/// Result of a z-test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ZTest {
    /// The values compared.
    pub space: Space,
    /// Šidák-corrected significance of one pixel, `1 − (1 − significance)^(1/pixels)`.
    pub alpha: f64,
    /// Share of (pixel, channel) pairs whose p-value is above `alpha`.
    pub accepted_share: f64,
    /// The least `accepted_share` that passes.
    pub required_share: f64,
    /// Whether the image passes.
    pub accepted: bool,
    /// The smallest p-value.
    pub min_p: f64,
    /// Share of the pixels whose channels all lie within 4.5 standard deviations.
    pub within_4_5_sigma: f64,
    /// Mean of z²: 1 for an unbiased image with the stated variance.
    pub mean_z2: f64,
}

/// Per-pixel two-sided z-test of `image` against `reference`, with the variance of their difference
/// (Subr and Arvo 2007, "Statistical hypothesis testing for assessing Monte Carlo estimators").
///
/// `z² = (x − ref)² / variance`, `p = 2 (1 − Φ(|z|))`, and 99.75 % of the p-values must exceed the
/// Šidák-corrected 0.01.
pub fn z_test(image: &Pixels, reference: &Pixels, noise: &Noise, options: &ZTestOptions) -> ZTest {
    let pixels = image.rgb.len().max(1) as f64;
    let alpha = -f64::exp_m1(f64::ln_1p(-options.significance) / pixels);
    let chunks: Vec<Tally> = (image.rgb.par_chunks(super::CHUNK))
        .zip(reference.rgb.par_chunks(super::CHUNK))
        .zip(noise.variance.par_chunks(super::CHUNK))
        .map(|((x, r), v)| {
            let mut tally = Tally { min_p: 1.0, ..Tally::default() };
            for ((&x, &r), v) in x.iter().zip(r).zip(v) {
                let (x, r) = (noise.space.of(x), noise.space.of(r));
                tally.count(std::array::from_fn(|c| (x[c] - r[c]).powi(2) / v[c]), alpha);
            }
            tally
        })
        .collect();
    let total = chunks.into_iter().fold(Tally { min_p: 1.0, ..Tally::default() }, Tally::add);
    let accepted_share = total.accepted as f64 / (3.0 * pixels);
    ZTest {
        space: noise.space,
        alpha,
        accepted_share,
        required_share: options.required_share,
        accepted: accepted_share >= options.required_share,
        min_p: total.min_p,
        within_4_5_sigma: total.within as f64 / pixels,
        mean_z2: total.z2 / (3.0 * pixels),
    }
}

#[derive(Default)]
struct Tally {
    accepted: usize,
    within: usize,
    min_p: f64,
    z2: f64,
}

impl Tally {
    fn count(&mut self, squares: [f64; 3], alpha: f64) {
        let mut largest = 0.0f64;
        for z2 in squares {
            let p = libm::erfc((z2 / 2.0).sqrt());
            self.accepted += usize::from(p > alpha);
            self.min_p = self.min_p.min(p);
            self.z2 += z2;
            largest = largest.max(z2);
        }
        self.within += usize::from(largest <= 4.5 * 4.5);
    }

    fn add(self, other: Self) -> Self {
        Self {
            accepted: self.accepted + other.accepted,
            within: self.within + other.within,
            min_p: self.min_p.min(other.min_p),
            z2: self.z2 + other.z2,
        }
    }
}

/// Linear Rec.709 to CIE XYZ with the rounded matrix of ITU-R BT.709 that Mitsuba uses.
pub fn rgb_to_xyz([r, g, b]: [f64; 3]) -> [f64; 3] {
    [
        0.412453 * r + 0.357580 * g + 0.180423 * b,
        0.212671 * r + 0.715160 * g + 0.072169 * b,
        0.019334 * r + 0.119193 * g + 0.950227 * b,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Standard normal numbers from a hash: the sum of twelve uniforms is close enough here.
    fn normal(seed: u32) -> f32 {
        let mut h = seed.wrapping_mul(0x9E37_79B9) ^ 0x1234_5678;
        let mut s = 0.0;
        for _ in 0..12 {
            h = (h ^ (h >> 16)).wrapping_mul(0x7FEB_352D);
            h = (h ^ (h >> 15)).wrapping_mul(0x846C_A68B);
            h ^= h >> 16;
            s += h as f32 / 4_294_967_296.0;
        }
        s - 6.0
    }

    fn gray(f: impl Fn(usize) -> f32) -> Pixels {
        Pixels::from_fn(64, 64, |x, y| [f(y * 64 + x); 3])
    }

    fn noise(variance: f64) -> Noise {
        Noise { space: Space::Rgb, variance: vec![[variance; 3]; 64 * 64] }
    }

    #[test]
    fn sidak_correction() {
        let r = gray(|_| 0.5);
        let z = z_test(&r, &r, &noise(0.01), &ZTestOptions::default());
        assert!((z.alpha - (1.0 - 0.99f64.powf(1.0 / 4096.0))).abs() < 1e-15);
        assert_eq!((z.accepted_share, z.min_p, z.within_4_5_sigma), (1.0, 1.0, 1.0));
    }

    #[test]
    fn noise_of_the_stated_variance_is_accepted_and_a_shift_is_not() {
        let r = gray(|_| 1.0);
        let options = ZTestOptions::default();
        let noisy = gray(|i| 1.0 + 0.2 * normal(i as u32));
        let shifted = gray(|i| 1.6 + 0.2 * normal(i as u32));
        for space in [Space::Rgb, Space::Luminance] {
            let noise = Noise { space, ..noise(0.04) };
            let z = z_test(&noisy, &r, &noise, &options);
            assert!(z.accepted && (z.mean_z2 - 1.0).abs() < 0.1, "{z:?}");
            assert!(!z_test(&shifted, &r, &noise, &options).accepted);
        }
    }
}
