//! Advice where a scene names files that it may not read: the folder to allow, in a command line.

use std::path::{Component, Path, PathBuf};

use crate::diagnostic::{Diagnostic, Severity, quoted};
use crate::files::Files;

/// Most folders that one command line allows.
const FOLDERS: usize = 8;

/// One note about all files that the scene at `scene` names and may not read; `None` where there are none.
pub fn advice(files: &dyn Files, scene: &Path) -> Option<Diagnostic> {
    let outside = files.outside();
    let folders = folders(&outside)?;
    let here = std::env::current_dir().ok().and_then(|here| std::fs::canonicalize(here).ok());
    let options: Vec<String> = folders
        .iter()
        .map(|folder| {
            format!("--allow-path {}", quoted(&shown(folder, here.as_deref()).display().to_string()))
        })
        .collect();
    let options = options.join(" ");
    let text = match outside.len() {
        1 => "a file that the scene names lies outside of its folder; such files are read on request only"
            .to_owned(),
        n => format!(
            "{n} files that the scene names lie outside of its folder; such files are read on request only"
        ),
    };
    let command = format!("caustica render {} {options}", quoted(&scene.display().to_string()));
    Some(Diagnostic::new(Severity::Note, text, None).help(format!("to allow it: {command}")))
}

/// The one folder that all files are in or below, or if that is the root of the file system each of theirs.
fn folders(files: &[PathBuf]) -> Option<Vec<PathBuf>> {
    let mut folders: Vec<PathBuf> =
        files.iter().filter_map(|file| file.parent()).map(Path::to_path_buf).collect();
    let first = folders.first()?;
    let common = folders.iter().fold(first.clone(), |common, folder| {
        let same = common.components().zip(folder.components()).take_while(|(a, b)| a == b);
        same.map(|(part, _)| part).collect()
    });
    if common.components().any(|part| matches!(part, Component::Normal(_))) {
        return Some(vec![common]);
    }
    folders.sort();
    folders.dedup();
    let all = folders.clone();
    folders.retain(|folder| !all.iter().any(|other| other != folder && folder.starts_with(other)));
    folders.truncate(FOLDERS);
    Some(folders)
}

/// The folder as seen from `here`, where that is shorter.
fn shown(folder: &Path, here: Option<&Path>) -> PathBuf {
    let Some(here) = here else { return folder.to_path_buf() };
    let shared = folder.components().zip(here.components()).take_while(|(a, b)| a == b).count();
    let up = here.components().skip(shared).map(|_| Component::ParentDir);
    let relative: PathBuf = up.chain(folder.components().skip(shared)).collect();
    if relative.as_os_str().is_empty() {
        return PathBuf::from(".");
    }
    if relative.as_os_str().len() < folder.as_os_str().len() { relative } else { folder.to_path_buf() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn the_common_folder_is_found() {
        let of = |names: &[&str]| folders(&paths(names)).unwrap_or_default();
        assert_eq!(of(&["/p/meshes/a/x.ply", "/p/meshes/b/y.ply"]), paths(&["/p/meshes"]));
        assert_eq!(of(&["/p/meshes/x.ply", "/p/meshes-too/y.ply"]), paths(&["/p"]));
        assert_eq!(of(&["/p/meshes/x.ply"]), paths(&["/p/meshes"]));
        assert_eq!(of(&["/p/x.ply", "/q/a/y.ply", "/q/z.ply"]), paths(&["/p", "/q"]));
        assert!(of(&[]).is_empty());
    }

    #[test]
    fn folders_are_shown_as_seen_from_here_and_quoted() {
        let shown = |folder: &str, here: &str| shown(Path::new(folder), Some(Path::new(here)));
        assert_eq!(shown("/home/me/p", "/home/me/p/scenes/a"), Path::new("../.."));
        assert_eq!(shown("/home/me/p", "/home/me/p"), Path::new("."));
        assert_eq!(shown("/home/me/p/meshes", "/home/me/p/scenes"), Path::new("../meshes"));
        assert_eq!(shown("/data", "/home/me/p/scenes"), Path::new("/data"));
        assert_eq!(quoted("a b/it's"), "'a b/it'\\''s'");
        assert_eq!(quoted("../.."), "../..");
    }
}
