//! Converts scenes to both languages and back, and counts which survive.
//!
//! ```text
//! cargo run --release --example round_trips -- [--keep FOLDER] [--verbose] SCENE_OR_LIST...
//! ```
//!
//! An argument that ends in `.txt` is a list of scenes, one a line. Meshes and pictures that are missing are replaced
//! by small ones. Each scene is written in its own language and read again, and written in the other, read, written
//! back and forth once more. All that is written has to be read without a warning and to be accepted by the renderer
//! where its source was. Two scenes of one language are equal when nothing differs but names and how meshes and
//! pictures are kept. What differs although no loss was listed is counted by its place in the scene.
//!
//! `--keep` leaves each scene that became Mitsuba's in a folder of its own, for `tools/converted/load.py`.

// The counts are its output.
#![allow(clippy::print_stdout)]

mod same;
mod stand_in;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica::session::{Options, Session};
use caustica_formats::files::{Files, Memory};
use caustica_formats::{Content, Loss, Read, ReadOptions, Written, read_scene, write_scene};
use rayon::prelude::*;

use same::{differences, plain};
use stand_in::StandIns;

/// What became of one trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    Equal,
    Listed,
    Different,
    /// The result is refused, or read with a warning.
    Refused,
}

#[derive(Default)]
struct Report {
    unread: bool,
    /// By trip: the verdict, and what it is about.
    trips: Vec<(&'static str, Verdict, Vec<String>)>,
}

struct Copy {
    read: Read,
    files: Memory,
    losses: Vec<Loss>,
}

fn main() {
    let mut keep = None;
    let mut verbose = false;
    let mut scenes = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--keep" => keep = arguments.next().map(PathBuf::from),
            "--verbose" => verbose = true,
            list if list.ends_with(".txt") => {
                let text = std::fs::read_to_string(list).unwrap_or_default();
                scenes.extend(text.lines().map(PathBuf::from));
            }
            scene => scenes.push(PathBuf::from(scene)),
        }
    }
    let report = |(i, scene): (usize, &PathBuf)| {
        let kept = keep.as_ref().map(|folder| folder.join(format!("{i:04}")));
        let made = std::panic::catch_unwind(|| trips(scene, kept.as_deref()));
        made.unwrap_or_else(|_| Report {
            trips: vec![("all", Verdict::Refused, vec!["PANIC".to_owned()])],
            ..Report::default()
        })
    };
    let reports: Vec<Report> = scenes.par_iter().enumerate().map(report).collect();
    print(&scenes, &reports, verbose);
}

fn print(scenes: &[PathBuf], reports: &[Report], verbose: bool) {
    let mut counts: BTreeMap<(&str, Verdict), usize> = BTreeMap::new();
    let mut kinds: BTreeMap<(&str, Verdict, &str), (usize, &Path)> = BTreeMap::new();
    for (scene, report) in scenes.iter().zip(reports) {
        for (trip, verdict, about) in &report.trips {
            *counts.entry((trip, *verdict)).or_default() += 1;
            let mut about: Vec<&str> = about.iter().map(String::as_str).collect();
            about.sort_unstable();
            about.dedup();
            for kind in about {
                kinds.entry((trip, *verdict, kind)).or_insert((0, scene)).0 += 1;
                if verbose {
                    println!("{trip} | {verdict:?} | {kind} | {}", scene.display());
                }
            }
        }
    }
    let unread = reports.iter().filter(|report| report.unread).count();
    println!("{} scenes, {unread} of them not read", scenes.len());
    for ((trip, verdict), count) in counts {
        println!("{trip:24} {verdict:?}: {count}");
    }
    let mut kinds: Vec<_> = kinds.into_iter().collect();
    kinds.sort_by_key(|(_, (count, _))| std::cmp::Reverse(*count));
    for ((trip, verdict, kind), (count, scene)) in kinds {
        println!("{count:4} {trip}, {verdict:?}: {kind}  e.g. {}", scene.display());
    }
}

fn trips(path: &Path, keep: Option<&Path>) -> Report {
    let mut report = Report::default();
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    let Ok(read) = read_scene(&StandIns, path, &options) else {
        report.unread = true;
        return report;
    };
    let own = if path.extension().is_some_and(|e| e == "xml") { "xml" } else { "pbrt" };
    let other = if own == "xml" { "pbrt" } else { "xml" };
    let sound = accepted(&read, &StandIns, path).is_ok();
    if let Some(folder) = keep {
        let target = folder.join("made.xml");
        let saved = std::fs::create_dir_all(folder).is_ok()
            && write_scene(&read, &StandIns, &target).is_ok_and(|w| w.save(&StandIns, true).is_ok());
        if !saved {
            report.trips.push(("kept", Verdict::Refused, vec!["not written".to_owned()]));
        }
    }
    let before = plain(&read.scene, &StandIns);
    if let Some(copy) = trip(&mut report, "own", &read, &StandIns, own, sound) {
        let losses = copy.losses.len();
        report.compare("own", &before, &plain(&copy.read.scene, &copy.files), losses);
    }
    let Some(there) = trip(&mut report, "other", &read, &StandIns, other, sound) else { return report };
    let Some(back) = trip(&mut report, "back", &there.read, &there.files, own, sound) else { return report };
    let Some(again) = trip(&mut report, "again", &back.read, &back.files, other, sound) else {
        return report;
    };
    let losses = back.losses.len() + again.losses.len();
    let first = plain(&there.read.scene, &there.files);
    report.compare("other, back and other", &first, &plain(&again.read.scene, &again.files), losses);
    report
}

impl Report {
    fn compare(&mut self, trip: &'static str, a: &serde_json::Value, b: &serde_json::Value, losses: usize) {
        let mut found = Vec::new();
        // Matrices are inverted and composed on the way.
        differences(a, b, "scene", 1e-6, &mut found);
        let verdict = match (found.is_empty(), losses) {
            (true, _) => Verdict::Equal,
            (false, 0) => Verdict::Different,
            (false, _) => Verdict::Listed,
        };
        self.trips.push((trip, verdict, found));
    }
}

/// Written in the language of `extension` and read again; `None` after a refusal.
fn trip(
    report: &mut Report,
    name: &'static str,
    read: &Read,
    files: &dyn Files,
    extension: &str,
    sound: bool,
) -> Option<Copy> {
    let mut refuse = |why: String| {
        report.trips.push((name, Verdict::Refused, vec![why]));
        None
    };
    let path = PathBuf::from(format!("/written/{name}/made.{extension}"));
    let written = match write_scene(read, files, &path) {
        Ok(written) => written,
        Err(e) => return refuse(format!("not written: {e}")),
    };
    let beside = beside(&written, files);
    let copy = match read_scene(&beside, &path, &ReadOptions::default()) {
        Ok(copy) => copy,
        Err(failure) => return refuse(failure.diagnostics[0].message.clone()),
    };
    // That there is no light is said by one reader only; a light that was left out is listed.
    let known = |message: &str| {
        message.starts_with("the scene has no light") || read.warnings.iter().any(|w| w.message == message)
    };
    if let Some(warning) = copy.warnings.iter().find(|warning| !known(&warning.message)) {
        return refuse(format!("warning: {}", warning.message));
    }
    if sound && let Err(problem) = accepted(&copy, &beside, &path) {
        return refuse(format!("renderer: {problem}"));
    }
    Some(Copy { read: copy, files: beside, losses: written.losses })
}

fn beside(written: &Written, files: &dyn Files) -> Memory {
    let folder = written.path.parent().unwrap_or(Path::new(""));
    let mut beside = BTreeMap::from([(written.path.clone(), written.text.clone().into_bytes())]);
    for asset in &written.assets {
        let bytes = match &asset.content {
            Content::Bytes(bytes) => bytes.clone(),
            Content::Copy(path) => files.read(path).unwrap_or_default(),
        };
        beside.insert(folder.join(&asset.path), bytes);
    }
    Memory(beside)
}

/// Whether the renderer takes the scene; the first line of what it says otherwise.
fn accepted(read: &Read, files: &dyn Files, path: &Path) -> Result<(), String> {
    let options = Options { longest_side: Some(16), spectrum_rule: None, ..Options::default() };
    match Session::of(read.scene.clone(), files, path, &options) {
        Ok(_) => Ok(()),
        Err(e) => Err(e.to_string().lines().next().unwrap_or_default().to_owned()),
    }
}
