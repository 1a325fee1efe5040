//! The result of a writer, and what the writers of all scene languages share.

mod facing;
mod image;
mod light;
mod mesh;
mod names;
mod output;
mod sample;
mod save;
mod sky;
mod slide;
mod source;
mod volume;

use std::collections::{HashMap, HashSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;
use thiserror::Error;

pub(crate) use facing::Facing;
pub(crate) use image::Tone;
pub(crate) use mesh::about;
pub(crate) use names::Names;
pub(crate) use output::Output;
pub(crate) use sample::Sampled;
pub(crate) use slide::Cone;

/// Something in the scene that the written one cannot express.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Loss {
    /// What is lost.
    pub what: String,
    /// `file:line:column` in the scene that was read.
    pub place: Option<String>,
    /// What is written instead.
    pub instead: String,
    /// How much more light there is in the result, in parts of what there was, where that is known. Writers know
    /// it of lights; of materials it has to be measured.
    pub size: Option<f64>,
}

/// A file beside the written scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Asset {
    /// Below the scene's folder.
    pub path: PathBuf,
    /// What it holds.
    pub content: Content,
}

/// Where the bytes of an asset come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The bytes of a file of the scene that was read.
    Copy(PathBuf),
    /// Made for the written scene.
    Bytes(Vec<u8>),
}

/// A scene in its new language, not yet on disk.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Of the scene file.
    pub path: PathBuf,
    /// Of the scene file.
    pub text: String,
    /// Files beside it, in the order of their first use.
    pub assets: Vec<Asset>,
    /// Each once.
    pub losses: Vec<Loss>,
    /// Files the scene was read from, which must survive.
    inputs: HashSet<PathBuf>,
    /// The bytes of copied files that were read to look at them.
    read: HashMap<PathBuf, Arc<Vec<u8>>>,
}

/// Why a scene cannot be written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// No language has the extension.
    #[error("{path}: not a scene language caustica writes; the extension decides; known: {known}{hint}")]
    UnknownLanguage {
        /// As given.
        path: String,
        /// Extensions of the languages.
        known: String,
        /// The extension that was probably meant, or nothing.
        hint: String,
    },
    /// The target is a file of the scene that was read.
    #[error("{} is a file the scene was read from; write somewhere else", .0.display())]
    OverInput(PathBuf),
    /// The target is there, and must not be replaced.
    #[error("{} exists; --force replaces it", .0.display())]
    Exists(PathBuf),
    /// Meshes or pictures may not be read, or are missing.
    #[error("{}", .0.iter().map(|(path, error)| format!("{}: {error}", path.display())).collect::<Vec<_>>().join("\n"))]
    Unreadable(Vec<(PathBuf, io::Error)>),
    /// A file cannot be read or written.
    #[error("{}: {error}", path.display())]
    Io {
        /// Read or written.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A mesh or picture that must be converted is broken.
    #[error("{}: {reason}", path.display())]
    Asset {
        /// Of the mesh or picture.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl Written {
    /// The scene of `output` as `text` in the file `path`.
    pub(crate) fn new(path: &Path, text: String, output: Output<'_>) -> Self {
        let output::Finished { assets, losses, inputs, read } = output.finish();
        Self { path: path.to_path_buf(), text, assets, losses, inputs, read }
    }

    /// Checks that writing to `target` would not replace a file the scene was read from.
    ///
    /// # Errors
    /// When the scene was read from `target`, be it through a link.
    pub fn spare_inputs(&self, target: &Path) -> Result<(), WriteError> {
        let linked = || std::fs::canonicalize(target).is_ok_and(|real| self.inputs.contains(&real));
        if self.inputs.contains(&output::normal(target)) || linked() {
            return Err(WriteError::OverInput(target.to_path_buf()));
        }
        Ok(())
    }
}

/// The shortest decimal that reads back as the same number.
pub(crate) fn number(v: f64) -> String {
    // The sign of a zero is dropped.
    let v = if v == 0.0 { 0.0 } else { v };
    if v != 0.0 && !(1e-5..1e15).contains(&v.abs()) { format!("{v:e}") } else { format!("{v}") }
}
