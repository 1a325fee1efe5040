//! The reference of a study: a long progressive render by caustica, in two halves with different seeds, so
//! that its noise is known; and a check of the renderer against its own path tracer.

use super::catalogue::{Profile, settings};
use crate::bench::error::BenchError;
use crate::bench::files;
use crate::bench::judge::{Judged, judge, load_sized};
use crate::bench::record::fingerprint;
use crate::bench::renderers::{Job, Programs};
use crate::pixels::Pixels;
use std::path::{Path, PathBuf};

/// The scenes of studies; they need no other files.
const SCENES: [(&str, &str); 3] = [
    ("cornell-owner", include_str!("../../../../scenes/cornell-owner.xml")),
    ("cornell-diffuse", include_str!("../../../../scenes/cornell-diffuse.xml")),
    ("cornell-glass", include_str!("../../../../scenes/cornell-glass.xml")),
];

/// Settings of all references: consistent, because radii shrink, direct light is sampled and depth is not
/// limited.
const PROGRESSIVE: &str = "integrator=photonmap mode=progressive lookup=radius nee=true radius=0.05 caustic_radius=0.025 \
                           photons=20000 caustic_photons=10000 kernel=epanechnikov caustic_kernel=epanechnikov boundary=true \
                           caustic_map=true roulette=renormalise max_depth=-1 \
                           hide_emitters=true";

/// A reference and its error.
#[derive(Debug)]
pub struct Reference {
    pub pixels: Pixels,
    /// RMSE of its noise, from the difference of its halves.
    pub noise: f64,
}

/// Writes a scene to `work`.
///
/// # Errors
/// There is no such scene, or the file cannot be written.
pub fn scene(name: &str, work: &Path) -> Result<PathBuf, BenchError> {
    let (_, text) = SCENES
        .iter()
        .find(|(n, _)| *n == name)
        .ok_or_else(|| BenchError::Usage(format!("there is no scene `{name}` for studies")))?;
    let path = work.join(format!("{name}.xml"));
    files::write(&path, text.as_bytes())?;
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
    let bytes = files::read(scene)?;
    let key = fingerprint([bytes.as_slice(), format!("{values} {passes} {seed} {side}").as_bytes()]);
    let image = work.join(format!("reference-{key}.exr"));
    if !image.is_file() {
        let part = work.join(format!("reference-{key}.part.exr"));
        let job = Job { scene, size: [side, side], passes, seed, image: &part };
        programs.ours(&settings(&[values]), &job)?;
        std::fs::rename(&part, &image).map_err(files::at(&image))?;
    }
    load_sized(&image, scene, [side, side])
}

impl Reference {
    /// Renders the reference, or reads it from `work`; `more` are settings besides those of all references.
    ///
    /// # Errors
    /// The renderer fails, or a file cannot be read or written.
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
        // The standard deviation of a mean of two is half that of their difference.
        Ok(Self { noise: judge(&a, &b).rmse / 2.0, pixels: Pixels { rgb, ..a } })
    }
}

/// The progressive render against the path tracer, on a scene whose light both can find.
#[derive(Clone, Debug)]
pub struct Check {
    pub scene: &'static str,
    pub path_samples: u32,
    /// Difference of the means, relative to the path tracer's.
    pub bias: f64,
    pub rmse: f64,
}

/// Compares them on the scene `name`, with as many path samples as the profile's reference has passes.
///
/// # Errors
/// The renderer fails, or a file cannot be read or written.
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
