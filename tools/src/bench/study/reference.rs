//! The truth of a study: a long progressive render of ours, in two halves of different random numbers so
//! that its own noise is known, and a check of the renderer against its path tracer.

use super::super::BenchError;
use super::super::record::{Budget, fingerprint};
use super::super::renderers::{Job, Programs};
use super::super::run::{Judged, judge, load_sized};
use super::catalogue::{Profile, settings};
use crate::pixels::Pixels;
use std::path::{Path, PathBuf};

/// Scenes a study may ask for; they hold no other files.
const SCENES: [(&str, &str); 3] = [
    ("cornell-owner", include_str!("../../../../scenes/cornell-owner.xml")),
    ("cornell-diffuse", include_str!("../../../../scenes/cornell-diffuse.xml")),
    ("cornell-glass", include_str!("../../../../scenes/cornell-glass.xml")),
];

/// Consistent: radii shrink, direct light is sampled, the room's depth is not limited.
const PROGRESSIVE: &str = "integrator=photonmap mode=progressive lookup=radius nee=true radius=0.05 caustic_radius=0.025 \
                           photons=20000 caustic_photons=10000 kernel=epanechnikov caustic_kernel=epanechnikov boundary=true \
                           caustic_map=true roulette=renormalise max_depth=-1 \
                           hide_emitters=true";

/// A truth and what is known of its error.
#[derive(Debug)]
pub struct Reference {
    pub pixels: Pixels,
    /// RMSE that its noise leaves, from the difference of its halves.
    pub noise: f64,
}

/// Writes a scene of ours to `work`.
pub fn scene(name: &str, work: &Path) -> Result<PathBuf, BenchError> {
    let (_, text) = SCENES
        .iter()
        .find(|(n, _)| *n == name)
        .ok_or_else(|| BenchError::Usage(format!("there is no scene `{name}` for studies")))?;
    let path = work.join(format!("{name}.xml"));
    std::fs::write(&path, text).map_err(|source| BenchError::Io { path: path.clone(), source })?;
    Ok(path)
}

fn picture(
    programs: &Programs,
    scene: &Path,
    work: &Path,
    values: &str,
    passes: u32,
    seed: u64,
    side: usize,
) -> Result<Pixels, BenchError> {
    let bytes =
        std::fs::read(scene).map_err(|source| BenchError::Io { path: scene.to_path_buf(), source })?;
    let key = fingerprint([bytes.as_slice(), format!("{values} {passes} {seed} {side}").as_bytes()]);
    let image = work.join(format!("reference-{key}.exr"));
    if !image.is_file() {
        let part = work.join(format!("reference-{key}.part.exr"));
        let job = Job { scene, size: [side, side], budget: Budget::Passes(passes), seed, image: &part };
        programs.ours(&settings(&[values]), &job)?;
        std::fs::rename(&part, &image).map_err(|source| BenchError::Io { path: image.clone(), source })?;
    }
    load_sized(&image, scene, [side, side])
}

impl Reference {
    /// Rendered, or read from `work`; `more` are settings besides those of all truths.
    pub fn new(
        programs: &Programs,
        scene: &Path,
        work: &Path,
        p: Profile,
        more: &str,
    ) -> Result<Self, BenchError> {
        let values = [PROGRESSIVE, more].join(" ");
        let half = |seed| picture(programs, scene, work, values.trim(), p.reference_passes / 2, seed, p.side);
        let (a, b) = (half(9001)?, half(9002)?);
        let rgb =
            a.rgb.iter().zip(&b.rgb).map(|(a, b)| std::array::from_fn(|c| (a[c] + b[c]) / 2.0)).collect();
        // The mean of two has half the deviation of their difference.
        Ok(Self { noise: judge(&a, &b).rmse / 2.0, pixels: Pixels { rgb, ..a } })
    }
}

/// The progressive render against the path tracer on a scene that both can see.
#[derive(Clone, Debug)]
pub struct Check {
    pub scene: &'static str,
    pub path_samples: u32,
    /// Difference of the means, relative to the path tracer's.
    pub bias: f64,
    pub rmse: f64,
}

/// Compares on `name`, with as many path samples as the profile's reference has passes.
pub fn check(name: &'static str, programs: &Programs, work: &Path, p: Profile) -> Result<Check, BenchError> {
    let file = scene(name, work)?;
    let ours = Reference::new(programs, &file, work, p, "")?;
    let path = picture(
        programs,
        &file,
        work,
        "integrator=path max_depth=-1 hide_emitters=true",
        p.reference_passes,
        1,
        p.side,
    )?;
    let Judged { bias, rmse, .. } = judge(&ours.pixels, &path);
    Ok(Check { scene: name, path_samples: p.reference_passes, bias, rmse })
}
