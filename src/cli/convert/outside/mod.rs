//! `convert --check-with`: does the renderer whose language it is show the same picture as we do of the source?

mod installed;
mod mitsuba;
mod pbrt;

use caustica_formats::spectrum::luminance;

use super::args::{ConvertArgs, Renderer};
use super::check::{PASSES, mean_error, picture, small};
use crate::cli::failure::Failure;
use crate::cli::{FAILED, report};

/// Largest relative difference of the means beyond noise.
const LARGEST_BIAS: f64 = 0.01;
/// The same for pbrt, which multiplies spectra where we multiply RGB: a Cornell box with a red and a green wall is 1.1 %
/// darker in pbrt, with gray walls 0.01 %.
const LARGEST_BIAS_OF_SPECTRA: f64 = 0.02;
/// By chance, a mean is off by more than this many standard errors once in 15 000 times.
const SIGMAS: f64 = 4.0;

/// Compares our picture of the source with the other renderer's of the result. The exit status is 0 or 1; 0 with a
/// message where the renderer is not installed.
///
/// # Errors
/// When the source cannot be opened, or the other renderer refuses the result.
pub fn run(args: &ConvertArgs, renderer: Renderer) -> Result<u8, Failure> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let (theirs, largest_bias) = match renderer {
        Renderer::Mitsuba => (mitsuba::render(&args.output, &folder.path().join("pixels"))?, LARGEST_BIAS),
        Renderer::Pbrt => {
            (pbrt::render(&args.output, &folder.path().join("pixels.exr"))?, LARGEST_BIAS_OF_SPECTRA)
        }
    };
    let Some((name, theirs)) = theirs else { return Ok(0) };
    let options = crate::session::Options {
        defines: args.define.clone(),
        allow_paths: args.allow_path.clone(),
        spectrum_rule: args.spectral_to_rgb.rule(),
        ..small(args.lenient, 1)
    };
    let ours = picture(&args.input, &options)?;
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = values.fold((0, 0.0), |(n, sum), v| (n + 1, sum + v));
        sum / f64::from(count.max(1))
    };
    let before = mean(&mut ours.beauties(PASSES).map(luminance));
    // Their seeds tell how far their mean is off, rare bright paths included.
    let means: Vec<f64> = theirs
        .iter()
        .map(|picture| mean(&mut picture.iter().map(|rgb| luminance(rgb.map(f64::from)))))
        .collect();
    let count = means.len() as f64;
    let after = means.iter().sum::<f64>() / count;
    let spread: f64 = means.iter().map(|m| (m - after).powi(2)).sum();
    let theirs_off = (spread / (count * (count - 1.0).max(1.0))).sqrt();
    let bias = if after == before { 0.0 } else { after / before - 1.0 };
    let noise = mean_error(&ours).hypot(theirs_off) / before.max(f64::MIN_POSITIVE);
    let good = bias.abs() <= largest_bias.max(SIGMAS * noise);
    report::data(&format!(
        "check with {name}: its mean of the result is {after:.5}, ours of the source {before:.5}: {:+.2} % (noise {:.2} %): {}",
        100.0 * bias,
        100.0 * noise,
        if good { "equal" } else { "DIFFERENT" },
    ))?;
    Ok(if good { 0 } else { FAILED })
}
