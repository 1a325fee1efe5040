//! Arguments of `caustica bench`, from the command line or from a file.

use super::error::BenchError;
use super::files;
use super::record::Budget;
use clap::Args;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Arguments of `caustica bench`.
///
/// Exit status: 0 if the benchmark was made, 2 if the command line is wrong, 1 otherwise.
#[derive(Clone, Debug, Args)]
pub struct BenchArgs {
    /// Scenes, or one JSON file with the fields scenes, references, configs, budgets or passes, seeds,
    /// output
    #[arg(value_name = "SCENE|BENCH.json", required_unless_present = "study")]
    pub scenes: Vec<PathBuf>,
    /// Reference picture of each scene, in the same order; its size is the size of every render. All renders
    /// use a box filter, and the reference must too (`--filter box`)
    #[arg(long = "reference", value_name = "REF.exr")]
    pub references: Vec<PathBuf>,
    /// Configurations: caustica[:KEY=VALUE,...], caustica:path, mitsuba:VARIANT:INTEGRATOR,
    /// pbrt:INTEGRATOR[,KEY=VALUE,...]; the others are compared with the first [default: caustica]
    #[arg(long = "config", value_name = "NAME", num_args = 1..)]
    pub configs: Vec<String>,
    /// CPU seconds of the render, over all threads and without loading; each is a point of the curve
    #[arg(long, value_name = "S,S,...", value_delimiter = ',', conflicts_with = "passes")]
    pub budgets: Vec<f64>,
    /// Passes (samples per pixel), instead of seconds
    #[arg(long, value_name = "N,N,...", value_delimiter = ',')]
    pub passes: Vec<u32>,
    /// Renders of each point, with different seeds [default: 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub seeds: Option<u64>,
    /// Folder for measurements, pictures, tables and the page; an interrupted run continues there
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    pub output: PathBuf,
    /// Stop a process that runs longer than this [default: 60 plus ten times the largest budget; 1800 with
    /// --passes]
    #[arg(long, value_name = "SECONDS")]
    pub limit: Option<f64>,
    /// Compare the CPU times to this RMSE [default: one that all configurations reach]
    #[arg(long, value_name = "E")]
    pub target_error: Option<f64>,
    /// Most path segments, for every renderer; -1 is no limit [default: the scene's]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub max_depth: Option<i64>,
    /// Threads of every render [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Python that can import mitsuba [default: python3, or a virtual environment made when needed]
    #[arg(long, value_name = "PATH")]
    pub python: Option<PathBuf>,
    /// Repeat a study of photon mapping's parameters: photons, neighbours, kernels, roulette, direct,
    /// nee, caustic-map or all
    #[arg(long, value_name = "NAME", conflicts_with_all = ["scenes", "references"])]
    pub study: Option<String>,
    /// Small pictures and few of them, for --study
    #[arg(long, requires = "study")]
    pub quick: bool,
}

/// The arguments in a file. Paths are relative to the file, except `output`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BenchFile {
    scenes: Vec<PathBuf>,
    references: Vec<PathBuf>,
    #[serde(default)]
    configs: Vec<String>,
    #[serde(default)]
    budgets: Vec<f64>,
    #[serde(default)]
    passes: Vec<u32>,
    seeds: Option<u64>,
    output: Option<PathBuf>,
    limit: Option<f64>,
    target_error: Option<f64>,
    max_depth: Option<i64>,
    threads: Option<usize>,
    python: Option<PathBuf>,
}

impl BenchArgs {
    /// Fills in the fields of the file, if one was given, and the defaults.
    ///
    /// # Errors
    /// The file cannot be read, a scene has no reference, or a budget is not positive.
    pub(super) fn resolve(mut self) -> Result<Self, BenchError> {
        if let [file] = self.scenes.as_slice()
            && file.extension().is_some_and(|e| e == "json")
        {
            let file = file.clone();
            self.take(&file)?;
        }
        if self.scenes.len() != self.references.len() {
            let (scenes, references) = (self.scenes.len(), self.references.len());
            return Err(BenchError::Usage(format!(
                "every scene needs a reference; scenes: {scenes}, references: {references}; give --reference REF.exr \
                 for each scene, in their order"
            )));
        }
        if self.configs.is_empty() {
            self.configs.push("caustica".to_owned());
        }
        if self.budgets.is_empty() && self.passes.is_empty() {
            self.budgets = vec![1.0, 2.0, 4.0, 8.0];
        }
        if self.budgets.iter().any(|b| !(b.is_finite() && *b > 0.0)) || self.passes.contains(&0) {
            return Err(BenchError::Usage("budgets and passes must be positive".to_owned()));
        }
        if self.limit.is_some_and(|limit| !(limit > 0.0 && Duration::try_from_secs_f64(limit).is_ok())) {
            return Err(BenchError::Usage("--limit must be a positive number of seconds".to_owned()));
        }
        Ok(self)
    }

    fn take(&mut self, path: &Path) -> Result<(), BenchError> {
        let file: BenchFile = serde_json::from_slice(&files::read(path)?)
            .map_err(|source| BenchError::Json { path: path.to_path_buf(), source })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = |paths: Vec<PathBuf>| paths.iter().map(|p| folder.join(p)).collect::<Vec<_>>();
        self.scenes = beside(file.scenes);
        self.references = beside(file.references);
        // The command line wins over the file.
        if self.configs.is_empty() {
            self.configs = file.configs;
        }
        if self.budgets.is_empty() && self.passes.is_empty() {
            (self.budgets, self.passes) = (file.budgets, file.passes);
        }
        self.seeds = self.seeds.or(file.seeds.filter(|n| *n > 0));
        if let Some(output) = file.output.filter(|_| self.output == Path::new("bench")) {
            self.output = output;
        }
        self.limit = self.limit.or(file.limit);
        self.target_error = self.target_error.or(file.target_error);
        self.max_depth = self.max_depth.or(file.max_depth);
        self.threads = self.threads.or(file.threads);
        self.python = self.python.take().or(file.python);
        Ok(())
    }

    /// After which a process is stopped. Measuring how many samples fit into a budget takes a multiple of it, and
    /// studies take their time.
    pub(super) fn process_limit(&self) -> Option<Duration> {
        let largest = self.budgets.iter().copied().fold(0.0, f64::max);
        let default = if self.budgets.is_empty() { 1800.0 } else { 60.0 + 10.0 * largest };
        let default = self.study.is_none().then_some(default);
        self.limit.or(default).and_then(|limit| Duration::try_from_secs_f64(limit).ok())
    }

    /// The points of a curve.
    pub(super) fn points(&self) -> Vec<Budget> {
        let seconds = self.budgets.iter().map(|s| Budget::CpuSeconds(*s));
        seconds.chain(self.passes.iter().map(|n| Budget::Passes(*n))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        args: BenchArgs,
    }

    fn parse(words: &[&str]) -> BenchArgs {
        Cli::parse_from(std::iter::once("bench").chain(words.iter().copied())).args
    }

    #[test]
    fn every_scene_has_a_reference() {
        let args = parse(&["a.xml", "b.xml", "--reference", "a.exr"]).resolve();
        assert!(args.unwrap_err().to_string().contains("scenes: 2, references: 1"));
        let args = parse(&["a.xml", "--reference", "a.exr", "--passes", "1,4"]).resolve().unwrap();
        assert_eq!(args.points(), [Budget::Passes(1), Budget::Passes(4)]);
        assert_eq!(args.configs, ["caustica"]);
        assert_eq!(args.process_limit(), Some(Duration::from_secs(1800)));
        let args = parse(&["a.xml", "--reference", "a.exr", "--budgets", "2,20"]).resolve().unwrap();
        assert_eq!(args.process_limit(), Some(Duration::from_secs(260)));
        let args = parse(&["a.xml", "--reference", "a.exr", "--limit", "0"]).resolve();
        assert_eq!(args.unwrap_err().status(), 2);
    }

    #[test]
    fn a_file_in_place_of_arguments() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("b.json");
        std::fs::write(
            &path,
            r#"{"scenes": ["a.xml"], "references": ["a.exr"], "budgets": [1, 2], "seeds": 5}"#,
        )
        .unwrap();
        let args = parse(&[path.to_str().unwrap()]).resolve().unwrap();
        assert_eq!(args.scenes, [folder.path().join("a.xml")]);
        assert_eq!((args.budgets.as_slice(), args.seeds), ([1.0, 2.0].as_slice(), Some(5)));
        let args = parse(&[path.to_str().unwrap(), "--seeds", "2", "--passes", "4"]).resolve().unwrap();
        assert_eq!((args.points(), args.seeds), (vec![Budget::Passes(4)], Some(2)), "the command line wins");
        std::fs::write(&path, r#"{"scenes": [], "references": [], "bugdets": []}"#).unwrap();
        assert!(parse(&[path.to_str().unwrap()]).resolve().is_err());
    }
}
