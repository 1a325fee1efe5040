//! Where files are written: may they be, and what to do when they cannot.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use caustica_formats::files::words;

use super::Error;

/// Makes sure that no two outputs are one file, and that none is a file the scene was read from.
///
/// # Errors
/// [`Error::IsInput`] or [`Error::NamedTwice`] with the first offender.
pub fn check_distinct(files: &[&Path], inputs: &BTreeSet<PathBuf>) -> Result<(), Error> {
    let mut taken = BTreeSet::new();
    for file in files {
        let real = real(file);
        if inputs.contains(&real) {
            return Err(Error::IsInput(file.to_path_buf()));
        }
        if !taken.insert(real) {
            return Err(Error::NamedTwice(file.to_path_buf()));
        }
    }
    Ok(())
}

/// The file that a path leads to, whether it is there yet or not.
pub fn real(file: &Path) -> PathBuf {
    if let Ok(real) = std::fs::canonicalize(file) {
        return real;
    }
    match (std::fs::canonicalize(folder(file)), file.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => file.to_path_buf(),
    }
}

fn folder(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Makes sure that a file can be written, by writing and removing another one beside it.
///
/// # Errors
/// [`Error::Unwritable`] with the reason.
pub fn check_place(file: &Path) -> Result<(), Error> {
    let fail = |why: &dyn std::fmt::Display| {
        Err(Error::Unwritable { file: file.to_path_buf(), why: why.to_string() })
    };
    if file.as_os_str().to_string_lossy().ends_with(std::path::is_separator) {
        return fail(&"it names a folder");
    }
    match std::fs::metadata(file) {
        Ok(old) if old.is_dir() => return fail(&"it is a folder"),
        Ok(old) if !old.is_file() => return fail(&"it is not a regular file"),
        _ => {}
    }
    let folder = folder(file);
    if !folder.is_dir() {
        return fail(&format!("there is no folder `{}`", folder.display()));
    }
    match tempfile::Builder::new().prefix(".caustica-probe").tempfile_in(folder) {
        Ok(_) => Ok(()),
        // The error itself names the file that was tried, which says nothing.
        Err(e) => fail(&format!("the folder `{}` is not writable: {}", folder.display(), e.kind())),
    }
}

/// Writes a new file into the working folder, or else among the temporary files; its path.
///
/// # Errors
/// Why neither could be written, in words.
pub(super) fn keep_elsewhere(file: &Path, bytes: &[u8]) -> Result<PathBuf, String> {
    let part = |p: Option<&std::ffi::OsStr>| p.unwrap_or_default().to_string_lossy().into_owned();
    let (prefix, suffix) = (format!("{}-", part(file.file_stem())), format!(".{}", part(file.extension())));
    let mut problems = Vec::new();
    for folder in [PathBuf::from("."), std::env::temp_dir()] {
        let kept = tempfile::Builder::new().prefix(&prefix).suffix(&suffix).tempfile_in(&folder).and_then(
            |mut kept| {
                kept.write_all(bytes)?;
                kept.as_file().sync_all()?;
                Ok(kept.keep()?.1)
            },
        );
        match kept {
            Ok(path) => return Ok(path),
            Err(e) => problems.push(format!("`{}`: {}", folder.display(), words(&e))),
        }
    }
    Err(problems.join(", "))
}
