//! The layout rules of the code map (`src/lib.rs`, `formats/src/lib.rs`), checked on the text.

mod size;

use std::fs;
use std::path::{Path, PathBuf};

pub(crate) struct Source {
    /// Relative to the workspace, with `/`.
    pub path: String,
    pub text: String,
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|e| e.unwrap().path()) {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

pub(crate) fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "tests", "benches", "formats", "python", "tools"] {
        collect(&root.join(folder), &mut files);
    }
    files.sort();
    let relative = |p: &Path| p.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
    files.iter().map(|p| Source { path: relative(p), text: fs::read_to_string(p).unwrap() }).collect()
}

/// The part that is compiled into the product: unit tests may reach upwards for their examples.
pub(crate) fn product(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod ").next().unwrap_or(text)
}

fn name(s: &str) -> &str {
    s.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("")
}

/// First segments of every path that starts with `root::`; a list in braces counts by its top level.
fn imports<'a>(text: &'a str, root: &str) -> Vec<&'a str> {
    let key = format!("{root}::");
    let mut found = Vec::new();
    for line in text.lines().filter(|l| !l.trim_start().starts_with("//")) {
        for (at, _) in line.match_indices(&key) {
            // `caustica::` is not the end of another name.
            if line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') {
                continue;
            }
            let rest = &line[at + key.len()..];
            match rest.strip_prefix('{') {
                Some(list) => found.extend(list.split(',').map(|s| name(s.trim()))),
                None => found.push(name(rest)),
            }
        }
    }
    found.retain(|n| !n.is_empty());
    found
}

/// Modules from the bottom up; a module may import those of lower levels and its own. Neighbours of one
/// level that need each other stand in [`ALSO`].
const LEVELS: &[&[&str]] = &[
    &["math"],
    &["sampling"],
    &["spectrum"],
    &["shape", "texture", "accel"],
    &["bsdf", "medium", "emitter", "sensor", "film"],
    &["settings"],
    &["scene"],
    &["transport"],
    &["photon"],
    &["integrator"],
    &["render"],
    &["session"],
    &["serve"],
    &["cli"],
];

/// Exceptions: importer, imported, path that must be the whole of it.
const ALSO: &[(&str, &str)] =
    // The leaves of the tree are as wide as the packets that triangles are tested in.
    &[("accel", "shape::triangle")];

#[test]
fn imports_point_downwards() {
    let level = |module: &str| LEVELS.iter().position(|l| l.contains(&module));
    let mut wrong = Vec::new();
    for s in sources().iter().filter(|s| s.path.starts_with("src/")) {
        let inside = &s.path["src/".len()..];
        let own = inside.split('/').next().unwrap().trim_end_matches(".rs");
        if own == "lib" || own == "main" {
            continue;
        }
        let at = level(own).unwrap_or_else(|| panic!("{} is in no level of this test", s.path));
        for line in product(&s.text).lines() {
            for target in imports(line, "crate") {
                let allowed = target == own
                    || level(target).is_some_and(|l| l < at)
                    || ALSO.iter().any(|(from, to)| *from == own && line.contains(&format!("crate::{to}")));
                if level(target).is_some() && !allowed {
                    wrong.push(format!("{}: {}", s.path, line.trim()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "imports that point upwards:\n{}", wrong.join("\n"));
}

/// `math/kernel` knows only floats; `photon/store`, `scan` and `find` only math (and what a photon is);
/// `bsdf` and `shape` never see a scene (a level rule, restated where it matters most).
#[test]
fn the_photon_store_knows_no_surfaces() {
    for s in sources() {
        let targets = imports(product(&s.text), "crate");
        match s.path.as_str() {
            "src/math/kernel.rs" => {
                let other: Vec<_> = targets.iter().filter(|t| **t != "math").collect();
                assert!(other.is_empty(), "{}: {other:?}", s.path);
                assert!(!product(&s.text).contains("use super::"), "{}", s.path);
            }
            "src/photon/store.rs" | "src/photon/scan.rs" | "src/photon/find.rs" => {
                let other: Vec<_> = targets.iter().filter(|t| **t != "math").collect();
                assert!(other.is_empty(), "{}: {other:?}", s.path);
            }
            _ => {}
        }
    }
}

#[test]
fn formats_know_nothing_of_rendering_and_tools_nothing_of_the_renderer() {
    for s in sources() {
        let text = product(&s.text);
        let names = |crate_name: &str| !imports(text, crate_name).is_empty();
        if s.path.starts_with("formats/") || s.path.starts_with("tools/") {
            assert!(!names("caustica"), "{} imports the renderer", s.path);
        }
        if s.path.starts_with("formats/") {
            assert!(!names("caustica_tools"), "{} imports the tools", s.path);
        }
        if let Some(inside) = s.path.strip_prefix("formats/src/") {
            let module = inside.split('/').next().unwrap().trim_end_matches(".rs");
            let targets = imports(text, "crate");
            let lower: &[&str] = match module {
                "ir" => &["ir", "diagnostic"],
                "diagnostic" => &["diagnostic"],
                "encoding" | "misnamed" | "range" => &[],
                "files" | "memory" => &["files"],
                "missing" => &["diagnostic", "files"],
                "image" => &["image", "files", "memory", "misnamed"],
                "spectrum" => &["spectrum", "ir", "misnamed"],
                "mesh" => &["mesh", "ir", "files", "encoding", "misnamed"],
                "volume" => &["volume", "ir"],
                "mitsuba" => &[
                    "mitsuba",
                    "ir",
                    "diagnostic",
                    "encoding",
                    "files",
                    "sky",
                    "spectrum",
                    "image",
                    "mesh",
                    "misnamed",
                    "missing",
                    "plugin",
                    "range",
                    "read",
                    "write",
                ],
                "pbrt" => &[
                    "pbrt",
                    "ir",
                    "diagnostic",
                    "encoding",
                    "files",
                    "sky",
                    "spectrum",
                    "image",
                    "mesh",
                    "misnamed",
                    "missing",
                    "plugin",
                    "range",
                    "read",
                    "volume",
                    "write",
                ],
                _ => continue,
            };
            let other: Vec<_> = targets.iter().filter(|t| !lower.contains(t)).collect();
            assert!(other.is_empty(), "{}: {other:?}", s.path);
        }
        if s.path.starts_with("tools/src/") {
            let other: Vec<_> =
                imports(text, "caustica_formats").into_iter().filter(|t| *t != "image").collect();
            assert!(other.is_empty(), "{}: {other:?}", s.path);
        }
    }
}

#[test]
fn only_the_compiler_and_the_session_read_the_scene_representation() {
    for s in sources().iter().filter(|s| s.path.starts_with("src/")) {
        let reads = !imports(product(&s.text), "caustica_formats").is_empty();
        let rooms = ["src/scene/compile/", "src/session/", "src/cli/"];
        let may = rooms.iter().any(|room| s.path.starts_with(room));
        assert!(!reads || may, "{} imports caustica_formats", s.path);
        let tools = !imports(product(&s.text), "caustica_tools").is_empty();
        let may = ["src/cli/", "src/serve/"].iter().any(|room| s.path.starts_with(room));
        assert!(!tools || may, "{} imports caustica_tools", s.path);
        let arguments = !imports(&s.text, "clap").is_empty();
        assert!(!arguments || s.path.starts_with("src/cli/"), "{} imports clap", s.path);
        let bvh = !imports(&s.text, "obvhs").is_empty();
        assert!(!bvh || s.path.starts_with("src/accel/"), "{} names obvhs", s.path);
    }
}

/// The bindings need nothing but the front door, and the judge.
#[test]
fn the_python_package_sees_the_session_only() {
    let mut seen = 0;
    for s in sources().iter().filter(|s| s.path.starts_with("python/src/")) {
        let rooms = imports(&s.text, "caustica");
        seen += rooms.len();
        let other: Vec<_> = rooms.into_iter().filter(|room| *room != "session").collect();
        assert!(other.is_empty(), "{}: {other:?}", s.path);
        assert!(imports(&s.text, "caustica_formats").is_empty(), "{} imports caustica_formats", s.path);
    }
    assert!(seen > 0, "the package uses the session");
}

#[test]
fn the_live_view_knows_the_front_door_only() {
    for s in sources().iter().filter(|s| s.path.starts_with("src/serve/")) {
        let targets = imports(&s.text, "crate");
        let other: Vec<_> = targets.iter().filter(|t| !["session", "serve"].contains(t)).collect();
        assert!(other.is_empty(), "{}: {other:?}", s.path);
    }
}

#[test]
fn files_are_short() {
    for s in sources() {
        let product =
            ["src/", "formats/src/", "python/src/", "tools/src/"].iter().any(|f| s.path.starts_with(f));
        let most = if product { 400 } else { 600 };
        let lines = s.text.lines().count();
        assert!(lines <= most, "{} has {lines} lines; {most} is the most", s.path);
    }
}

#[test]
fn nothing_is_left_unfinished() {
    // Put together here, so that this file does not contain what it looks for.
    let words = [
        concat!("todo", "!"),
        concat!("unimplemented", "!"),
        concat!("dbg", "!"),
        concat!("#[", "ignore"),
        concat!("FIX", "ME"),
        concat!("XX", "X"),
    ];
    for s in sources() {
        for word in words {
            assert!(!s.text.contains(word), "{} contains {word}", s.path);
        }
    }
}
