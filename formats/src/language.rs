//! The scene languages: one row each with the file extensions, the reader, the writer and the table of supported
//! plugins.

use std::path::Path;

use crate::diagnostic::{Diagnostic, Severity, SourceMap, nearest};
use crate::files::Files;
use crate::plugin::Concept;
use crate::read::{Failure, Read, ReadOptions};
use crate::write::{Output, WriteError, Written};
use crate::{misnamed, mitsuba, pbrt};

type Reader = fn(&dyn Files, &Path, &ReadOptions) -> Result<Read, Box<Failure>>;
type Writer = fn(&mut Output<'_>) -> Result<String, WriteError>;

/// A scene language.
#[derive(Debug)]
pub struct Language {
    /// As its users call it.
    pub name: &'static str,
    /// Every known plugin by concept, and whether it is rendered.
    pub support: fn() -> Vec<Concept>,
    /// Lower case, without the dot; the first one is that of written files.
    extensions: &'static [&'static str],
    read: Reader,
    write: Writer,
}

/// One row per scene language.
pub const LANGUAGES: &[Language] = &[
    Language {
        name: "Mitsuba",
        support: mitsuba::support,
        extensions: &["xml"],
        read: mitsuba::read,
        write: mitsuba::write::write,
    },
    Language {
        name: "pbrt-v4",
        support: pbrt::support,
        extensions: &["pbrt", "pbrt.gz"],
        read: pbrt::read,
        write: pbrt::write::write,
    },
];

/// Extensions as messages list them: `.xml, .pbrt`.
fn dotted(extensions: impl Iterator<Item = &'static str>) -> String {
    extensions.map(|name| format!(".{name}")).collect::<Vec<_>>().join(", ")
}

/// Reads a scene in the language its extension names. Meshes and textures are looked for, not opened.
///
/// # Errors
/// All problems of the scene, or that no language has the extension.
pub fn read_scene(files: &dyn Files, path: &Path, options: &ReadOptions) -> Result<Read, Box<Failure>> {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default().to_ascii_lowercase();
    let named = |l: &&Language| l.extensions.iter().any(|known| name.ends_with(&format!(".{known}")));
    if let Some(language) = LANGUAGES.iter().find(named) {
        return (language.read)(files, path, options).map_err(|mut failure| {
            failure.diagnostics.extend(other_language(language, files, path));
            Box::new(failure.advised(files, path))
        });
    }
    let known = dotted(LANGUAGES.iter().flat_map(|l| l.extensions).copied());
    let problem = Diagnostic::error(format!("{}: not a scene language caustica reads", path.display()), None)
        .help(format!("the extension decides; known: {known}"));
    Err(Box::new(Failure { diagnostics: vec![problem], sources: SourceMap::default() }))
}

/// A note where the text of a scene that could not be read is that of the other language.
fn other_language(language: &Language, files: &dyn Files, path: &Path) -> Option<Diagnostic> {
    let bytes = files.read(path).ok()?;
    let xml = misnamed::is_xml(&bytes);
    let other = LANGUAGES.iter().find(|other| (other.name == "Mitsuba") == xml)?;
    // What begins with neither a tag nor a word is of no language.
    let text = xml || bytes.first().is_some_and(|byte| byte.is_ascii_alphabetic() || *byte == b'#');
    if other.name == language.name || !text {
        return None;
    }
    let what = if xml { "the file begins as XML does" } else { "the file does not begin as XML does" };
    let help = format!(
        "the extension decides: scenes of {} end in {}",
        other.name,
        dotted(other.extensions.iter().copied())
    );
    Some(Diagnostic::new(Severity::Note, what, None).help(help))
}

/// The scene of `read` in the language that the extension of `path` names, in memory. Meshes and textures
/// below the folder of `path` stay where they are; others are carried along.
///
/// # Errors
/// When no language has the extension; when a mesh or picture may not be read, before any is opened; when one that has
/// to be converted is broken.
pub fn write_scene(read: &Read, files: &dyn Files, path: &Path) -> Result<Written, WriteError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let written = || LANGUAGES.iter().map(|language| language.extensions[0]);
    let Some(language) = LANGUAGES.iter().find(|language| language.extensions[0] == extension) else {
        let hint = nearest(&extension, written());
        return Err(WriteError::UnknownLanguage {
            path: path.display().to_string(),
            known: dotted(written()),
            hint: hint.map_or(String::new(), |name| format!("; did you mean .{name}?")),
        });
    };
    let mut output = Output::new(read, files, path);
    output.check_files()?;
    let text = (language.write)(&mut output)?;
    Ok(Written::new(path, text, output))
}
