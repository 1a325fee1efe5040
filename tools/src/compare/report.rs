//! What a run found, as data.

use super::comparison::Comparison;
use super::error::CompareError;
use serde::Serialize;
use std::path::Path;

/// The result of a run, which is the exit status of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Every comparison was made and every threshold holds.
    Holds = 0,
    /// A threshold does not hold.
    FallsShort = 1,
    /// Something could not be compared or written.
    CouldNotCompare = 2,
}

impl Status {
    /// The exit status of the process: 0, 1 or 2.
    pub fn code(self) -> u8 {
        self as u8
    }
}

impl From<Status> for std::process::ExitCode {
    fn from(status: Status) -> Self {
        status.code().into()
    }
}

/// A pair that could not be compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    pub image: String,
    pub reference: String,
    pub error: String,
}

impl Failure {
    pub fn new(image: &Path, reference: &Path, error: &CompareError) -> Self {
        Self {
            image: image.display().to_string(),
            reference: reference.display().to_string(),
            error: error.to_string(),
        }
    }
}

/// Everything a run found: the JSON of `--json`, and the data of the HTML page.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// [`Status::code`].
    pub status: u8,
    pub comparisons: Vec<Comparison>,
    pub failures: Vec<Failure>,
    /// Images without a reference.
    pub unmatched: Vec<String>,
}
