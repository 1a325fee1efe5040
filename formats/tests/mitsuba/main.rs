//! The Mitsuba reader through its public interface, with files in memory.
#![allow(clippy::unwrap_used)]

mod language;
mod lights;
mod media;
mod messages;
mod plugins;
mod policy;
mod robust;
mod sunsky;
mod versions;

use std::path::{Path, PathBuf};

use caustica_formats::files::Memory;
use caustica_formats::{Failure, Read, ReadOptions, ir, read_scene};

/// Files in memory: the scene is `scene.xml`; meshes and a texture exist.
fn files(scene: &str, more: &[(&str, &str)]) -> Memory {
    let fixed = [("scene.xml", scene), ("mesh.obj", ""), ("mesh.ply", ""), ("wood.png", "")];
    let all = fixed.iter().chain(more).map(|(path, text)| (PathBuf::from(path), text.as_bytes().to_vec()));
    Memory(all.collect())
}

/// What a scene of 0.x without a sensor is told. Few scenes of these tests have one.
const UNSEEN: &str = "the scene has no sensor: a perspective one looks at all of it along +Z";

fn try_read(scene: &str, more: &[(&str, &str)], options: &ReadOptions) -> Result<Read, Box<Failure>> {
    let mut read = read_scene(&files(scene, more), Path::new("scene.xml"), options);
    match &mut read {
        Ok(read) => read.warnings.retain(|warning| warning.message != UNSEEN),
        Err(failure) => failure.diagnostics.retain(|problem| problem.message != UNSEEN),
    }
    read
}

/// The scene, which must have no problem at all.
fn scene(text: &str) -> ir::Scene {
    let read = try_read(text, &[], &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(read.warnings.is_empty(), "{}", read.sources.render(&read.warnings));
    read.scene
}

/// `body` inside a scene of version 3.
fn v3(body: &str) -> ir::Scene {
    scene(&format!("<scene version='3.0.0'>{body}</scene>"))
}

/// `body` inside a scene of version 0.6.
fn v06(body: &str) -> ir::Scene {
    scene(&format!("<scene version='0.6.0'>{body}</scene>"))
}

/// The rendered failure.
fn failure(scene: &str) -> String {
    failure_with(scene, &[], &[])
}

fn failure_with(scene: &str, more: &[(&str, &str)], defines: &[(&str, &str)]) -> String {
    let defines = defines.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
    let options = ReadOptions { defines, ..ReadOptions::default() };
    match try_read(scene, more, &options) {
        Ok(_) => panic!("the scene was accepted"),
        Err(failure) => trimmed(&failure.to_string()),
    }
}

/// The rendered warnings of a scene that is accepted.
fn warnings(scene: &str, lenient: bool) -> String {
    let options = ReadOptions { lenient, ..ReadOptions::default() };
    let read = try_read(scene, &[], &options).unwrap_or_else(|e| panic!("{e}"));
    trimmed(&read.sources.render(&read.warnings))
}

/// Without blanks at line ends, which editors remove from snapshots.
fn trimmed(text: &str) -> String {
    text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim_end().to_owned()
}

/// First line of each message.
fn headlines(scene: &str) -> Vec<String> {
    match try_read(scene, &[], &ReadOptions::default()) {
        Ok(read) => read.warnings.into_iter().map(|d| d.message).collect(),
        Err(failure) => failure.diagnostics.into_iter().map(|d| d.message).collect(),
    }
}
