//! Snapshots: the representation of every scene of the repository, and what is said of every bad one.
//!
//! `cargo insta review`, or INSTA_UPDATE=always, accepts changes that are meant.

use std::path::{Path, PathBuf};

use caustica_formats::files::{Disk, Memory};
use caustica_formats::{ReadOptions, read_scene};

#[test]
fn scenes_of_the_repository() {
    insta::glob!("../../../scenes", "**/*.{xml,pbrt}", |path| {
        let read = read_scene(&Disk, path, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        assert!(read.warnings.is_empty(), "{}", read.sources.render(&read.warnings));
        // Pictures have the paths of this machine.
        let mut settings = insta::Settings::clone_current();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
        let any = |c: char| !c.is_ascii_alphanumeric() && c != '/';
        settings.add_filter(&root.display().to_string().replace(any, "."), "ROOT");
        settings.bind(|| insta::assert_ron_snapshot!(read.scene));
    });
}

/// Each file of `bad/` is wrong in many ways, all of which are reported at once.
#[test]
fn every_diagnostic() {
    insta::glob!("bad", "*.{xml,pbrt}", |path| {
        let name = PathBuf::from(path.file_name().unwrap());
        insta::assert_snapshot!(said_of(&name, std::fs::read(path).unwrap()));
    });
}

/// All problems, or all warnings where the scene can be read; then what is left of them when all is
/// allowed that can be.
fn said_of(name: &Path, text: Vec<u8>) -> String {
    let beside = [
        ("mesh.obj", ""),
        ("mesh.ply", ""),
        ("mesh.serialized", ""),
        ("wood.png", ""),
        ("a.spd", "400 oops"),
        ("broken.spd", "400 oops"),
        ("short.spd", "400 1"),
    ];
    let beside = beside.map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec()));
    let files = Memory(beside.into_iter().chain([(name.to_path_buf(), text)]).collect());
    let said = |options: &ReadOptions| match read_scene(&files, name, options) {
        Ok(read) => read.sources.render(&read.warnings),
        Err(failure) => failure.to_string(),
    };
    let strict = said(&ReadOptions::default());
    assert!(!strict.is_empty(), "nothing is said of {}", name.display());
    let lenient = said(&ReadOptions { lenient: true, ..ReadOptions::default() });
    if lenient == strict {
        strict
    } else {
        format!("{}\n\n--- with all allowed ---\n\n{}", strict.trim_end(), lenient.trim_end())
    }
}
