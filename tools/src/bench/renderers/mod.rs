//! Starting the renderers: caustica as a process, Mitsuba through Python, pbrt by its name.

mod mitsuba;
mod ours;
mod pbrt;
mod python;

use super::args::BenchArgs;
use super::config::{Config, Renderer};
use super::error::BenchError;
use super::process::{Cost, Watch};
use super::{files, process};
use python::Python;
use serde_json::Value;
use std::cell::RefCell;
use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// One render to make.
#[derive(Debug)]
pub struct Job<'a> {
    pub scene: &'a Path,
    /// Width and height of the picture in pixels.
    pub size: [usize; 2],
    /// Passes, or samples per pixel.
    pub passes: u32,
    pub seed: u64,
    /// File that is written.
    pub image: &'a Path,
}

/// The cost of a render, without loading. Where the system does not report the CPU time of other processes, that is
/// the wall time.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    pub seconds: f64,
    pub cpu_seconds: f64,
    pub peak_memory_bytes: Option<u64>,
    pub passes: u64,
    /// In what it was rendered otherwise than asked.
    pub note: Option<String>,
}

/// The programs a run may start, and what all renders share.
#[derive(Clone, Debug)]
pub struct Programs {
    caustica: PathBuf,
    python: Python,
    threads: Option<usize>,
    max_depth: Option<i64>,
    /// Of every render.
    watch: Watch,
    /// What pbrt takes to load each of its scenes, by the fingerprint of the scene's text.
    loads: RefCell<HashMap<String, Cost>>,
}

impl Programs {
    pub fn new(args: &BenchArgs, caustica: &Path, stop: &Arc<AtomicBool>) -> Self {
        Self {
            caustica: caustica.to_path_buf(),
            python: Python::new(args.python.as_deref()),
            threads: args.threads,
            max_depth: args.max_depth,
            watch: Watch { limit: args.process_limit(), stop: stop.clone() },
            loads: RefCell::default(),
        }
    }

    /// Why a configuration cannot be measured here; `None` if it can. May install Mitsuba.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn missing(&mut self, config: &Config, out: &mut dyn Write) -> Result<Option<String>, BenchError> {
        match &config.renderer {
            Renderer::Ours { .. } => Ok(None),
            Renderer::Mitsuba { variant, .. } => self.python.missing(variant, out),
            Renderer::Pbrt { .. } => {
                let path = std::env::var_os("PATH").unwrap_or_default();
                let found = std::env::split_paths(&path).any(|p| p.join("pbrt").is_file());
                let how = "there is no `pbrt` on PATH: build https://github.com/mmp/pbrt-v4 and add its folder to PATH";
                Ok((!found).then(|| how.to_owned()))
            }
        }
    }

    /// Renders a job to its image with a configuration.
    ///
    /// # Errors
    /// The renderer cannot be started or fails, or its files cannot be read or written.
    pub fn render(&self, config: &Config, job: &Job<'_>) -> Result<Made, BenchError> {
        match &config.renderer {
            Renderer::Ours { settings } => self.ours(settings, job),
            Renderer::Mitsuba { variant, integrator } => mitsuba::render(self, variant, integrator, job),
            Renderer::Pbrt { integrator, parameters } => pbrt::render(self, integrator, parameters, job),
        }
    }

    /// Renders a job with caustica and the given settings.
    ///
    /// # Errors
    /// As [`Self::render`].
    pub fn ours(&self, settings: &[(String, String)], job: &Job<'_>) -> Result<Made, BenchError> {
        ours::render(self, settings, job)
    }

    /// The job's scene as a file with the given extension (`xml`, `pbrt`), which `caustica convert` writes.
    ///
    /// # Errors
    /// The scene cannot be converted.
    fn converted(&self, job: &Job<'_>, extension: &str) -> Result<PathBuf, BenchError> {
        let stem = job.scene.file_stem().unwrap_or(job.scene.as_os_str());
        let folder = job.image.with_file_name("converted").join(stem);
        files::make_folder(&folder)?;
        let path = folder.join(stem).with_extension(extension);
        let mut command = Command::new(&self.caustica);
        command.arg("convert").arg("--force").arg(job.scene).arg(&path);
        process::run(&mut command, &self.watch)?;
        Ok(path)
    }
}

/// Reads and removes a file of statistics.
fn take_json(path: &Path) -> Result<Value, BenchError> {
    let bytes = files::read(path)?;
    std::fs::remove_file(path).map_err(files::at(path))?;
    serde_json::from_slice(&bytes).map_err(|source| BenchError::Json { path: path.to_path_buf(), source })
}
