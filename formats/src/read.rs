//! What a reader of any scene language takes and gives.

use std::cmp::Reverse;
use std::fmt;
use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, SHOWN, Severity, SourceMap};
use crate::files::Files;
use crate::{ir, outside};

/// What a reader needs beside the scene itself.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// `-D name=value`: values of `$name` in the scene; they win over `<default>`. Giving one that
    /// the scene never uses is an error.
    pub defines: Vec<(String, String)>,
    /// What is unknown or not rendered yet becomes the nearest thing that is, with a warning that names it.
    pub lenient: bool,
    /// Searched for meshes, textures and includes after the folders of the scene.
    pub search: Vec<PathBuf>,
}

/// A scene with the warnings about it.
#[derive(Clone, Debug)]
pub struct Read {
    /// What was read.
    pub scene: ir::Scene,
    /// Warnings and notes in source order.
    pub warnings: Vec<Diagnostic>,
    /// The files the spans of `scene` and `warnings` point into.
    pub sources: SourceMap,
}

/// All problems of a scene that could not be read, errors first, in source order.
#[derive(Clone, Debug)]
pub struct Failure {
    /// At least one error.
    pub diagnostics: Vec<Diagnostic>,
    /// The files the spans point into.
    pub sources: SourceMap,
}

impl Failure {
    /// Errors first, each kind in the order given.
    pub fn new(mut diagnostics: Vec<Diagnostic>, sources: SourceMap) -> Self {
        diagnostics.sort_by_key(|d| Reverse(d.severity));
        Self { diagnostics, sources }
    }

    /// With a note that says how to allow what the scene at `scene` may not read, where that is among the
    /// problems.
    #[must_use]
    pub fn advised(mut self, files: &dyn Files, scene: &Path) -> Self {
        if let Some(note) = outside::advice(files, scene) {
            // Among those that are shown.
            let at = self.diagnostics.len().min(SHOWN - 1);
            self.diagnostics.insert(at, note);
        }
        self
    }

    /// Without warnings and notes.
    #[must_use]
    pub fn errors_only(mut self) -> Self {
        self.diagnostics.retain(|d| d.severity == Severity::Error);
        self
    }

    /// Whether nothing is wrong but what was asked for.
    pub fn is_request(&self) -> bool {
        self.diagnostics.iter().all(|d| d.request || d.severity != Severity::Error)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sources.render(&self.diagnostics).trim_end())
    }
}

impl std::error::Error for Failure {}
