//! pbrt-v4 scenes.
//!
//! Reading is passes: [`token`] text → tokens with spans; [`parse`] directives with typed parameters;
//! [`upgrade`] pbrt-v3 names; [`load`] includes; [`reader`] graphics state → IR, one file per concept
//! with its table of types.

mod color;
mod depths;
mod directive;
mod disney;
mod dispatch;
mod film;
mod finish;
mod integrator;
mod light;
mod load;
mod material;
mod medium;
mod mix;
mod number;
mod older;
mod option;
mod params;
mod parse;
mod policy;
mod reader;
mod scope;
mod sensor;
mod shape;
mod space;
mod state;
mod texture;
mod token;
mod transform;
mod upgrade;
mod values;
mod version3;
pub(crate) mod write;

use std::path::Path;

use crate::diagnostic::{Diagnostic, Severity, SourceMap, Span, in_source_order};
use crate::files::Files;
use crate::plugin::{Concept, concept};
use crate::read::{Failure, Read, ReadOptions};

/// Reads the scene at `path` with everything it includes. Meshes and textures are only looked for,
/// not opened. Fails with all problems found, never only the first.
pub fn read(files: &dyn Files, path: &Path, options: &ReadOptions) -> Result<Read, Box<Failure>> {
    let mut sources = SourceMap::default();
    let mut problems = Vec::new();
    let mut old = upgrade::Old::default();
    let own = path.parent().unwrap_or(Path::new("")).to_path_buf();
    let folders: Vec<_> = std::iter::once(own).chain(options.search.iter().cloned()).collect();
    let mut directives = Vec::new();
    let mut loader = load::Loader::new(files, &folders, &mut sources, &mut problems, &mut old);
    loader.load(path, None, &mut directives);
    let incomplete = loader.incomplete;
    let policy = policy::Policy { version: old.version(), lenient: options.lenient };
    for (name, _) in &options.defines {
        let text = format!("`{name}` is defined, but pbrt scenes have no parameters");
        problems.push(Diagnostic::error(text, None).request());
    }
    let readable = !directives.is_empty() || problems.is_empty();
    if readable {
        let start = Span { file: 0, start: 0, end: 0 };
        let mut reader = reader::Reader::new(files, &folders, policy, start);
        reader.incomplete = incomplete;
        let (scene, found) = reader.scene(directives);
        problems.extend(old.finish(policy));
        problems.extend(found);
        in_source_order(&mut problems);
        if problems.iter().all(|p| p.severity != Severity::Error) {
            return Ok(Read { scene, warnings: problems, sources });
        }
    }
    in_source_order(&mut problems);
    Err(Box::new(Failure { diagnostics: problems, sources }))
}

/// Every type that is known, by concept.
pub fn support() -> Vec<Concept> {
    let mut lights = concept("lights", light::LIGHTS);
    let area = concept("lights", light::AREA_LIGHTS).plugins;
    lights.plugins.extend(area.into_iter().map(|(_, support)| ("diffuse (area)", support)));
    vec![
        concept("shapes", shape::SHAPES),
        concept("materials", material::MATERIALS),
        lights,
        concept("media", medium::MEDIA),
        concept("textures", texture::TEXTURES),
        concept("cameras", sensor::CAMERAS),
        concept("films", film::FILMS),
        concept("filters", film::FILTERS),
        concept("samplers", sensor::SAMPLERS),
        concept("integrators", integrator::INTEGRATORS),
    ]
}
