//! A scene in another language, or in the newest version of its own.

mod sizes;

use std::path::{Path, PathBuf};

use caustica_formats::confined::Confined;
use caustica_formats::image::atomic_write;
use caustica_formats::{Read, ReadOptions, read_scene, write_scene};

use super::{Error, Finding, Options, check, check_place, shown};

pub use caustica_formats::Loss;

/// A scene that was read to be written in another language.
#[derive(Debug)]
pub struct Conversion {
    read: Read,
    files: Confined,
    /// For people: what the reader says about the scene.
    warnings: String,
}

/// What a conversion has written.
#[derive(Clone, Debug)]
pub struct Converted {
    /// The scene file.
    pub path: PathBuf,
    /// Shapes in it.
    pub shapes: usize,
    /// Files beside it.
    pub files: usize,
    /// What the new language could not express, each once.
    pub losses: Vec<Loss>,
}

impl Conversion {
    /// Reads a scene. Of the options those count that say how it is read: `defines`, `allow_paths`,
    /// `spectrum_rule` and `lenient`.
    ///
    /// # Errors
    /// As [`Session::open`](super::Session::open): what cannot be rendered is not converted either.
    pub fn read(path: &Path, options: &Options) -> Result<Self, Error> {
        let reading = ReadOptions {
            defines: options.defines.clone(),
            lenient: options.lenient,
            search: options.allow_paths.clone(),
        };
        let files = Confined::new(path, &options.allow_paths);
        let mut read = read_scene(&files, path, &reading)?;
        let rendering =
            Options { spectrum_rule: options.spectrum_rule, lenient: options.lenient, ..Options::default() };
        check(&read, &files, path, &rendering)?;
        read.scene.spectra_as = options.spectrum_rule;
        let warnings = shown(&read.sources, &read.warnings);
        Ok(Self { read, files, warnings })
    }

    /// What the reader says about the scene, with excerpts.
    pub fn warnings(&self) -> &str {
        &self.warnings
    }

    /// The same for machines.
    pub fn findings(&self) -> Vec<Finding> {
        self.read.warnings.iter().map(|d| Finding::new(d, &self.read.sources)).collect()
    }

    /// Writes the scene in the language that the extension of `path` names, with its meshes and textures. Files
    /// that exist are replaced only with `force`. A `report` that will be written must be none of the scene's files.
    ///
    /// # Errors
    /// [`Error::Convert`] and [`Error::Unwritable`] when it cannot be written.
    pub fn write(&self, path: &Path, force: bool, report: Option<&Path>) -> Result<Converted, Error> {
        let mut written = write_scene(&self.read, &self.files, path)?;
        report.map_or(Ok(()), |report| written.spare_inputs(report))?;
        check_place(path)?;
        written.save(&self.files, force)?;
        sizes::measure(&self.read, &self.files, &mut written);
        let (shapes, files) = (self.read.scene.shapes.len(), written.assets.len());
        Ok(Converted { path: written.path, shapes, files, losses: written.losses })
    }
}

impl Converted {
    /// Writes the losses as JSON.
    ///
    /// # Errors
    /// [`Error::Unwritable`] with the reason.
    pub fn write_report(&self, path: &Path) -> Result<(), Error> {
        let text = serde_json::to_string_pretty(&self.losses).expect("losses are numbers and strings");
        atomic_write(path, text.as_bytes())
            .map_err(|e| Error::Unwritable { file: path.to_path_buf(), why: e.to_string() })
    }
}
