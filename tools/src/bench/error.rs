use crate::compare::CompareError;
use caustica_formats::image::words;
use std::path::PathBuf;
use thiserror::Error;

/// Why a benchmark failed.
#[derive(Debug, Error)]
pub enum BenchError {
    #[error("{}: {}", path.display(), words(source))]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {source}", path.display())]
    Json { path: PathBuf, source: serde_json::Error },
    #[error(transparent)]
    Image(#[from] CompareError),
    #[error("cannot start `{program}`: {}", words(source))]
    Start { program: String, source: std::io::Error },
    #[error("`{command}` failed: {message}")]
    Render { command: String, message: String },
    #[error(
        "unknown configuration `{0}`: expected caustica[:KEY=VALUE,...], mitsuba:VARIANT:INTEGRATOR or \
         pbrt:INTEGRATOR[,KEY=VALUE...]"
    )]
    Config(String),
    #[error("`{command}` was stopped after {seconds} s")]
    Stopped { command: String, seconds: f64 },
    #[error("interrupted; the same command goes on where this one stopped")]
    Interrupted,
    #[error("no render of this benchmark succeeded; the reasons are above")]
    Nothing,
    #[error("{0}")]
    Usage(String),
    #[error("cannot write output: {}", words(.0))]
    Output(#[from] std::io::Error),
}

impl BenchError {
    /// The exit status of the process: 2 where the command line is wrong, 1 otherwise.
    pub fn status(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Config(_) => 2,
            _ => 1,
        }
    }
}
