use crate::pixels::Pixels;
use rayon::prelude::*;
use serde::Serialize;

/// What a variance image holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VarianceKind {
    /// Variance of one sample, as in Mitsuba's `moment` integrator and the `*_ref_rgb_var.exr` of its render
    /// tests. The test then needs the sample count of the tested image.
    OfSample,
    /// Variance of the pixel's mean, already divided by the number of samples.
    OfMean,
}

/// A variance image and its meaning.
#[derive(Clone, Copy, Debug)]
pub struct Variance<'a> {
    /// Variance per pixel and channel.
    pub pixels: &'a Pixels,
    /// Variance of what.
    pub kind: VarianceKind,
}

/// Settings of the z-test; the defaults are those of Mitsuba's `test_renders.py`.
#[derive(Clone, Debug, PartialEq)]
pub struct ZTestOptions {
    /// Probability that any pixel of a correct image is rejected; the Šidák correction makes it that of one
    /// pixel.
    pub significance: f64,
    /// Share of all (pixel, channel) pairs that must be accepted.
    pub required_share: f64,
    /// Samples per pixel of the tested image. [`VarianceKind::OfSample`] divides the variance by it; `OfMean`
    /// uses it together with `reference_samples`.
    pub samples: Option<f64>,
    /// Samples per pixel of the reference. With `OfMean` and `samples`, the variance of the tested image is
    /// taken as `variance · reference_samples / samples`.
    pub reference_samples: Option<f64>,
    /// Lower bound of the variance of one sample.
    pub floor: f64,
}

impl Default for ZTestOptions {
    fn default() -> Self {
        Self {
            significance: 0.01,
            required_share: 0.9975,
            samples: None,
            reference_samples: None,
            floor: 1e-4,
        }
    }
}

/// Result of a z-test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ZTest {
    /// What the variance image held.
    pub variance: VarianceKind,
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

/// Per-pixel two-sided z-test of `image` against `reference`, with a variance image of the same size
/// (Subr and Arvo 2007, "Statistical hypothesis testing for assessing Monte Carlo estimators").
///
/// With [`VarianceKind::OfSample`] this is the test of Mitsuba 3's `test_renders.py`: all three
/// images are converted to CIE XYZ, `z = |x − ref| · √(samples / max(variance, 1e-4))`,
/// `p = 2 (1 − Φ(z))`, and 99.75 % of the p-values must exceed the Šidák-corrected 0.01.
/// Returns `None` if `options.samples` is missing, because z then has no scale.
///
/// With [`VarianceKind::OfMean`] the channels stay RGB. The variance of the difference is that of
/// the reference plus, if both sample counts are known, `variance · reference_samples / samples`
/// for the tested image; otherwise the tested image is taken as exact.
pub fn z_test(
    image: &Pixels,
    reference: &Pixels,
    variance: Variance,
    options: &ZTestOptions,
) -> Option<ZTest> {
    let scale: Box<dyn Fn(f64) -> f64 + Sync> = match variance.kind {
        VarianceKind::OfSample => {
            let (n, floor) = (options.samples?, options.floor);
            Box::new(move |v| v.max(floor) / n)
        }
        VarianceKind::OfMean => {
            let reference = options.reference_samples;
            let ratio = reference.zip(options.samples).map_or(0.0, |(r, n)| r / n);
            // Without a count, a good reference's 1e6 samples are assumed.
            let floor = options.floor / reference.unwrap_or(1e6);
            Box::new(move |v| v.max(floor) * (1.0 + ratio))
        }
    };
    let channels = |rgb: [f32; 3]| {
        let rgb = rgb.map(f64::from);
        match variance.kind {
            VarianceKind::OfSample => rgb_to_xyz(rgb),
            VarianceKind::OfMean => rgb,
        }
    };

    let pixels = image.rgb.len().max(1) as f64;
    let alpha = -f64::exp_m1(f64::ln_1p(-options.significance) / pixels);
    let chunks: Vec<Tally> = (image.rgb.par_chunks(super::CHUNK))
        .zip(reference.rgb.par_chunks(super::CHUNK))
        .zip(variance.pixels.rgb.par_chunks(super::CHUNK))
        .map(|((x, r), v)| {
            let mut tally = Tally { min_p: 1.0, ..Tally::default() };
            for ((&x, &r), &v) in x.iter().zip(r).zip(v) {
                let (x, r, v) = (channels(x), channels(r), channels(v));
                let mut largest = 0.0f64;
                for c in 0..3 {
                    let z2 = (x[c] - r[c]).powi(2) / scale(v[c]);
                    let p = libm::erfc((z2 / 2.0).sqrt());
                    tally.accepted += usize::from(p > alpha);
                    tally.min_p = tally.min_p.min(p);
                    tally.z2 += z2;
                    largest = largest.max(z2);
                }
                tally.within += usize::from(largest <= 4.5 * 4.5);
            }
            tally
        })
        .collect();
    let total = chunks.into_iter().fold(Tally { min_p: 1.0, ..Tally::default() }, Tally::add);
    let accepted_share = total.accepted as f64 / (3.0 * pixels);
    Some(ZTest {
        variance: variance.kind,
        alpha,
        accepted_share,
        required_share: options.required_share,
        accepted: accepted_share >= options.required_share,
        min_p: total.min_p,
        within_4_5_sigma: total.within as f64 / pixels,
        mean_z2: total.z2 / (3.0 * pixels),
    })
}

#[derive(Default)]
struct Tally {
    accepted: usize,
    within: usize,
    min_p: f64,
    z2: f64,
}

impl Tally {
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
fn rgb_to_xyz([r, g, b]: [f64; 3]) -> [f64; 3] {
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

    #[test]
    fn sidak_correction() {
        let (r, v) = (gray(|_| 0.5), gray(|_| 0.01));
        let z = z_test(&r, &r, Variance { pixels: &v, kind: VarianceKind::OfMean }, &ZTestOptions::default());
        let z = z.unwrap();
        assert!((z.alpha - (1.0 - 0.99f64.powf(1.0 / 4096.0))).abs() < 1e-15);
        assert_eq!((z.accepted_share, z.min_p, z.within_4_5_sigma), (1.0, 1.0, 1.0));
    }

    #[test]
    fn noise_of_the_stated_variance_is_accepted_and_a_shift_is_not() {
        let v = gray(|_| 0.04);
        let r = gray(|_| 1.0);
        let options = ZTestOptions::default();
        let variance = Variance { pixels: &v, kind: VarianceKind::OfMean };
        let noisy = gray(|i| 1.0 + 0.2 * normal(i as u32));
        let z = z_test(&noisy, &r, variance, &options).unwrap();
        assert!(z.accepted && (z.mean_z2 - 1.0).abs() < 0.1, "{z:?}");
        let shifted = gray(|i| 1.6 + 0.2 * normal(i as u32));
        assert!(!z_test(&shifted, &r, variance, &options).unwrap().accepted);
    }

    #[test]
    fn variance_of_a_sample_needs_the_number_of_samples() {
        let (r, v) = (gray(|_| 1.0), gray(|_| 4.0));
        let variance = Variance { pixels: &v, kind: VarianceKind::OfSample };
        let noisy = gray(|i| 1.0 + 0.2 * normal(i as u32));
        assert_eq!(z_test(&noisy, &r, variance, &ZTestOptions::default()), None);
        let options = ZTestOptions { samples: Some(100.0), ..ZTestOptions::default() };
        let z = z_test(&noisy, &r, variance, &options).unwrap();
        // In XYZ a gray image's variance scales linearly and its squared error quadratically.
        assert!(z.accepted && (z.mean_z2 - 1.0).abs() < 0.15, "{z:?}");
    }
}
