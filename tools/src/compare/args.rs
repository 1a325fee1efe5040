use super::check::Thresholds;
use super::comparison::CompareOptions;
use super::variance::VarianceKind;
use crate::flip::{DEFAULT_PPD, Tonemapper};
use crate::metrics::ZTestOptions;
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
    /// Variance of the reference for the z-test [default: `X.var.exr` or `X_var.exr` beside `X.exr`, or its layers]
    #[arg(long, value_name = "FILE")]
    pub variance: Option<PathBuf>,
    /// Variance of the image [default: `X.var.exr` or `X_var.exr` beside `X.exr`, or its layers]
    #[arg(long, value_name = "FILE")]
    pub image_variance: Option<PathBuf>,
    /// What variance files hold [default: `sample` for `*_var.*`, else `mean`]
    #[arg(long, value_name = "KIND")]
    pub variance_of: Option<VarianceOf>,
    /// Samples per pixel of the image, for the z-test [default: what the image says]
    #[arg(long, value_name = "N", value_parser = samples)]
    pub spp: Option<f64>,
    /// Samples per pixel of the reference, for the z-test [default: what the reference says]
    #[arg(long, value_name = "N", value_parser = samples)]
    pub reference_spp: Option<f64>,
    /// Limit of the mean LDR-FLIP
    #[arg(long, value_name = "LIMIT", value_parser = limit, allow_negative_numbers = true)]
    pub max_flip: Option<f64>,
    /// Limit of the mean HDR-FLIP
    #[arg(long, value_name = "LIMIT", conflicts_with = "no_hdr", value_parser = limit, allow_negative_numbers = true)]
    pub max_hdr_flip: Option<f64>,
    /// Limit of the RMSE over all channels
    #[arg(long, value_name = "LIMIT", value_parser = limit, allow_negative_numbers = true)]
    pub max_rmse: Option<f64>,
    /// Limit of relMSE
    #[arg(long, value_name = "LIMIT", value_parser = limit, allow_negative_numbers = true)]
    pub max_relmse: Option<f64>,
    /// Limit of the relative bias of every channel (0.01 is 1 %)
    #[arg(long, value_name = "LIMIT", value_parser = limit, allow_negative_numbers = true)]
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
    /// Write JUnit XML: a suite with a case for each picture
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Print annotations for a GitHub workflow
    #[arg(long)]
    pub github: bool,
    /// Copy images over references: all that a threshold rejects (without thresholds, all that differ) and those
    /// without a reference; or only the pictures of these names (`a,deep/b`)
    #[arg(long, value_name = "NAMES", num_args = 0..=1, require_equals = true)]
    pub update: Option<Option<String>>,
    /// Folder of the pages that show replaced references before and after
    #[arg(long, value_name = "DIR", default_value = "before-after", requires = "update")]
    pub update_pages: PathBuf,
    /// Write the LDR-FLIP map: magma colours (.png), or values (.pfm, .exr); for folders, a folder
    #[arg(long, value_name = "FILE")]
    pub error_map: Option<PathBuf>,
}

/// What a variance image holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum VarianceOf {
    /// Variance of one sample (Mitsuba's integrator moment)
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

fn limit(text: &str) -> Result<f64, String> {
    let limit = text.parse().ok().filter(|n: &f64| *n >= 0.0);
    limit.ok_or_else(|| "expected a number from 0".to_owned())
}

fn samples(text: &str) -> Result<f64, String> {
    let n = text.parse().ok().filter(|n: &f64| n.is_finite() && *n > 0.0);
    n.ok_or_else(|| "expected a number above 0".to_owned())
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
            image_variance: None,
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
            junit: None,
            github: false,
            update: None,
            update_pages: "before-after".into(),
            error_map: None,
        }
    }

    /// Whether two folders are compared.
    pub(super) fn is_folders(&self) -> bool {
        self.image.is_dir() && self.reference.is_dir()
    }

    /// The options of each comparison.
    pub(super) fn options(&self) -> CompareOptions {
        CompareOptions {
            ppd: self.ppd,
            exposure: self.exposure,
            hdr: (!self.no_hdr).then_some(self.tonemapper),
            psnr_peak: self.psnr_peak,
            z_test: ZTestOptions::default(),
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
