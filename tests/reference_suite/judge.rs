//! Compares a picture with its reference, using caustica-tools.

use super::blocks::{self, Block, Truth};
use super::manifest::{Limits, Manifest};
use caustica_tools::compare::{CompareArgs, Mask, Status, load, run};
use serde_json::Value;
use std::error::Error;
use std::path::Path;

pub struct Judge<'a> {
    pub manifest: &'a Manifest,
    pub limits: &'a Limits,
    pub image: &'a Path,
    /// Folder for the measured figures.
    pub scratch: &'a Path,
}

impl Judge<'_> {
    /// Compares, and writes the figures to the scratch folder. If a limit is exceeded, writes the comparison page
    /// to `failures`; what an earlier failure left there is removed.
    pub fn verdict(&self, integrator: &str, failures: &Path) -> Result<(), Box<dyn Error>> {
        if failures.exists() {
            std::fs::remove_dir_all(failures)?;
        }
        let args = self.arguments(integrator);
        let mut out = Vec::new();
        let status = run(&CompareArgs { json: Some(None), ..args.clone() }, &mut out);
        std::fs::write(self.scratch.join(format!("{}-{integrator}.json", self.manifest.name)), &out)?;
        let block = self.block(integrator)?;
        if status == Status::Holds && block.share <= 1.0 {
            return Ok(());
        }
        std::fs::create_dir_all(failures)?;
        let pages = CompareArgs {
            html: Some(failures.join("index.html")),
            error_map: Some(failures.join("flip.png")),
            no_hdr: false,
            ..args
        };
        run(&pages, &mut std::io::sink());
        std::fs::copy(self.image, failures.join("image.exr"))?;
        std::fs::copy(&pages.reference, failures.join("reference.exr"))?;
        Err(format!("{}\n{}", figures(&serde_json::from_slice(&out)?), described(&block)).into())
    }

    /// The block whose mean is furthest off.
    fn block(&self, integrator: &str) -> Result<Block, Box<dyn Error>> {
        let beside = |extension: &str| load(&self.manifest.file.with_extension(extension), None);
        let (reference, variance) = (beside("exr")?.pixels, beside("var.exr")?.pixels);
        let density = if integrator == "path" { None } else { Some(beside("density.exr")?.pixels) };
        let mut image = load(self.image, None)?.pixels;
        if !image.same_size(&reference) || !variance.same_size(&reference) {
            return Err("picture, reference and variance have different sizes".into());
        }
        if density.as_ref().is_some_and(|d| [d.width, d.height] != [blocks::BLOCKS; 2]) {
            return Err("the density tolerance has the wrong number of blocks".into());
        }
        if let Some(mask) = Mask::beside(&self.manifest.file.with_extension("exr"), &reference)? {
            mask.apply(&mut image);
        }
        let spp = self.manifest.reference.spp as f64;
        let truth = Truth { reference: &reference, variance: &variance, density: density.as_ref(), spp };
        blocks::worst(&image, &truth, self.limits).ok_or_else(|| "the picture has no pixels".into())
    }

    fn arguments(&self, integrator: &str) -> CompareArgs {
        let reference = self.manifest.file.with_extension("exr");
        // The z-test assumes that there is no bias, which is true of a path tracer only.
        let z_test = integrator == "path" && self.limits.z_test;
        CompareArgs {
            max_rmse: Some(self.limits.max_rmse),
            max_flip: Some(self.limits.max_flip),
            max_bias: Some(self.limits.max_bias),
            z_test,
            spp: Some(f64::from(self.limits.spp)),
            reference_spp: Some(self.manifest.reference.spp as f64),
            no_hdr: true,
            ..CompareArgs::new(self.image, reference)
        }
    }
}

/// The line that reports a block.
fn described(b: &Block) -> String {
    format!(
        "{}  block  columns {}..={}, rows {}..={}, channel {}: {:+.2} % (tolerance {:.2} %)",
        if b.share <= 1.0 { "holds" } else { "FAILS" },
        b.columns[0],
        b.columns[1],
        b.rows[0],
        b.rows[1],
        b.channel,
        100.0 * b.difference,
        100.0 * b.tolerance
    )
}

/// One line per limit: whether it holds, what was measured, and the limit.
fn figures(report: &Value) -> String {
    let mut lines = Vec::new();
    for failure in report["failures"].as_array().into_iter().flatten() {
        lines.push(format!("could not compare: {}", failure["error"].as_str().unwrap_or_default()));
    }
    for comparison in report["comparisons"].as_array().into_iter().flatten() {
        for check in comparison["checks"].as_array().into_iter().flatten() {
            let name = check["name"].as_str().unwrap_or_default();
            let number = |key: &str| check[key].as_f64().unwrap_or(f64::NAN);
            let mark = if check["holds"] == true { "holds" } else { "FAILS" };
            lines.push(format!("{mark}  {name:<6} {:.5} (limit {})", number("value"), number("limit")));
        }
        let z = &comparison["z_test"];
        lines.push(format!(
            "relative bias {}, within 4.5 sigma {}, mean z² {}",
            comparison["bias"]["relative"], z["within_4_5_sigma"], z["mean_z2"]
        ));
    }
    lines.join("\n")
}
