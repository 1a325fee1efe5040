//! Renders a study's variants and separates bias from variance.

use super::catalogue::{Study, Variant};
use crate::bench::error::BenchError;
use crate::bench::files;
use crate::bench::judge::{Judged, judge, load_sized};
use crate::bench::record::fingerprint;
use crate::bench::renderers::{Job, Programs};
use crate::pixels::Pixels;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The measurement of a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    pub label: String,
    pub x: f64,
    pub group: String,
    pub seeds: u64,
    /// Means over seeds.
    pub seconds: f64,
    /// Of all threads; varies less than `seconds` on a shared machine.
    pub cpu_seconds: f64,
    pub rmse: f64,
    pub flip: f64,
    /// Difference of the means relative to the reference's.
    pub mean_bias: f64,
    /// Root of the mean over pixels of the squared bias, without the noise that few seeds leave in it.
    pub bias_rms: f64,
    /// Root of the mean over pixels of the variance over seeds.
    pub noise_rms: f64,
    /// Share of pixels that are black, but not in the reference.
    pub black: f64,
    pub image: PathBuf,
}

/// The means over pixels and channels of bias² and of the variance of one render, from n renders.
///
/// The variance is the sample variance (divided by n − 1). The squared error of the mean exceeds bias² by
/// variance / n, which is subtracted. With one render the variance is unknown and all error counts as bias.
pub fn separate(images: &[Pixels], reference: &Pixels) -> (f64, f64) {
    let n = images.len() as f64;
    let (mut bias2, mut variance) = (0.0, 0.0);
    for (i, truth) in reference.rgb.iter().enumerate() {
        for (c, truth) in truth.iter().enumerate() {
            let mean = images.iter().map(|p| f64::from(p.rgb[i][c])).sum::<f64>() / n;
            bias2 += (mean - f64::from(*truth)).powi(2);
            variance += images.iter().map(|p| (f64::from(p.rgb[i][c]) - mean).powi(2)).sum::<f64>();
        }
    }
    let count = (3 * reference.rgb.len()).max(1) as f64;
    let variance = if images.len() > 1 { variance / (n - 1.0) / count } else { 0.0 };
    ((bias2 / count - variance / n).max(0.0), variance)
}

/// Share of pixels at 0 whose reference is not.
fn black(image: &Pixels, reference: &Pixels) -> f64 {
    let dark = |p: &[f32; 3]| p.iter().all(|v| *v <= 0.0);
    let lost = image.rgb.iter().zip(&reference.rgb).filter(|(i, r)| dark(i) && !dark(r)).count();
    lost as f64 / reference.rgb.len().max(1) as f64
}

/// A scene, its reference, and the programs that render it.
#[derive(Debug)]
pub struct Bench<'a> {
    pub programs: &'a Programs,
    pub scene: &'a Path,
    pub reference: &'a Pixels,
    /// Folder of pictures and of finished variants.
    pub work: &'a Path,
}

impl Bench<'_> {
    /// Measures a variant, or reads what an earlier run measured.
    ///
    /// # Errors
    /// The renderer fails, or a file cannot be read or written.
    pub fn variant(&self, study: &Study, v: &Variant) -> Result<Measured, BenchError> {
        let scene = files::read(self.scene)?;
        let what = format!("{v:?} {}x{}", self.reference.width, self.reference.height);
        let truth: Vec<u8> = self.reference.rgb.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let key = fingerprint([scene.as_slice(), what.as_bytes(), &truth]);
        let done = self.work.join(format!("{}-{key}.json", study.name));
        if let Some(measured) = std::fs::read(&done).ok().and_then(|b| serde_json::from_slice(&b).ok()) {
            return Ok(measured);
        }
        let size = [self.reference.width, self.reference.height];
        let mut images = Vec::new();
        let mut sums = [0.0f64; 6];
        let first = self.work.join(format!("{}-{key}-0.exr", study.name));
        for seed in 0..v.seeds {
            let image = self.work.join(format!("{}-{key}-{seed}.exr", study.name));
            let job = Job { scene: self.scene, size, passes: v.passes, seed: seed + 1, image: &image };
            let made = self.programs.ours(&v.settings, &job)?;
            let pixels = load_sized(&image, self.scene, size)?;
            let Judged { rmse, bias, flip, .. } = judge(&pixels, self.reference);
            let values =
                [made.seconds, made.cpu_seconds, rmse * rmse, flip, bias, black(&pixels, self.reference)];
            sums.iter_mut().zip(values).for_each(|(s, v)| *s += v);
            images.push(pixels);
        }
        let [seconds, cpu_seconds, mse, flip, mean_bias, black] = sums.map(|s| s / v.seeds.max(1) as f64);
        let (bias2, variance) = separate(&images, self.reference);
        let measured = Measured {
            label: v.label.clone(),
            x: v.x,
            group: v.group.clone(),
            seeds: v.seeds,
            seconds,
            cpu_seconds,
            rmse: mse.sqrt(),
            flip,
            mean_bias,
            bias_rms: bias2.sqrt(),
            noise_rms: variance.sqrt(),
            black,
            image: first,
        };
        let json = serde_json::to_vec(&measured)
            .map_err(|source| BenchError::Json { path: done.clone(), source })?;
        files::write(&done, &json)?;
        Ok(measured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bias_and_variance_add_up_to_the_error() {
        let reference = Pixels::from_fn(8, 8, |_, _| [1.0; 3]);
        // Noise of ±0.2 around a bias of 0.1.
        let image = |s: f32| Pixels::from_fn(8, 8, |x, _| [1.1 + s * if x % 2 == 0 { 0.2 } else { -0.2 }; 3]);
        let images = [image(1.0), image(-1.0), image(1.0), image(-1.0)];
        let (bias2, variance) = separate(&images, &reference);
        assert!((variance - 0.04 * 4.0 / 3.0).abs() < 1e-6, "{variance}");
        assert!((bias2 - (0.01 - variance / 4.0).max(0.0)).abs() < 1e-6, "{bias2}");
        let (all, none) = separate(&images[..1], &reference);
        assert!((all - 0.05).abs() < 1e-6 && none == 0.0);
    }

    #[test]
    fn black_pixels_of_the_reference_do_not_count() {
        let reference = Pixels::from_fn(2, 1, |x, _| [x as f32; 3]);
        let image = Pixels::from_fn(2, 1, |_, _| [0.0; 3]);
        assert_eq!(black(&image, &reference), 0.5);
    }
}
