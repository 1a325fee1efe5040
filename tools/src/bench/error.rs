use crate::compare::CompareError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a benchmark failed.
#[derive(Debug, Error)]
pub enum BenchError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: {source}", path.display())]
    Json { path: PathBuf, source: serde_json::Error },
    #[error(transparent)]
    Image(#[from] CompareError),
    #[error("cannot start `{program}`: {source}")]
    Start { program: String, source: std::io::Error },
    #[error("`{command}` failed: {message}")]
    Render { command: String, message: String },
    #[error(
        "unknown configuration `{0}`: expected caustica[:KEY=VALUE,...], mitsuba:VARIANT:INTEGRATOR or \
         pbrt:INTEGRATOR[,KEY=VALUE...]"
    )]
    Config(String),
    #[error("no render of this benchmark succeeded; the reasons are above")]
    Nothing,
    #[error("{0}")]
    Usage(String),
    #[error("cannot write output: {0}")]
    Output(#[from] std::io::Error),
}
