//! Converting takes time in proportion to the scene: each file is read once, however many shapes refer to it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use caustica_formats::files::{Files, Memory};
use caustica_formats::{ReadOptions, read_scene, write_scene};

/// Counts how often each file is read.
#[derive(Debug)]
struct Counted {
    files: Memory,
    reads: Mutex<BTreeMap<PathBuf, usize>>,
}

impl Files for Counted {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        *self.reads.lock().unwrap().entry(path.to_path_buf()).or_default() += 1;
        self.files.read(path)
    }

    fn is_file(&self, path: &Path) -> bool {
        self.files.is_file(path)
    }
}

const SHAPES: usize = 50;

/// Files that are kept, files that are converted, and pictures that are looked at, each used by fifty shapes.
fn scene() -> Counted {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let triangle = format!("{ply}3 0 1 2\n");
    let quad = format!("{ply}4 0 1 2 3\n");
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_owned();
    let picture = caustica_formats::image::encode_pfm(2, 2, &[0.5; 12]).unwrap();
    let files = [("triangle.ply", triangle), ("quad.ply", quad), ("mesh.obj", obj)];
    let mut files: BTreeMap<PathBuf, Vec<u8>> =
        files.map(|(name, text)| (Path::new("/scene").join(name), text.into_bytes())).into();
    files.insert("/scene/picture.pfm".into(), picture);
    let mut text = String::from("<scene version=\"3.0.0\"><emitter type=\"constant\"/>\n");
    for i in 0..SHAPES {
        for (plugin, name) in [("ply", "triangle.ply"), ("ply", "quad.ply"), ("obj", "mesh.obj")] {
            // Each material has a texture of its own that shows the same picture.
            writeln!(
                text,
                "<shape type=\"{plugin}\"><string name=\"filename\" value=\"{name}\"/>\
                 <bsdf type=\"roughplastic\"><texture type=\"bitmap\" name=\"diffuse_reflectance\">\
                 <string name=\"filename\" value=\"picture.pfm\"/><transform name=\"to_uv\">\
                 <scale x=\"{}\"/></transform></texture></bsdf></shape>",
                i + 1
            )
            .unwrap();
        }
    }
    text.push_str("</scene>\n");
    files.insert("/scene/s.xml".into(), text.into_bytes());
    Counted { files: Memory(files), reads: Mutex::default() }
}

#[test]
fn every_file_is_read_once() {
    for name in ["made.xml", "made.pbrt"] {
        let files = scene();
        let read = read_scene(&files, Path::new("/scene/s.xml"), &ReadOptions::default()).unwrap();
        files.reads.lock().unwrap().clear();
        let folder = tempfile::tempdir().unwrap();
        let written = write_scene(&read, &files, &folder.path().join(name)).unwrap();
        written.save(&files, false).unwrap();
        let reads = files.reads.lock().unwrap();
        assert_eq!(reads.len(), 4, "{reads:?}");
        assert!(reads.values().all(|count| *count == 1), "{name}: {reads:?}");
    }
}

/// Nothing is left where a file cannot be put in its place, in folders or beside them.
#[test]
fn a_scene_is_written_whole_or_not_at_all() {
    let files = scene();
    let read = read_scene(&files, Path::new("/scene/s.xml"), &ReadOptions::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let written = write_scene(&read, &files, &folder.path().join("made.xml")).unwrap();
    let last = folder.path().join(&written.assets.last().unwrap().path);
    std::fs::create_dir_all(&last).unwrap();
    assert!(written.save(&files, true).is_err());
    assert!(!folder.path().join("made.xml").exists());
    let beside = std::fs::read_dir(last.parent().unwrap()).unwrap();
    assert_eq!(beside.count(), 1, "the folder that was in the way");
    std::fs::remove_dir(&last).unwrap();
    written.save(&files, false).unwrap();
    assert!(folder.path().join("made.xml").is_file());
}

/// All that may not be read is named before anything is opened.
#[test]
fn what_is_missing_is_named_before_anything_is_read() {
    let mut files = scene();
    let read = read_scene(&files, Path::new("/scene/s.xml"), &ReadOptions::default()).unwrap();
    for name in ["quad.ply", "picture.pfm"] {
        files.files.0.remove(&Path::new("/scene").join(name));
    }
    files.reads.lock().unwrap().clear();
    let problem = write_scene(&read, &files, Path::new("/made/made.xml")).unwrap_err().to_string();
    assert!(problem.contains("/scene/picture.pfm") && problem.contains("/scene/quad.ply"), "{problem}");
    assert!(files.reads.lock().unwrap().is_empty());
}
