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
    pub name: String,
    pub image: String,
    pub reference: String,
    pub error: String,
    /// A file is not there.
    pub missing: bool,
    /// Wall time until it was found out.
    #[serde(skip)]
    pub seconds: f64,
}

impl Failure {
    pub fn new(name: &str, image: &Path, reference: &Path, error: &CompareError) -> Self {
        Self {
            name: name.to_owned(),
            image: image.display().to_string(),
            reference: reference.display().to_string(),
            error: error.to_string(),
            missing: error.is_missing(),
            seconds: 0.0,
        }
    }
}

/// An image without a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Extra {
    pub name: String,
    pub image: String,
}

/// What `--update` did with a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Action {
    /// The image was copied over the reference.
    Replaced,
    /// The image was copied to where no reference was.
    Added,
    /// The reference is as it was.
    Kept,
}

/// The reference of one picture and what `--update` did with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Update {
    pub name: String,
    pub action: Action,
    pub image: String,
    pub reference: String,
    /// The page that shows the picture before and after.
    pub page: Option<String>,
    /// Why the reference was kept.
    pub reason: Option<String>,
}

/// Everything a run found: the JSON of `--json`, and the data of the HTML page.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// [`Status::code`].
    pub status: u8,
    pub comparisons: Vec<Comparison>,
    pub failures: Vec<Failure>,
    /// Images without a reference.
    #[serde(serialize_with = "images")]
    pub unmatched: Vec<Extra>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub updates: Vec<Update>,
    /// What the page calls image and reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub labels: Option<[&'static str; 2]>,
}

fn images<S: serde::Serializer>(extra: &[Extra], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(extra.iter().map(|e| &e.image))
}

impl Report {
    /// Whether a comparison holds, or its image was accepted as the new reference.
    pub fn passes(&self, comparison: &Comparison) -> bool {
        let accepted = |u: &Update| u.action == Action::Replaced && u.name == comparison.name;
        comparison.holds || self.updates.iter().any(accepted)
    }

    /// The result of the run.
    pub fn verdict(&self) -> Status {
        if !self.failures.is_empty() {
            Status::CouldNotCompare
        } else if self.comparisons.iter().all(|c| self.passes(c)) {
            Status::Holds
        } else {
            Status::FallsShort
        }
    }
}
