//! Why a subcommand did not do its work, and the exit status that says so.

use crate::session::Error;

/// A message for people, by whose hand it is to mend.
#[derive(Debug)]
pub enum Failure {
    /// The command line is wrong: status 2, as for an option that does not exist.
    Usage(String),
    /// Scene, file, memory or disk: status 1.
    Work(String),
}

impl Failure {
    pub fn message(&self) -> &str {
        match self {
            Self::Usage(message) | Self::Work(message) => message,
        }
    }

    pub fn status(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Work(_) => super::FAILED,
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let message = error.to_string();
        if error.is_request() { Self::Usage(message) } else { Self::Work(message) }
    }
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Work(message)
    }
}
