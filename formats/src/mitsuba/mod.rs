//! Mitsuba scenes of all versions, 0.x to 3.x.
//!
//! Reading is passes: [`xml`] text → element tree with spans; [`expand`] `$parameters` and
//! includes; [`upgrade`] old names; [`resolve`] objects with typed entries, ids and references;
//! [`reader`] objects → IR, one file per concept with its table of plugins.

mod aov;
mod bsdf;
mod color;
mod emitter;
mod expand;
mod film;
mod foreign;
mod integrator;
mod medium;
mod number;
mod obj;
mod object;
mod parameters;
mod phase;
mod policy;
mod property;
mod props;
mod reader;
mod resolve;
mod sensor;
mod shape;
mod sunsky;
mod texture;
mod tree;
mod turned;
mod unseen;
mod upgrade;
mod version;
mod volume;
pub(crate) mod write;
mod xml;

use std::path::{Path, PathBuf};

use crate::diagnostic::{Severity, SourceMap, in_source_order};
use crate::files::Files;
use crate::plugin::{Concept, Support, concept};
use crate::read::{Failure, Read, ReadOptions};

/// Reads the scene at `path` with everything it includes. Meshes and textures are only looked for,
/// not opened. Fails with all problems found, never only the first.
pub fn read(files: &dyn Files, path: &Path, options: &ReadOptions) -> Result<Read, Box<Failure>> {
    let mut sources = SourceMap::default();
    let mut problems = Vec::new();
    let policy = policy::Policy { lenient: options.lenient };
    let expanded = expand::Expander::new(files, options, &mut sources, &mut problems).scene(path);
    let scene = expanded.map(|mut tree| {
        upgrade::upgrade(&mut tree.root, &tree.versions);
        let dialect = tree.versions.first().copied().unwrap_or(version::Version(3, 0, 0)).dialect();
        let folders = search_folders(path, &tree.folders, options);
        let resolver = resolve::Resolver::new(files, &sources, &folders, &mut problems, policy);
        let objects = resolver.objects(tree);
        let reader = reader::Reader::new(&objects, dialect, files, &sources, &folders, policy);
        let (scene, found) = reader.scene();
        problems.extend(found);
        scene
    });
    in_source_order(&mut problems);
    let failed = problems.iter().any(|p| p.severity == Severity::Error);
    match scene {
        Some(scene) if !failed => Ok(Read { scene, warnings: problems, sources }),
        _ => Err(Box::new(Failure { diagnostics: problems, sources })),
    }
}

/// `<path>` folders, then the scene's own folder, then those of the options.
fn search_folders(scene: &Path, paths: &[PathBuf], options: &ReadOptions) -> Vec<PathBuf> {
    let own = scene.parent().unwrap_or(Path::new("")).to_path_buf();
    paths.iter().cloned().chain([own]).chain(options.search.iter().cloned()).collect()
}

/// Every plugin that is known, by concept.
pub fn support() -> Vec<Concept> {
    let mut emitters = concept("emitters", emitter::EMITTERS);
    let on_shapes = concept("emitters", emitter::AREA_EMITTERS).plugins;
    emitters.plugins.retain(|&(name, _)| !on_shapes.iter().any(|&(n, s)| n == name && s == Support::Full));
    emitters.plugins.extend(on_shapes.into_iter().filter(|&(_, s)| s == Support::Full));
    vec![
        concept("shapes", shape::SHAPES),
        concept("BSDFs", bsdf::BSDFS),
        emitters,
        concept("textures", texture::TEXTURES),
        concept("media", medium::MEDIA),
        concept("phase functions", phase::PHASES),
        concept("volumes", volume::VOLUMES),
        concept("spectra", color::SPECTRA),
        concept("sensors", sensor::SENSORS),
        concept("films", film::FILMS),
        concept("filters", &film::filters()),
        concept("samplers", sensor::SAMPLERS),
        concept("integrators", integrator::INTEGRATORS),
    ]
}
