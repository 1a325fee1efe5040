//! `convert --check`: do both scenes give the same picture?

use std::path::Path;

use super::args::ConvertArgs;
use crate::cli::failure::Failure;
use crate::cli::{FAILED, report};
use crate::film::Pixels;
use crate::render::Budget;
use crate::session::{Options, Session};

/// Longer side of the picture and samples a pixel: some seconds at most.
pub const SIDE: u32 = 96;
pub const PASSES: u32 = 32;

/// Two renders of one scene with different seeds differ by √2 standard errors; over thousands of pixels,
/// chance does not make that half as much again.
const WORST_RATIO: f64 = 1.5;
/// By chance, the mean of a picture is off by more than this many standard errors once in 15 000 times.
const WORST_BIAS: f64 = 4.0;

/// Renders the source twice and the result once, and compares them. The exit status is 0 or 1.
///
/// # Errors
/// When one of the scenes cannot be opened.
pub fn run(args: &ConvertArgs) -> Result<u8, Failure> {
    let source = |seed| {
        let options = Options {
            defines: args.define.clone(),
            allow_paths: args.allow_path.clone(),
            spectrum_rule: args.spectral_to_rgb.rule(),
            ..small(args.lenient, seed)
        };
        picture(&args.input, &options)
    };
    let first = source(1)?;
    let other = source(2)?;
    // The result's folder holds all it needs; its spectra mean what its language says.
    let options = Options { spectrum_rule: None, ..small(args.lenient, 1) };
    let result = picture(&args.output, &options)?;
    if first.len() != result.len() {
        return Err(Failure::Work(format!(
            "check: the pictures differ in shape ({} and {} pixels)",
            first.len(),
            result.len()
        )));
    }
    let noise = Difference::of(&first, &other);
    let found = Difference::of(&first, &result);
    let error = mean_error(&first).hypot(mean_error(&result));
    let bias = if error > 0.0 { found.bias / error } else { 0.0 };
    let same = found.rmse == 0.0;
    let good = same || (found.rmse <= WORST_RATIO * noise.rmse && bias.abs() <= WORST_BIAS);
    let relative = |v: f64| if found.mean > 0.0 { 100.0 * v / found.mean } else { 0.0 };
    report::data(&if same {
        "check: the pictures are the same to the last bit".to_owned()
    } else {
        format!(
            "check: RMSE {:.3} % of the mean against {:.3} % of noise, bias {:+.3} % ({bias:+.1} standard errors): {}",
            relative(found.rmse),
            relative(noise.rmse),
            relative(found.bias),
            if good { "equal within noise" } else { "DIFFERENT" },
        )
    })?;
    Ok(if good { 0 } else { FAILED })
}

/// A small film and a few samples a pixel, by path tracing.
pub fn small(lenient: bool, seed: u64) -> Options {
    let settings =
        [("integrator", "path".to_owned()), ("passes", PASSES.to_string()), ("seed", seed.to_string())];
    Options {
        longest_side: Some(SIDE),
        lenient,
        settings: settings.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        ..Options::default()
    }
}

pub fn picture(scene: &Path, options: &Options) -> Result<Pixels, Failure> {
    let session = Session::open(scene, options)?;
    Ok(session.render(Budget::passes(PASSES), &mut |_| {}).pixels)
}

struct Difference {
    /// Of the second picture against the first, in luminance.
    rmse: f64,
    bias: f64,
    /// Of the first picture.
    mean: f64,
}

fn luminance(pixels: &Pixels, i: usize) -> f64 {
    caustica_formats::spectrum::luminance(pixels.beauty(i, PASSES))
}

impl Difference {
    fn of(a: &Pixels, b: &Pixels) -> Self {
        let count = a.len() as f64;
        let (mut squares, mut sum, mut mean) = (0.0, 0.0, 0.0);
        for i in 0..a.len() {
            let d = luminance(b, i) - luminance(a, i);
            squares += d * d;
            sum += d;
            mean += luminance(a, i);
        }
        Self { rmse: (squares / count).sqrt(), bias: sum / count, mean: mean / count }
    }
}

/// Standard error of the picture's mean: paths of different pixels are independent.
pub fn mean_error(pixels: &Pixels) -> f64 {
    let count = pixels.len() as f64;
    (pixels.mean_variance(PASSES) / count).sqrt()
}
