//! Finding the files a scene names, and the messages when they are missing.

use std::path::{Path, PathBuf};

use crate::diagnostic::{Diagnostic, Span, nearest};
use crate::files::{Files, other_case, part_by_part, resolve};

/// The first of `folders` with a file `name`, also when its author wrote `\` for `/`.
pub(crate) fn find(files: &dyn Files, name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    resolve(files, name, folders).or_else(|| resolve(files, &name.replace('\\', "/"), folders))
}

/// "`what` not found", with the file that was probably meant or the folders that were searched.
pub(crate) fn not_found(
    files: &dyn Files,
    what: &str,
    name: &str,
    span: Span,
    folders: &[PathBuf],
) -> Diagnostic {
    let problem = Diagnostic::error(format!("{what} `{name}` not found"), Some(span));
    let name = name.replace('\\', "/");
    if let Some(path) = other_case(files, &name, folders) {
        return problem.help(format!("there is `{}`; upper and lower case matter", path.display()));
    }
    if Path::new(&name).is_absolute() {
        return problem;
    }
    let problem = match similar(files, &name, folders) {
        Some(path) => problem.help(format!("did you mean `{}`?", path.display())),
        None => problem,
    };
    let mut searched: Vec<String> = Vec::new();
    for folder in folders {
        let shown = folder.display().to_string();
        let shown = if shown.is_empty() { ".".to_owned() } else { shown };
        if !searched.contains(&shown) {
            searched.push(shown);
        }
    }
    problem.help(format!("searched in: {}", searched.join(", ")))
}

/// Most entries of a folder that are compared with a name.
const COMPARED: usize = 2000;

/// The file nearest to `name` in spelling, part by part, below one of `folders`.
fn similar(files: &dyn Files, name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    part_by_part(files, name, folders, |mut names, part| {
        names.sort_unstable();
        // A different extension is a different file, not a typo.
        let (stem, extension) = split(part);
        let alike = names.iter().map(|n| split(n)).filter(|(_, e)| *e == extension).take(COMPARED);
        let stem = nearest(stem, alike.map(|(stem, _)| stem))?;
        Some(if extension.is_empty() { stem.to_owned() } else { format!("{stem}.{extension}") })
    })
}

fn split(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or((name, ""))
}
