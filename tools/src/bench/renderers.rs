//! Starting the renderers: ours as a process of its own, Mitsuba through Python, pbrt by its name.

use super::config::{Config, Renderer};
use super::process::{self, Cost};
use super::python::{self, Python};
use super::record::Budget;
use super::{BenchArgs, BenchError, pbrt};
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One render to make.
#[derive(Debug)]
pub struct Job<'a> {
    pub scene: &'a Path,
    pub size: [usize; 2],
    pub budget: Budget,
    pub seed: u64,
    pub image: &'a Path,
}

/// What a render cost, without loading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Made {
    pub seconds: f64,
    pub cpu_seconds: f64,
    pub peak_memory_bytes: Option<u64>,
    pub passes: u64,
}

/// The programs a run may start.
#[derive(Clone, Debug)]
pub struct Programs {
    pub caustica: PathBuf,
    python: Python,
    pub threads: Option<usize>,
    pub max_depth: Option<i64>,
}

impl Programs {
    pub fn new(args: &BenchArgs, caustica: &Path) -> Self {
        Self {
            caustica: caustica.to_path_buf(),
            python: Python::new(args.python.as_deref()),
            threads: args.threads,
            max_depth: args.max_depth,
        }
    }

    /// Why a configuration cannot be measured here, if it cannot.
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

    /// The job's scene in the language of a renderer (`xml`, `pbrt`), converted by our program unless it is.
    pub fn converted(&self, job: &Job<'_>, extension: &str) -> Result<PathBuf, BenchError> {
        let stem = job.scene.file_stem().unwrap_or(job.scene.as_os_str());
        let folder = job.image.with_file_name("converted").join(stem);
        let io = |source| BenchError::Io { path: folder.clone(), source };
        std::fs::create_dir_all(&folder).map_err(io)?;
        let path = folder.join(stem).with_extension(extension);
        process::run(Command::new(&self.caustica).arg("convert").arg("--force").arg(job.scene).arg(&path))?;
        Ok(path)
    }

    /// Renders, to `job.image`.
    pub fn render(&self, config: &Config, job: &Job<'_>) -> Result<Made, BenchError> {
        match &config.renderer {
            Renderer::Ours { settings } => self.ours(settings, job),
            Renderer::Mitsuba { variant, integrator } => self.mitsuba(variant, integrator, job),
            Renderer::Pbrt { integrator, parameters } => pbrt::render(self, integrator, parameters, job),
        }
    }

    /// Our renderer with settings, as `caustica render` does it.
    pub fn ours(&self, settings: &[(String, String)], job: &Job<'_>) -> Result<Made, BenchError> {
        let stats = job.image.with_extension("stats.json");
        let mut command = Command::new(&self.caustica);
        command.arg("render").arg(job.scene).arg("-o").arg(job.image).arg("--stats").arg(&stats);
        command.args(["--quiet", "--layers", "none", "--filter", "box"]);
        command.args(["--size", &format!("{}x{}", job.size[0], job.size[1])]);
        command.args(["--seed", &job.seed.to_string()]);
        match job.budget {
            Budget::Seconds(s) => command.args(["--time", &s.to_string()]),
            Budget::Passes(n) => command.args(["--passes", &n.to_string()]),
        };
        if let Some(n) = self.threads {
            command.args(["--threads", &n.to_string()]);
        }
        if let Some(n) = self.max_depth {
            command.args(["--max-depth", &n.to_string()]);
        }
        for (key, value) in settings {
            command.args(["--set", &format!("{key}={value}")]);
        }
        let cost = process::run(&mut command)?;
        let value = read_json(&stats)?;
        let render = &value["render"];
        Ok(Made {
            seconds: render["seconds"].as_f64().unwrap_or(cost.seconds),
            cpu_seconds: cpu(cost, value["load_seconds"].as_f64()),
            peak_memory_bytes: value["peak_memory_bytes"].as_u64(),
            passes: render["passes"].as_u64().unwrap_or(0),
        })
    }

    fn mitsuba(&self, variant: &str, integrator: &str, job: &Job<'_>) -> Result<Made, BenchError> {
        let stats = job.image.with_extension("stats.json");
        let [seconds, spp] = match job.budget {
            Budget::Seconds(s) => [Value::from(s), Value::Null],
            Budget::Passes(n) => [Value::Null, Value::from(n)],
        };
        let is_xml = job.scene.extension().is_some_and(|e| e.eq_ignore_ascii_case("xml"));
        let scene = if is_xml { job.scene.to_path_buf() } else { self.converted(job, "xml")? };
        let order = serde_json::json!({
            "scene": scene, "variant": variant, "integrator": integrator, "size": job.size, "seed": job.seed,
            "seconds": seconds, "spp": spp, "max_depth": self.max_depth, "image": job.image, "stats": stats,
        });
        let mut command = Command::new(&self.python.program);
        command.arg("-c").arg(python::SCRIPT).arg(order.to_string());
        if let Some(n) = self.threads {
            command.env("MI_DEFAULT_THREADS", n.to_string());
        }
        process::run(&mut command).map_err(|e| match e {
            BenchError::Render { message, .. } => {
                BenchError::Render { command: format!("mitsuba {variant} {integrator}"), message }
            }
            other => other,
        })?;
        let value = read_json(&stats)?;
        Ok(Made {
            seconds: value["seconds"].as_f64().unwrap_or(0.0),
            cpu_seconds: value["cpu_seconds"].as_f64().unwrap_or(0.0),
            peak_memory_bytes: value["peak_memory_bytes"].as_u64(),
            passes: value["passes"].as_u64().unwrap_or(0),
        })
    }
}

/// CPU seconds of the process without its loading, which uses one thread.
fn cpu(cost: Cost, load_seconds: Option<f64>) -> f64 {
    (cost.cpu_seconds.unwrap_or(0.0) - load_seconds.unwrap_or(0.0)).max(0.0)
}

/// Reads and removes a file of statistics.
fn read_json(path: &Path) -> Result<Value, BenchError> {
    let io = |source| BenchError::Io { path: path.to_path_buf(), source };
    let bytes = std::fs::read(path).map_err(io)?;
    std::fs::remove_file(path).map_err(io)?;
    serde_json::from_slice(&bytes).map_err(|source| BenchError::Json { path: path.to_path_buf(), source })
}
