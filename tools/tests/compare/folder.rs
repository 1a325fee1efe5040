//! What the tests of `run` share: pictures in a folder, and runs.

use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use caustica_tools::compare::{CompareArgs, Status, run};
use serde_json::Value;
use std::path::PathBuf;
use tempfile::TempDir;

/// A temporary folder.
pub struct Folder(pub TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// An EXR of one colour, 20 × 10 unless `size` says otherwise.
    pub fn exr(&self, name: &str, channels: &[&str], value: f32) -> PathBuf {
        self.sized(name, channels, value, (20, 10))
    }

    pub fn sized(&self, name: &str, channels: &[&str], value: f32, (w, h): (usize, usize)) -> PathBuf {
        let data = vec![value; w * h * channels.len()];
        self.write(name, channels, &data, (w, h))
    }

    pub fn write(&self, name: &str, channels: &[&str], data: &[f32], (w, h): (usize, usize)) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let layer = ExrLayer { name: "", channels, data };
        write_exr(&path, w, h, &[layer], &[], ExrOptions::default()).unwrap();
        path
    }
}

pub const RGB: [&str; 3] = ["R", "G", "B"];

pub fn text(args: &CompareArgs) -> (Status, String) {
    let mut out = Vec::new();
    let status = run(args, &mut out);
    (status, String::from_utf8(out).unwrap())
}

pub fn json(args: CompareArgs) -> (Status, Value) {
    let (status, text) = text(&CompareArgs { json: Some(None), ..args });
    (status, serde_json::from_str(&text).unwrap())
}

/// The error of a run that could not compare.
pub fn error(args: CompareArgs) -> String {
    let (status, report) = json(args);
    assert_eq!(status, Status::CouldNotCompare, "{report}");
    assert_eq!(report["status"], 2);
    report["failures"][0]["error"].as_str().unwrap().to_string()
}
