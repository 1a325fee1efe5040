//! Two pictures against each other: every metric, thresholds, verdict.

mod args;
mod check;
mod error;
mod errormap;
mod load;
mod mask;
mod pairs;
mod run;
mod table;

pub use args::{CompareArgs, VarianceOf};
pub use check::{Check, Thresholds};
pub use error::CompareError;
pub use load::{Loaded, load};
pub use mask::Mask;
pub use pairs::{Pair, Pairs, in_folders, variance_beside, variance_kind};
pub use run::{Failure, Report, Status, run};
pub use table::{write_rows, write_table};

use crate::flip::{self, DEFAULT_PPD, Exposures, FlipMap, FlipStats, HdrFlipMap, Tonemapper};
use crate::metrics::{self, Bias, Errors, Variance, ZTest, ZTestOptions};
use crate::pixels::Pixels;
use serde::Serialize;

/// How to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// Pixels per degree for FLIP.
    pub ppd: f64,
    /// Both pictures are multiplied by 2^exposure before LDR-FLIP.
    pub exposure: f64,
    /// Whether HDR-FLIP is computed, and its tonemapper.
    pub hdr: Option<Tonemapper>,
    /// Signal of PSNR.
    pub psnr_peak: f64,
    pub z_test: ZTestOptions,
    pub thresholds: Thresholds,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            ppd: DEFAULT_PPD,
            exposure: 0.0,
            hdr: Some(Tonemapper::default()),
            psnr_peak: 1.0,
            z_test: ZTestOptions::default(),
            thresholds: Thresholds::default(),
        }
    }
}

/// LDR-FLIP and how it was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LdrFlip {
    #[serde(flatten)]
    pub stats: FlipStats,
    pub ppd: f64,
    pub exposure: f64,
}

/// HDR-FLIP and how it was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HdrFlip {
    #[serde(flatten)]
    pub stats: FlipStats,
    pub tonemapper: Tonemapper,
    pub exposures: Exposures,
}

/// All numbers of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    pub name: String,
    pub image: String,
    pub reference: String,
    pub width: usize,
    pub height: usize,
    pub bias: Bias,
    #[serde(flatten)]
    pub errors: Errors,
    pub flip_ldr: LdrFlip,
    pub flip_hdr: Option<HdrFlip>,
    pub z_test: Option<ZTest>,
    /// What the reader should know, such as why there is no z-test.
    pub notes: Vec<String>,
    pub checks: Vec<Check>,
    /// Whether every check holds.
    pub holds: bool,
}

/// A comparison and the maps it was made from.
#[derive(Debug)]
pub struct Compared {
    pub comparison: Comparison,
    pub ldr: FlipMap,
    pub hdr: Option<HdrFlipMap>,
}

/// Compares two pictures of the same size with finite values. File names are the caller's to fill in.
///
/// # Panics
/// If the sizes differ; [`CompareError::Size`] is for whoever reads files.
pub fn compare(
    image: &Pixels,
    reference: &Pixels,
    variance: Option<Variance>,
    options: &CompareOptions,
) -> Compared {
    assert!(image.same_size(reference), "compared pictures have one size");
    let ldr = if options.exposure == 0.0 {
        flip::ldr(image, reference, options.ppd)
    } else {
        let factor = options.exposure.exp2() as f32;
        flip::ldr(&exposed(image, factor), &exposed(reference, factor), options.ppd)
    };
    let hdr = options.hdr.map(|tonemapper| {
        let exposures = Exposures::automatic(reference, tonemapper);
        flip::hdr(image, reference, options.ppd, exposures, tonemapper)
    });
    let mut comparison = Comparison {
        name: String::new(),
        image: String::new(),
        reference: String::new(),
        width: image.width,
        height: image.height,
        bias: metrics::bias(image, reference),
        errors: metrics::errors(image, reference, options.psnr_peak),
        flip_ldr: LdrFlip { stats: FlipStats::of(&ldr), ppd: options.ppd, exposure: options.exposure },
        flip_hdr: hdr.as_ref().map(|h| HdrFlip {
            stats: FlipStats::of(&h.map),
            tonemapper: h.tonemapper,
            exposures: h.exposures.clone(),
        }),
        z_test: variance.and_then(|v| metrics::z_test(image, reference, v, &options.z_test)),
        notes: Vec::new(),
        checks: Vec::new(),
        holds: true,
    };
    comparison.checks = options.thresholds.check(&comparison);
    comparison.holds = comparison.checks.iter().all(|c| c.holds);
    Compared { comparison, ldr, hdr }
}

fn exposed(pixels: &Pixels, factor: f32) -> Pixels {
    Pixels { rgb: pixels.rgb.iter().map(|p| p.map(|v| v * factor)).collect(), ..*pixels }
}
