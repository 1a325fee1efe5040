use super::check::Thresholds;
use super::comparison::CompareOptions;
use crate::flip::{DEFAULT_PPD, Tonemapper};
use crate::metrics::{VarianceKind, ZTestOptions};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Arguments of `caustica compare`.
///
/// Exit status: 0 if every threshold holds, 1 if one does not, 2 if something could not be compared.
#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    /// Image, or folder of images
    pub image: PathBuf,
    /// Reference, or folder of references; image and reference have the same path up to extension and `.ref`
    pub reference: PathBuf,
    /// Compare this layer (channels `NAME.R` ...) instead of R G B
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Layer of the reference, if it has another name
    #[arg(long, value_name = "NAME")]
    pub reference_layer: Option<String>,
    /// Mask: pixels above one half count [default: `X.mask.exr` beside reference `X.exr`]
    #[arg(long, value_name = "FILE")]
    pub mask: Option<PathBuf>,
    /// Variance image for the z-test [default: `X.var.exr` or `X_var.exr` beside reference `X.exr`]
    #[arg(long, value_name = "FILE")]
    pub variance: Option<PathBuf>,
    /// What the variance image holds [default: `sample` for `*_var.*`, else `mean`]
    #[arg(long, value_name = "KIND")]
    pub variance_of: Option<VarianceOf>,
    /// Samples per pixel of the image, for the z-test
    #[arg(long, value_name = "N")]
    pub spp: Option<f64>,
    /// Samples per pixel of the reference: with --spp, the z-test includes the noise of the image
    #[arg(long, value_name = "N")]
    pub reference_spp: Option<f64>,
    /// Limit of the mean LDR-FLIP
    #[arg(long, value_name = "LIMIT")]
    pub max_flip: Option<f64>,
    /// Limit of the mean HDR-FLIP
    #[arg(long, value_name = "LIMIT", conflicts_with = "no_hdr")]
    pub max_hdr_flip: Option<f64>,
    /// Limit of the RMSE over all channels
    #[arg(long, value_name = "LIMIT")]
    pub max_rmse: Option<f64>,
    /// Limit of relMSE
    #[arg(long, value_name = "LIMIT")]
    pub max_relmse: Option<f64>,
    /// Limit of the relative bias of every channel (0.01 is 1 %)
    #[arg(long, value_name = "LIMIT")]
    pub max_bias: Option<f64>,
    /// The z-test must accept
    #[arg(long)]
    pub z_test: bool,
    /// Exposure in stops of both pictures for LDR-FLIP
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    pub exposure: f64,
    /// Pixels per degree for FLIP, from 1 to 10000
    #[arg(long, value_name = "N", default_value_t = DEFAULT_PPD, value_parser = pixels_per_degree)]
    pub ppd: f64,
    /// Tonemapper of HDR-FLIP
    #[arg(long, value_name = "NAME", default_value = "aces")]
    pub tonemapper: Tonemapper,
    /// Skip HDR-FLIP, the slowest metric
    #[arg(long)]
    pub no_hdr: bool,
    /// Signal of PSNR
    #[arg(long, value_name = "PEAK", default_value_t = 1.0)]
    pub psnr_peak: f64,
    /// Print JSON instead of the table, or write it to FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub json: Option<Option<PathBuf>>,
    /// Write one self-contained HTML page of all comparisons
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the LDR-FLIP map: magma colours (.png), or values (.pfm, .exr); for folders, a folder
    #[arg(long, value_name = "FILE")]
    pub error_map: Option<PathBuf>,
}

/// What a variance image holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum VarianceOf {
    /// Variance of one sample (Mitsuba's `moment` integrator)
    Sample,
    /// Variance of the pixel's mean
    Mean,
}

impl From<VarianceOf> for VarianceKind {
    fn from(v: VarianceOf) -> Self {
        match v {
            VarianceOf::Sample => Self::OfSample,
            VarianceOf::Mean => Self::OfMean,
        }
    }
}

/// FLIP's filters reach a seventh of a degree: more pixels per degree would take minutes and much memory.
fn pixels_per_degree(text: &str) -> Result<f64, String> {
    let ppd = text.parse().ok().filter(|ppd| (1.0..=1e4).contains(ppd));
    ppd.ok_or_else(|| "expected a number from 1 to 10000".to_owned())
}

impl CompareArgs {
    /// The arguments for two paths, everything else at its default.
    pub fn new(image: impl Into<PathBuf>, reference: impl Into<PathBuf>) -> Self {
        Self {
            image: image.into(),
            reference: reference.into(),
            layer: None,
            reference_layer: None,
            mask: None,
            variance: None,
            variance_of: None,
            spp: None,
            reference_spp: None,
            max_flip: None,
            max_hdr_flip: None,
            max_rmse: None,
            max_relmse: None,
            max_bias: None,
            z_test: false,
            exposure: 0.0,
            ppd: DEFAULT_PPD,
            tonemapper: Tonemapper::default(),
            no_hdr: false,
            psnr_peak: 1.0,
            json: None,
            html: None,
            error_map: None,
        }
    }

    /// The options of each comparison.
    pub(super) fn options(&self) -> CompareOptions {
        CompareOptions {
            ppd: self.ppd,
            exposure: self.exposure,
            hdr: (!self.no_hdr).then_some(self.tonemapper),
            psnr_peak: self.psnr_peak,
            z_test: ZTestOptions {
                samples: self.spp,
                reference_samples: self.reference_spp,
                ..ZTestOptions::default()
            },
            thresholds: Thresholds {
                flip: self.max_flip,
                hdr_flip: self.max_hdr_flip,
                rmse: self.max_rmse,
                relmse: self.max_relmse,
                bias: self.max_bias,
                z_test: self.z_test,
            },
        }
    }
}
