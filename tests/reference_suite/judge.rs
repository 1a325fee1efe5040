//! A picture against its reference, by caustica-tools.

use super::manifest::{Limits, Manifest};
use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use caustica_tools::compare::{CompareArgs, Status, load, run};
use caustica_tools::pixels::Pixels;
use serde_json::Value;
use std::error::Error;
use std::path::{Path, PathBuf};

pub struct Judge<'a> {
    pub manifest: &'a Manifest,
    pub limits: &'a Limits,
    pub image: &'a Path,
    /// Folder for figures and for what is left of a masked picture.
    pub scratch: &'a Path,
}

impl Judge<'_> {
    /// Compares. Figures go to the scratch folder in any case, the page to `failures` if a limit is
    /// not kept; a folder of an earlier failure is removed.
    pub fn verdict(&self, integrator: &str, failures: &Path) -> Result<(), Box<dyn Error>> {
        if failures.exists() {
            std::fs::remove_dir_all(failures)?;
        }
        let image = self.masked()?;
        let args = self.arguments(integrator, image.clone());
        let mut out = Vec::new();
        let status = run(&CompareArgs { json: Some(None), ..args.clone() }, &mut out);
        std::fs::write(self.scratch.join(format!("{}-{integrator}.json", self.manifest.name)), &out)?;
        if status == Status::Holds {
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
        std::fs::copy(image, failures.join("image.exr"))?;
        std::fs::copy(&pages.reference, failures.join("reference.exr"))?;
        Err(figures(&serde_json::from_slice(&out)?).into())
    }

    fn arguments(&self, integrator: &str, image: PathBuf) -> CompareArgs {
        let reference = self.manifest.file.with_extension("exr");
        // Only a path tracer is free of bias, which the test presumes.
        let z_test = integrator == "path" && self.limits.z_test;
        CompareArgs {
            max_rmse: Some(self.limits.max_rmse),
            max_flip: Some(self.limits.max_flip),
            max_bias: Some(self.limits.max_bias),
            z_test,
            spp: Some(f64::from(self.limits.spp)),
            reference_spp: Some(self.manifest.reference.spp as f64),
            no_hdr: true,
            ..CompareArgs::new(image, reference)
        }
    }

    /// The picture itself, or a copy that is black where the reference does not count.
    fn masked(&self) -> Result<PathBuf, Box<dyn Error>> {
        if !self.manifest.reference.mask {
            return Ok(self.image.to_path_buf());
        }
        let image = load(self.image, None)?.pixels;
        let mask = load(&self.manifest.file.with_extension("mask.exr"), None)?.pixels;
        if !image.same_size(&mask) {
            return Err("the mask has another size than the picture".into());
        }
        let Pixels { width, height, rgb } = image;
        let data: Vec<f32> = rgb.iter().zip(&mask.rgb).flat_map(|(p, m)| p.map(|v| v * m[0])).collect();
        let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &data };
        let path = self.scratch.join(format!("{}-masked.exr", self.manifest.name));
        write_exr(&path, width, height, &[layer], &[], ExrOptions::default())?;
        Ok(path)
    }
}

/// The limits with what was measured, those that do not hold marked.
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
