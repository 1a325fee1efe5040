//! Reading a scene of any language: options, results, and the choice of the reader by extension.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, SourceMap};
use crate::files::Files;
use crate::{ir, mitsuba, pbrt};

/// What a reader needs beside the scene itself.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// `-D name=value`: values of `$name` in the scene; they win over `<default>`. Giving one that
    /// the scene never uses is an error.
    pub defines: Vec<(String, String)>,
    /// Known plugins that are not rendered yet become a named substitute and a warning.
    pub allow_unsupported: bool,
    /// pbrt-v3 scenes are read as what their constructs became in v4, instead of refused.
    pub upgrade_v3: bool,
    /// Searched for meshes, textures and includes after the folders of the scene.
    pub search: Vec<PathBuf>,
}

/// A scene and what its author should know about it.
#[derive(Clone, Debug)]
pub struct Read {
    pub scene: ir::Scene,
    /// Warnings and notes in source order.
    pub warnings: Vec<Diagnostic>,
    /// The files the spans of `scene` and `warnings` point into.
    pub sources: SourceMap,
}

/// All problems of a scene that could not be read, errors first, in source order.
#[derive(Clone, Debug)]
pub struct Failure {
    pub diagnostics: Vec<Diagnostic>,
    pub sources: SourceMap,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sources.render(&self.diagnostics).trim_end())
    }
}

impl std::error::Error for Failure {}

type Reader = fn(&dyn Files, &Path, &ReadOptions) -> Result<Read, Box<Failure>>;

/// One row per scene language.
const LANGUAGES: &[(&str, Reader)] = &[("xml", mitsuba::read), ("pbrt", pbrt::read), ("pbrt.gz", pbrt::read)];

/// Reads a scene in the language its extension names.
pub fn read_scene(files: &dyn Files, path: &Path, options: &ReadOptions) -> Result<Read, Box<Failure>> {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default().to_ascii_lowercase();
    if let Some((_, read)) = LANGUAGES.iter().find(|(known, _)| name.ends_with(&format!(".{known}"))) {
        return read(files, path, options);
    }
    let known = LANGUAGES.iter().map(|(name, _)| format!(".{name}")).collect::<Vec<_>>().join(", ");
    let problem = Diagnostic::error(format!("{}: not a scene language caustica reads", path.display()), None)
        .help(format!("the extension decides; known: {known}"));
    Err(Box::new(Failure { diagnostics: vec![problem], sources: SourceMap::default() }))
}
