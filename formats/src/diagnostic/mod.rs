//! Spans, diagnostics and their rendering with a source excerpt.
//!
//! Offsets become line and column only when a message is printed.

mod lines;
mod narrow;
mod shell;

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use codespan_reporting::diagnostic::{self as codespan, LabelStyle};
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term;
use serde::{Deserialize, Serialize};

pub(crate) use shell::quoted;

use lines::Lines;

/// Byte range in a file of a [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Span {
    /// Index in the map.
    pub file: u32,
    /// Offset of the first byte.
    pub start: u32,
    /// Offset after the last byte.
    pub end: u32,
}

/// How bad a message is, mildest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The scene is used, though not as written.
    Warning,
    /// The scene cannot be used.
    Error,
}

/// One message about one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, in one line.
    pub message: String,
    /// Where; `None` for what stands in no file.
    pub span: Option<Span>,
    /// Further places, each with its own words ("first defined here").
    pub labels: Vec<(Span, String)>,
    /// What to do about it ("did you mean `radius`?").
    pub help: Vec<String>,
    /// Names something that is known and not rendered.
    pub unsupported: bool,
    /// What was asked for beside the scene is wrong, not the scene.
    pub request: bool,
}

impl Diagnostic {
    /// A message without labels and help.
    pub fn new(severity: Severity, message: impl Into<String>, span: Option<Span>) -> Self {
        Self {
            severity,
            message: message.into(),
            span,
            labels: Vec::new(),
            help: Vec::new(),
            unsupported: false,
            request: false,
        }
    }

    /// An error.
    pub fn error(message: impl Into<String>, span: Option<Span>) -> Self {
        Self::new(Severity::Error, message, span)
    }

    /// A warning.
    pub fn warning(message: impl Into<String>, span: Option<Span>) -> Self {
        Self::new(Severity::Warning, message, span)
    }

    /// Marks it as a message about something known but not rendered.
    #[must_use]
    pub fn unsupported(mut self) -> Self {
        self.unsupported = true;
        self
    }

    /// Marks it as a message about what was asked for, such as a value for a parameter that no scene has.
    #[must_use]
    pub fn request(mut self) -> Self {
        self.request = true;
        self
    }

    /// With a further place.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push((span, text.into()));
        self
    }

    /// With advice.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// With the name in `known` that was probably meant by `name`, if there is one.
    #[must_use]
    pub fn suggest<'a>(self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        match nearest(name, known) {
            Some(near) => self.help(format!("did you mean `{near}`?")),
            None => self,
        }
    }

    /// As [`Self::suggest`], with `otherwise` as help where no name is near.
    #[must_use]
    pub fn suggest_or<'a>(
        self,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
        otherwise: impl FnOnce() -> String,
    ) -> Self {
        match nearest(name, known) {
            Some(near) => self.help(format!("did you mean `{near}`?")),
            None => self.help(otherwise()),
        }
    }
}

/// Sorts messages by severity, worst first, then by place; one without a place comes last. What was said
/// of the same place before is dropped: an object that several others refer to may be read more than once.
pub(crate) fn in_source_order(problems: &mut Vec<Diagnostic>) {
    let place = |p: &Diagnostic| p.span.map_or((u32::MAX, 0), |s| (s.file, s.start));
    problems.sort_by_key(|p| (std::cmp::Reverse(p.severity), place(p)));
    let mut said = HashSet::new();
    problems.retain(|p| p.span.is_none() || said.insert((p.span, p.message.clone())));
}

/// Most messages printed at once.
pub(crate) const SHOWN: usize = 100;

/// The last boundary between characters of `text` at or before `offset`.
pub(crate) fn char_floor(text: &str, offset: usize) -> usize {
    let mut offset = offset.min(text.len());
    while !text.is_char_boundary(offset) {
        offset -= 1;
    }
    offset
}

/// The name in `known` nearest to `name`, if any is near enough to be a typo.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|k| (strsim::damerau_levenshtein(&name.to_ascii_lowercase(), &k.to_ascii_lowercase()), k))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, k)| *distance <= (k.len().max(name.len()) / 3).max(1))
        .map(|(_, k)| k)
}

/// Every text file a scene was read from.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

#[derive(Clone, Debug)]
struct SourceFile {
    path: PathBuf,
    text: String,
    /// Once a place was asked for: most scenes have no message.
    lines: OnceLock<Lines>,
}

impl SourceMap {
    /// Adds a file and returns its index.
    pub fn add(&mut self, path: PathBuf, text: String) -> u32 {
        let id = u32::try_from(self.files.len()).expect("memory holds fewer files");
        self.files.push(SourceFile { path, text, lines: OnceLock::new() });
        id
    }

    /// Replaces the text of a file that was added before it was read.
    pub(crate) fn set_text(&mut self, file: u32, text: String) {
        let file = &mut self.files[file as usize];
        (file.text, file.lines) = (text, OnceLock::new());
    }

    /// The path of a file as it was opened.
    pub fn path(&self, file: u32) -> &Path {
        &self.files[file as usize].path
    }

    /// Of all files, the main one first.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|file| file.path.as_path())
    }

    /// The text of a file.
    pub fn text(&self, file: u32) -> &str {
        &self.files[file as usize].text
    }

    /// 1-based line and column (in characters) of the start of `span`.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        let SourceFile { text, lines, .. } = &self.files[span.file as usize];
        let offset = char_floor(text, span.start as usize);
        lines.get_or_init(|| Lines::of(text)).place(text, offset)
    }

    /// The line in which `span` starts.
    pub fn line(&self, span: Span) -> Option<&str> {
        let text = &self.files[span.file as usize].text;
        let start = char_floor(text, span.start as usize);
        let begin = text[..start].rfind('\n').map_or(0, |at| at + 1);
        text[begin..].lines().next()
    }

    /// `path:line:column` of the start of `span`.
    pub fn location(&self, span: Span) -> String {
        let (line, column) = self.line_column(span);
        format!("{}:{line}:{column}", self.path(span.file).display())
    }

    /// Human-readable text of diagnostics in their order, with excerpts, and how many there are beyond
    /// the first [`SHOWN`].
    pub fn render(&self, diagnostics: &[Diagnostic]) -> String {
        let mut files = SimpleFiles::new();
        for SourceFile { path, text, .. } in &self.files {
            files.add(path.display().to_string(), text.as_str());
        }
        let config = term::Config::default();
        let mut out = String::new();
        for d in diagnostics.iter().take(SHOWN) {
            let severity = match d.severity {
                Severity::Note => codespan::Severity::Note,
                Severity::Warning => codespan::Severity::Warning,
                Severity::Error => codespan::Severity::Error,
            };
            let label = |style: LabelStyle, span: Span| {
                codespan::Label::new(style, span.file as usize, span.start as usize..span.end as usize)
            };
            let mut labels: Vec<_> = d.span.iter().map(|&s| label(LabelStyle::Primary, s)).collect();
            labels.extend(d.labels.iter().map(|(s, t)| label(LabelStyle::Secondary, *s).with_message(t)));
            let mut text = String::new();
            let message = codespan::Diagnostic::new(severity)
                .with_message(&d.message)
                .with_labels(labels)
                .with_notes(d.help.iter().map(|h| format!("help: {h}")).collect());
            // Writing to a String fails only for a label outside its file; then the bare message serves.
            if term::emit_to_string(&mut text, &config, &files, &message).is_err() {
                text.push_str(&format!("{:?}: {}\n", d.severity, d.message));
            }
            // One by one: the excerpts of a long line together would be many times its length.
            out.push_str(&narrow::narrowed(&text));
        }
        if let Some(more) = diagnostics.len().checked_sub(SHOWN).filter(|more| *more > 0) {
            out.push_str(&format!("... and {more} more like these\n"));
        }
        out
    }
}
