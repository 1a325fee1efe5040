//! The pbrt reader through its public interface, with files in memory.
#![allow(clippy::unwrap_used)]

mod materials3;
mod media;
mod messages;
mod plugins;
mod policy;
mod robust;
mod version3;

use std::io::Write;
use std::path::{Path, PathBuf};

use caustica_formats::files::Memory;
use caustica_formats::{Failure, Read, ReadOptions, ir, read_scene};

/// The scene is `scene.pbrt`; a mesh, a picture and two includes exist.
fn files(scene: &str) -> Memory {
    let all = [
        ("scene.pbrt", scene),
        ("mesh.ply", ""),
        ("wood.png", ""),
        ("ball.pbrt", "Shape \"sphere\"\n"),
        ("loop.pbrt", "Include \"loop.pbrt\"\n"),
        ("au.spd", "400 1.5\n700 0.2\n"),
    ];
    Memory(all.iter().map(|(path, text)| (PathBuf::from(path), text.as_bytes().to_vec())).collect())
}

fn try_read(scene: &str, options: &ReadOptions) -> Result<Read, Box<Failure>> {
    read_scene(&files(scene), Path::new("scene.pbrt"), options)
}

/// The scene, which must have no problem at all.
fn scene(text: &str) -> ir::Scene {
    let read = try_read(text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(read.warnings.is_empty(), "{}", read.sources.render(&read.warnings));
    read.scene
}

/// `body` after WorldBegin, with a lamp so that nothing warns of darkness.
fn world(body: &str) -> ir::Scene {
    scene(&format!("WorldBegin LightSource \"infinite\"\n{body}"))
}

/// `path:line:column: message` of every problem, worst first.
fn problems_with(scene: &str, options: &ReadOptions) -> Vec<String> {
    let (diagnostics, sources) = match try_read(scene, options) {
        Ok(read) => (read.warnings, read.sources),
        Err(failure) => {
            // Rendering must survive every span.
            assert!(!failure.to_string().is_empty());
            (failure.diagnostics, failure.sources)
        }
    };
    let place = |d: &caustica_formats::diagnostic::Diagnostic| d.span.map(|s| sources.location(s));
    let help = |d: &caustica_formats::diagnostic::Diagnostic| {
        if d.help.is_empty() { String::new() } else { format!(" ({})", d.help.join("; ")) }
    };
    let line = |d| format!("{}: {}{}", place(d).unwrap_or_default(), d.message, help(d));
    diagnostics.iter().map(line).collect()
}

fn problems(scene: &str) -> Vec<String> {
    problems_with(scene, &ReadOptions::default())
}

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}
