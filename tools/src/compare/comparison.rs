//! Every number of one comparison.

use super::check::{Check, Thresholds};
use crate::flip::{self, DEFAULT_PPD, Exposures, FlipMap, FlipStats, HdrFlipMap, Tonemapper};
use crate::metrics::{self, Bias, Errors, Noise, ZTest, ZTestOptions};
use crate::pixels::Pixels;
use serde::Serialize;

/// How to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// Pixels per degree for FLIP.
    pub ppd: f64,
    /// Stops: both pictures are multiplied by 2^exposure before LDR-FLIP.
    pub exposure: f64,
    /// Tonemapper of HDR-FLIP; without one it is not computed.
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

/// LDR-FLIP and its parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LdrFlip {
    #[serde(flatten)]
    pub stats: FlipStats,
    pub ppd: f64,
    pub exposure: f64,
}

/// HDR-FLIP and its parameters.
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
    /// Name of the pair in tables.
    pub name: String,
    /// File of the image.
    pub image: String,
    /// File of the reference.
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
    /// Wall time of reading and comparing; not in the JSON, which is the same for the same pictures.
    #[serde(skip)]
    pub seconds: f64,
}

/// A comparison and its FLIP maps.
#[derive(Debug)]
pub struct Compared {
    pub comparison: Comparison,
    pub ldr: FlipMap,
    pub hdr: Option<HdrFlipMap>,
}

/// Compares two pictures of the same size. The caller fills in the names of the files.
///
/// # Panics
/// If the sizes differ.
pub fn compare(
    image: &Pixels,
    reference: &Pixels,
    noise: Option<&Noise>,
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
    let bias = metrics::bias(image, reference);
    let errors = metrics::errors(image, reference, options.psnr_peak);
    let flip_ldr = LdrFlip { stats: FlipStats::of(&ldr), ppd: options.ppd, exposure: options.exposure };
    let flip_hdr = hdr.as_ref().map(|h| HdrFlip {
        stats: FlipStats::of(&h.map),
        tonemapper: h.tonemapper,
        exposures: h.exposures.clone(),
    });
    let z_test = noise.map(|noise| metrics::z_test(image, reference, noise, &options.z_test));
    let flip_means = (flip_ldr.stats.mean, flip_hdr.as_ref().map(|h| h.stats.mean));
    let checks = options.thresholds.check(&bias, &errors, flip_means, z_test.as_ref());
    let holds = checks.iter().all(|c| c.holds);
    let comparison = Comparison {
        name: String::new(),
        image: String::new(),
        reference: String::new(),
        width: image.width,
        height: image.height,
        bias,
        errors,
        flip_ldr,
        flip_hdr,
        z_test,
        notes: Vec::new(),
        checks,
        holds,
        seconds: 0.0,
    };
    Compared { comparison, ldr, hdr }
}

fn exposed(pixels: &Pixels, factor: f32) -> Pixels {
    Pixels { rgb: pixels.rgb.iter().map(|p| p.map(|v| v * factor)).collect(), ..*pixels }
}
