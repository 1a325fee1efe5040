//! Messages about a scene, for machines.

use caustica_formats::diagnostic::{Diagnostic, Severity, SourceMap, Span};
use serde::Serialize;

/// A message about a scene with its places. Serialises to an element of `diagnostics` of `inspect --json`.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// `error`, `warning` or `note`.
    pub severity: &'static str,
    /// What it is about.
    pub message: String,
    /// Where; null for what stands in no file.
    #[serde(flatten)]
    pub place: Place,
    /// What to do about it.
    pub help: Vec<String>,
    /// Further places, each with its own words.
    pub labels: Vec<Label>,
    /// Something known is left out of the picture or replaced.
    pub unsupported: bool,
    /// The line of the file that `place` names.
    #[serde(skip)]
    pub source: Option<String>,
}

/// A further place of a message.
#[derive(Clone, Debug, Serialize)]
pub struct Label {
    /// What is there.
    pub message: String,
    /// Where.
    #[serde(flatten)]
    pub place: Place,
}

/// A place in a file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Place {
    /// As it was opened.
    pub file: Option<String>,
    /// From 1.
    pub line: Option<usize>,
    /// From 1, in characters.
    pub column: Option<usize>,
}

impl Place {
    fn of(span: Option<Span>, sources: &SourceMap) -> Self {
        let Some(span) = span else { return Self::default() };
        let (line, column) = sources.line_column(span);
        let file = sources.path(span.file).display().to_string();
        Self { file: Some(file), line: Some(line), column: Some(column) }
    }
}

impl Finding {
    pub(super) fn new(d: &Diagnostic, sources: &SourceMap) -> Self {
        let label = |(span, text): &(Span, String)| Label {
            message: text.clone(),
            place: Place::of(Some(*span), sources),
        };
        Self {
            severity: match d.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Note => "note",
            },
            message: d.message.clone(),
            place: Place::of(d.span, sources),
            help: d.help.clone(),
            labels: d.labels.iter().map(label).collect(),
            unsupported: d.unsupported,
            source: d.span.and_then(|span| sources.line(span)).map(str::to_owned),
        }
    }

    /// A warning about what stands in no file.
    pub(super) fn warning(message: String) -> Self {
        let place = Place::default();
        let (help, labels) = (Vec::new(), Vec::new());
        Self { severity: "warning", message, place, help, labels, unsupported: false, source: None }
    }

    /// Whether it keeps the scene from being rendered.
    pub fn is_error(&self) -> bool {
        self.severity == "error"
    }

    /// `FILE:LINE:COLUMN: MESSAGE`.
    pub(super) fn line(&self) -> String {
        match &self.place {
            Place { file: Some(file), line: Some(line), column: Some(column) } => {
                format!("{file}:{line}:{column}: {}", self.message)
            }
            _ => self.message.clone(),
        }
    }
}
