//! What a reader of any scene language takes and gives.

use std::fmt;
use std::path::PathBuf;

use crate::diagnostic::{Diagnostic, SourceMap};
use crate::ir;

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

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sources.render(&self.diagnostics).trim_end())
    }
}

impl std::error::Error for Failure {}
