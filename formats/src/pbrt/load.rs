//! Files → one list of directives: decompression, includes, limits.

use std::path::{Path, PathBuf};

use super::directive::{Directive, Value};
use super::parse::parse;
use super::upgrade::Old;
use crate::diagnostic::{Diagnostic, SourceMap, Span};
use crate::encoding::into_utf8;
use crate::files::{Files, Included, is_gzip, unpack};
use crate::misnamed;
use crate::missing::{find, not_found};

/// Deepest nesting of includes.
const MAX_DEPTH: usize = 64;
/// Most bytes of all files together: spans are 32 bits.
const MAX_TEXT: u64 = u32::MAX as u64 - 1;

pub(super) struct Loader<'a> {
    pub files: &'a dyn Files,
    /// Of the main scene; names are relative to it everywhere.
    pub folders: &'a [PathBuf],
    pub sources: &'a mut SourceMap,
    pub problems: &'a mut Vec<Diagnostic>,
    pub old: &'a mut Old,
    /// A file is missing or cannot be read.
    pub incomplete: bool,
    bytes: u64,
    repeats: Included,
    open: Vec<PathBuf>,
}

impl<'a> Loader<'a> {
    pub fn new(
        files: &'a dyn Files,
        folders: &'a [PathBuf],
        sources: &'a mut SourceMap,
        problems: &'a mut Vec<Diagnostic>,
        old: &'a mut Old,
    ) -> Self {
        Self {
            files,
            folders,
            sources,
            problems,
            old,
            incomplete: false,
            bytes: 0,
            repeats: Included::default(),
            open: Vec::new(),
        }
    }

    /// Appends the directives of the file at `path` and of all it includes; `from` includes it.
    pub fn load(&mut self, path: &Path, from: Option<Span>, out: &mut Vec<Directive>) {
        if self.open.iter().any(|open| open == path) {
            let chain: Vec<String> = self
                .open
                .iter()
                .map(PathBuf::as_path)
                .chain([path])
                .map(|p| p.display().to_string())
                .collect();
            return self.error(format!("files include each other: {}", chain.join(" → ")), from);
        }
        if self.open.len() >= MAX_DEPTH {
            return self.error(format!("includes are nested more than {MAX_DEPTH} deep"), from);
        }
        // Reported already.
        if self.repeats.is_full() || self.bytes > MAX_TEXT {
            return;
        }
        let text = match self.text(path) {
            Ok(text) => text,
            Err(e) => {
                self.incomplete = true;
                return self.error(format!("cannot read `{}`: {e}", path.display()), from);
            }
        };
        self.bytes += text.len() as u64;
        if self.bytes > MAX_TEXT {
            return self.error("the scene's files are over 4 GiB in all", from);
        }
        if let Err(e) = self.repeats.count(path, text.len()) {
            return self.error(e, from);
        }
        let file = self.sources.add(path.to_path_buf(), String::new());
        let directives = parse(&text, file, self.old, self.problems);
        self.sources.set_text(file, text);
        self.open.push(path.to_path_buf());
        for mut directive in directives {
            if !self.old.directive(&mut directive) {
                continue;
            }
            if matches!(directive.name.as_str(), "Include" | "Import") {
                self.include(directive, out);
            } else {
                out.push(directive);
            }
        }
        self.open.pop();
    }

    fn include(&mut self, directive: Directive, out: &mut Vec<Directive>) {
        let Some((name, span)) = directive.arguments.first().and_then(|argument| match &argument.value {
            Value::Text(name) => Some((name.clone(), argument.span)),
            _ => None,
        }) else {
            return;
        };
        let Some(path) = find(self.files, &name, self.folders) else {
            self.incomplete = true;
            self.problems.push(not_found(self.files, "file", &name, span, self.folders));
            return;
        };
        // An import has a scope of its own, as AttributeBegin and AttributeEnd around it make one.
        let scope = directive.name == "Import";
        let mark = |name: &str| Directive {
            name: name.to_owned(),
            span: directive.span,
            arguments: Vec::new(),
            params: Vec::new(),
        };
        if scope {
            out.push(mark("AttributeBegin"));
        }
        self.load(&path, Some(span), out);
        if scope {
            out.push(mark("AttributeEnd"));
        }
    }

    fn error(&mut self, text: impl Into<String>, span: Option<Span>) {
        self.problems.push(Diagnostic::error(text, span));
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        let bytes = self.files.read(path).map_err(|e| e.to_string())?;
        let bytes = if is_gzip(&bytes) { unpack(&bytes, MAX_TEXT)? } else { bytes };
        let bytes = into_utf8(bytes);
        if let Some(what) = misnamed::named(&bytes) {
            return Err(format!("it is {what}"));
        }
        if bytes.len() as u64 > MAX_TEXT {
            return Err("it is over 4 GiB".to_owned());
        }
        // Old scenes have Latin-1 letters in comments, which do no harm.
        Ok(String::from_utf8(bytes).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned()))
    }
}
