//! What a writer collects besides its text: files to carry along, and losses.

use std::collections::{HashMap, HashSet};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use super::names::Names;
use super::source::Sources;
use super::{Asset, Content, Loss, WriteError};
use crate::diagnostic::SourceMap;
use crate::files::Files;
use crate::ir::{Color, ColorSlot, Origin, Scene, SpectrumRule, parts};
use crate::read::Read;
use crate::spectrum::to_linear_rgb;

pub(crate) struct Output<'a> {
    pub scene: &'a Scene,
    sources: &'a SourceMap,
    /// Files of the scene that was read.
    pub(super) files: Sources<'a>,
    /// Of the scene to write.
    folder: PathBuf,
    inputs: HashSet<PathBuf>,
    assets: Vec<Asset>,
    losses: Vec<Loss>,
    /// Where each loss stands among them.
    known: HashMap<[String; 3], usize>,
    /// Source → name in the written scene.
    carried: HashMap<PathBuf, String>,
    /// Assets made from others, by a key of the writer's.
    made: HashMap<String, String>,
    taken: Names,
    /// What is taken before anything is written.
    reserved: Names,
    /// Whether any textured shape has uv outside of 0 to 1, once that was asked.
    pub(super) beyond: Option<bool>,
    /// Folder of the assets, named after the scene's file: scenes beside each other do not share one.
    own: String,
}

impl<'a> Output<'a> {
    pub fn new(read: &'a Read, files: &'a dyn Files, path: &Path) -> Self {
        let folder = normal(path.parent().unwrap_or(Path::new("")));
        let mut inputs: HashSet<PathBuf> = read.sources.paths().map(normal).collect();
        inputs.extend(asset_paths(&read.scene).into_iter().map(normal));
        // No new asset may take the name of a file that is read.
        // File systems may not tell upper from lower case.
        let mut taken = Names::folding_case();
        for path in inputs.iter().filter_map(|path| path.strip_prefix(&folder).ok()) {
            taken.take(&slashed(path));
        }
        // A file has the names of its links, too.
        let linked: Vec<PathBuf> =
            inputs.iter().filter_map(|path| std::fs::canonicalize(path).ok()).collect();
        inputs.extend(linked);
        Self {
            scene: &read.scene,
            sources: &read.sources,
            files: Sources::new(files),
            folder,
            inputs,
            assets: Vec::new(),
            losses: Vec::new(),
            known: HashMap::new(),
            carried: HashMap::new(),
            made: HashMap::new(),
            taken: taken.clone(),
            reserved: taken,
            beyond: None,
            own: format!("{}.files", plain(&path.file_name().unwrap_or_default().to_string_lossy())),
        }
    }

    /// Whether every file of the scene may be read.
    pub fn check_files(&self) -> Result<(), WriteError> {
        self.files.check(self.scene)
    }

    pub(super) fn finish(self) -> Finished {
        let copied = self.assets.iter().filter_map(|asset| match &asset.content {
            Content::Copy(path) => Some((path.clone(), self.files.take(path)?)),
            Content::Bytes(_) => None,
        });
        let read = copied.collect();
        Finished { assets: self.assets, losses: self.losses, inputs: self.inputs, read }
    }

    /// Forgets what was written; files that were read are kept.
    pub fn start_over(&mut self) {
        self.assets.clear();
        self.losses.clear();
        self.known.clear();
        self.carried.clear();
        self.made.clear();
        self.taken = self.reserved.clone();
    }

    /// Records that `what` cannot be expressed, and what is written instead.
    pub fn lose(&mut self, origin: Origin, what: impl Into<String>, instead: impl Into<String>) {
        self.loss(origin, what.into(), instead.into());
    }

    /// Where the loss stands among all: an object that several others refer to may be written more than once.
    fn loss(&mut self, origin: Origin, what: String, instead: String) -> usize {
        let place = origin.0.map(|span| self.sources.location(span));
        let key = [what.clone(), place.clone().unwrap_or_default(), instead.clone()];
        let losses = &mut self.losses;
        *self.known.entry(key).or_insert_with(|| {
            losses.push(Loss { what, place, instead, size: None });
            losses.len() - 1
        })
    }

    /// As `lose`, when the light changes by this part of what there was.
    pub fn lose_light(
        &mut self,
        origin: Origin,
        what: impl Into<String>,
        instead: impl Into<String>,
        size: f64,
    ) {
        let index = self.loss(origin, what.into(), instead.into());
        self.losses[index].size = Some(size);
    }

    /// The rule by which spectra become RGB.
    pub fn spectrum_rule(&self) -> SpectrumRule {
        self.scene.spectra_as.unwrap_or(self.scene.spectrum_rule)
    }

    /// The linear triple that rule gives a colour; out of range ones are clamped and lost.
    pub fn rgb(&mut self, color: &Color, slot: ColorSlot, origin: Origin) -> [f64; 3] {
        match to_linear_rgb(color, slot, self.spectrum_rule()) {
            Ok(rgb) => rgb,
            Err(error) => {
                let raw = match color {
                    Color::Rgb(rgb) | Color::BoundedRgb(rgb) => *rgb,
                    _ => [0.0; 3],
                };
                let clamped = raw.map(|v| if v.is_finite() { v.clamp(0.0, 1.0) } else { 0.0 });
                self.lose(
                    origin,
                    error.to_string(),
                    format!("rgb {}", clamped.map(super::number).join(", ")),
                );
                clamped
            }
        }
    }

    pub(super) fn assets_so_far(&self) -> usize {
        self.assets.len()
    }

    pub fn losses(&self) -> &[Loss] {
        &self.losses
    }

    /// `file:line` for comments, without the folder.
    pub fn place(&self, origin: Origin) -> Option<String> {
        let span = origin.0?;
        let name = self.sources.path(span.file).file_name()?.to_string_lossy().into_owned();
        Some(format!("{name}:{}", self.sources.line_column(span).0))
    }

    /// Names of the files the scene was read from, the main one first.
    pub fn title(&self) -> Option<String> {
        self.sources.paths().next().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned())
    }

    pub fn read(&self, path: &Path) -> Result<Arc<Vec<u8>>, WriteError> {
        self.files.read(path)
    }

    /// Whether the bytes of a file are so, asked once for each file and `name` of the question.
    pub fn is(&self, name: &'static str, path: &Path, so: fn(&[u8]) -> bool) -> Result<bool, WriteError> {
        self.files.is(name, path, so)
    }

    /// The name of an existing file relative to the scene; it is copied to a `subfolder` of its own unless it
    /// lies below the scene's folder already.
    pub fn carry(&mut self, path: &Path, subfolder: &str) -> String {
        let source = normal(path);
        if let Some(name) = self.carried.get(&source) {
            return name.clone();
        }
        let name = match source.strip_prefix(&self.folder) {
            Ok(inside) => slashed(inside),
            Err(_) => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
                let name = self.free_name(subfolder, &stem, &extension);
                let content = Content::Copy(path.to_path_buf());
                self.assets.push(Asset { path: PathBuf::from(&name), content });
                name
            }
        };
        self.carried.insert(source, name.clone());
        name
    }

    /// The name of a new file of these bytes. The same `key` gives the same file.
    pub fn make(
        &mut self,
        key: &str,
        subfolder: &str,
        stem: &str,
        extension: &str,
        bytes: impl FnOnce(&mut Self) -> Result<Vec<u8>, WriteError>,
    ) -> Result<String, WriteError> {
        if let Some(name) = self.made.get(key) {
            return Ok(name.clone());
        }
        let bytes = bytes(self)?;
        let name = self.free_name(subfolder, stem, extension);
        self.assets.push(Asset { path: PathBuf::from(&name), content: Content::Bytes(bytes) });
        self.made.insert(key.to_owned(), name.clone());
        Ok(name)
    }

    fn free_name(&mut self, subfolder: &str, stem: &str, extension: &str) -> String {
        let (own, stem) = (&self.own, plain(stem));
        let base = format!("{own}/{subfolder}/{stem}.{extension}");
        self.taken.free(&base, |n| match n {
            0 => base.clone(),
            n => format!("{own}/{subfolder}/{stem}-{}.{extension}", n + 1),
        })
    }
}

/// What an output leaves when its scene is written.
pub(super) struct Finished {
    pub assets: Vec<Asset>,
    pub losses: Vec<Loss>,
    pub inputs: HashSet<PathBuf>,
    /// The bytes of copied files that were read already.
    pub read: HashMap<PathBuf, Arc<Vec<u8>>>,
}

/// With `_` for what file systems or scene languages may not like.
fn plain(name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ') { c } else { '_' };
    if name.is_empty() { "unnamed".to_owned() } else { name.chars().map(plain).collect() }
}

fn asset_paths(scene: &Scene) -> Vec<&Path> {
    let mut paths = Vec::new();
    parts(scene).for_each(|part| part.files(&mut |path| paths.push(path)));
    paths
}

/// Absolute, without `.` and `..`; symbolic links are not looked at.
pub(super) fn normal(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path)
        .or_else(|_| std::env::current_dir().map(|folder| folder.join(path)))
        .unwrap_or_else(|_| path.to_path_buf());
    let mut out = PathBuf::new();
    for part in whole.components() {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            Component::CurDir => {}
            other => out.push(other),
        }
    }
    out
}

fn slashed(path: &Path) -> String {
    path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}
