//! Parts of a render, merged, are the render.

use std::ops::Range;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use caustica::film::{BinnedSums, STRIDE};
use caustica::render::{Budget, Checkpoint, Head};
use caustica::sampling::mix;
use caustica::session::{Error, Merge, Options, Output, Session};

use crate::support::{box_camera, lamp, part, plain, sphere, walls};
use caustica_formats::files::Memory;

const GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";

/// Passes of the whole render.
const PASSES: u32 = 64;

/// A glass sphere in a box, 12 pixels wide, with the settings and layers that are asked for.
fn session(settings: &[(&str, &str)], layers: Option<&str>) -> Session {
    let body = [box_camera(12), walls("0.6"), lamp(0.4, "3"), sphere("0,-0.4,0", 0.5, GLASS)].concat();
    let text = format!("<scene version='3.0.0'>{body}</scene>");
    let files = Memory([("scene.xml".into(), text.into_bytes())].into());
    let own = [("photons", "500"), ("caustic_photons", "500"), ("camera_samples", "1")];
    let settings = own.iter().chain(settings).map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    let layers = layers.map(|list| list.parse().unwrap());
    let options = Options { settings, layers, ..plain() };
    Session::open_in(&files, Path::new("scene.xml"), &options).unwrap_or_else(|e| panic!("{e}"))
}

fn threads<T: Send>(n: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(work)
}

/// `count` ranges that make up all passes, not of one length where that can be.
fn split(count: u32) -> Vec<Range<u32>> {
    let at = |i: u32| match i {
        0 => 0,
        i if i == count => PASSES,
        i => i * PASSES / count + u32::from(count < 10) * (i % 3),
    };
    (0..count).map(|i| at(i)..at(i + 1)).collect()
}

fn exr(picture: &caustica::session::Picture<'_>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("out.exr");
    Output::of(picture.info(), vec![file.clone()]).write(picture).unwrap();
    std::fs::read(file).unwrap()
}

/// One run, and parts on other numbers of threads, some of them stopped and resumed, merged in another order than theirs:
/// the same sums, the same estimate of the error, the same file.
#[test]
fn parts_merged_in_any_order_are_one_run() {
    let path = ("integrator", "path");
    for (settings, layers) in
        [(vec![], None), (vec![path], Some("all")), (vec![("indirect", "gather")], None)]
    {
        let session = session(&settings, layers);
        let whole = threads(1, || session.render(Budget::passes(PASSES), &mut |_| {}));
        let error = whole.pixels.relative_error(PASSES);
        let expected = exr(&session.picture(&whole));
        assert!(error.is_finite() && error > 0.0);
        for count in [1, 2, 7, 64] {
            let mut parts: Vec<(u64, Vec<u8>)> = (0..)
                .zip(split(count))
                .map(|(i, range)| {
                    let stopped = range.len() > 1 && i % 2 == 0;
                    (mix(i + 5), threads(1 + i as usize % 2, || part(&session, range, u32::from(stopped))))
                })
                .collect();
            parts.sort();
            let mut merge = Merge::new();
            for (i, (_, bytes)) in parts.iter().enumerate() {
                merge.add(Path::new(&format!("part {i}")), bytes).unwrap();
            }
            let merged = merge.finish(None, false).unwrap();
            assert_eq!(merged.passes(), PASSES);
            assert_eq!(merged.relative_error().to_bits(), error.to_bits(), "{settings:?}, {count} parts");
            assert!(exr(&merged.picture()) == expected, "{settings:?}, {count} parts");
        }
    }
}

/// Runs the program in `folder`; its status and what it says.
fn caustica(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn done(folder: &Path, arguments: &str) {
    let (status, text) = caustica(folder, &arguments.split_whitespace().collect::<Vec<_>>());
    assert_eq!(status, Some(0), "{arguments}: {text}");
}

fn refused(folder: &Path, status: i32, arguments: &str, words: &[&str]) {
    let (found, text) = caustica(folder, &arguments.split_whitespace().collect::<Vec<_>>());
    assert_eq!(found, Some(status), "{arguments}: {text}");
    words.iter().for_each(|word| assert!(text.contains(word), "{arguments}: `{word}` is not in: {text}"));
}

/// A folder with a scene.
fn place(name: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let body = [box_camera(12), walls("0.6"), lamp(0.4, "3"), sphere("0,-0.4,0", 0.5, GLASS)].concat();
    std::fs::write(folder.path().join(name), format!("<scene version='3.0.0'>{body}</scene>")).unwrap();
    folder
}

/// The program: a range that is ended and resumed, another number of threads, parts of parts, and a render
/// that goes on from what was merged.
#[test]
fn the_program_merges_to_the_bytes_of_one_run() {
    let folder = place("s.xml");
    let folder = folder.path();
    let at = |name: &str| std::fs::read(folder.join(name)).unwrap();
    for integrator in ["path", "photonmap"] {
        let render =
            format!("render s.xml --quiet --photons 500 --integrator {integrator} --layers all --passes");
        done(folder, &format!("{render} 24 -o one.exr --png one.png --exposure 1"));
        done(folder, &format!("{render} 20 -o twenty.exr"));
        std::fs::create_dir(folder.join("p")).unwrap();
        done(folder, &format!("{render} 24 --threads 2 --pass-range 0..9 --checkpoint p/a.ckpt"));
        assert!(!folder.join("s.exr").exists(), "a range alone is no picture");
        let range = format!("{render} 24 --threads 1 --pass-range 9..20 --checkpoint p/b.ckpt --resume");
        stopped(folder, &format!("{render} 24"), [9, 14, 20], "p/b.ckpt");
        let words = ["passes 14..24 of 0..24 are missing (`p/b.ckpt` is unfinished: --resume completes it)"];
        refused(folder, 1, "merge p", &words);
        done(folder, &range);
        done(folder, &format!("{render} 24 --pass-range 20..24 --checkpoint p/c.ckpt -o part.exr"));
        done(folder, "merge p/c.ckpt p/a.ckpt p/b.ckpt -o merged.exr --png merged.png --exposure 1");
        assert!(at("one.exr") == at("merged.exr") && at("one.png") == at("merged.png"), "{integrator}");
        assert!(contains(&at("part.exr"), "20..24"), "the header of a part names its passes");
        // Parts of parts.
        done(folder, "merge p/b.ckpt p/c.ckpt --allow-missing -o late.exr --checkpoint late");
        done(folder, "merge late p/a.ckpt -o again.exr --quiet");
        assert!(at("one.exr") == at("again.exr"), "{integrator}");
        // What is merged is resumed.
        done(folder, "merge p/a.ckpt p/b.ckpt -o early.exr --checkpoint early --passes 20");
        assert!(at("early.exr") == at("twenty.exr"), "{integrator}");
        done(folder, &format!("{render} 24 -o resumed.exr --checkpoint early --resume"));
        assert!(at("one.exr") == at("resumed.exr"), "{integrator}");
        std::fs::remove_dir_all(folder.join("p")).unwrap();
    }
}

fn contains(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|window| window == text.as_bytes())
}

/// Renders the passes `first..end` of a range that goes on to `until`: the checkpoint is that of a render of the range
/// which was ended there.
fn stopped(folder: &Path, render: &str, [first, end, until]: [u32; 3], name: &str) {
    done(folder, &format!("{render} --pass-range {first}..{end} --checkpoint {name}"));
    let file = folder.join(name);
    let Checkpoint { head, pixels } = Checkpoint::read(&file).unwrap();
    assert_eq!(head.until, end);
    std::fs::write(&file, Checkpoint::encode(&Head { until, ..head }, &pixels)).unwrap();
}

#[test]
fn what_does_not_fit_together_is_refused_by_name() {
    let folder = place("s.xml");
    let folder = folder.path();
    let render = |rest: &str| done(folder, &format!("render s.xml --quiet --photons 500 {rest}"));
    render("--passes 8 --pass-range 0..4 --checkpoint a.ckpt");
    render("--passes 8 --pass-range 3..6 --checkpoint b.ckpt");
    render("--passes 8 --pass-range 6..8 --checkpoint c.ckpt");
    let merge = |parts: &str, words: &[&str]| refused(folder, 1, &format!("merge {parts} -o out.exr"), words);
    merge("a.ckpt b.ckpt c.ckpt", &["`a.ckpt` and `b.ckpt` both hold passes 3..4"]);
    merge("a.ckpt a.ckpt", &["both hold passes 0..4"]);
    merge("a.ckpt c.ckpt", &["passes 4..6 of 0..8 are missing; --allow-missing merges what is there"]);
    merge("a.ckpt", &["passes 4..8 of 0..8 are missing"]);
    merge("b.ckpt c.ckpt --passes 10", &["passes 0..3, 8..10 of 0..10 are missing"]);
    refused(
        folder,
        2,
        "merge a.ckpt c.ckpt -o out.exr --passes 7",
        &["`c.ckpt` holds passes 6..8", "to have 7"],
    );
    merge("gone.ckpt", &["cannot merge `gone.ckpt`", "No such file"]);
    merge("s.xml", &["cannot merge `s.xml`: it is not a checkpoint"]);
    assert!(!folder.join("out.exr").exists());

    // Renders that differ.
    for (name, rest, words) in [
        ("seed", "--seed 5", ["seed is `0` and `5`", "parts of different renders"]),
        ("setting", "--set alpha=0.5", ["alpha is", "`0.5`"]),
        ("size", "--size 10x10", ["film is `12×12` and `10×10`", "different renders"]),
        ("layers", "--layers all", ["layer Albedo is", "`absent`"]),
        (
            "less",
            "--layers direct",
            ["layers is `emission,direct,caustic,indirect` and `direct`", "different"],
        ),
        ("rule", "--spectral-to-rgb file", ["spectral-to-rgb is `Mitsuba3` and `File`", "different"]),
    ] {
        render(&format!("--passes 8 --pass-range 4..8 --checkpoint {name} {rest}"));
        merge(&format!("a.ckpt {name}"), &words);
    }
    let scene = std::fs::read_to_string(folder.join("s.xml")).unwrap();
    std::fs::write(folder.join("s.xml"), scene.replace("0.5", "0.52")).unwrap();
    render("--passes 8 --pass-range 4..8 --checkpoint other");
    merge("a.ckpt other", &["scene hash is `"]);
    std::fs::write(folder.join("s.xml"), scene).unwrap();
    let bytes = std::fs::read(folder.join("c.ckpt")).unwrap();
    let Checkpoint { mut head, pixels } = Checkpoint::decode(&bytes).unwrap();
    head.identity.iter_mut().filter(|(name, _)| name == "version").for_each(|(_, v)| "0.0.1".clone_into(v));
    std::fs::write(folder.join("version"), Checkpoint::encode(&head, &pixels)).unwrap();
    merge("a.ckpt version", &["version is `", "and `0.0.1`"]);

    // Damage.
    for (name, damage) in
        [("short", &bytes[..bytes.len() - 9]), ("old", b"caustic3 and more"), ("empty", b"")]
    {
        std::fs::write(folder.join(name), damage).unwrap();
    }
    let mut flipped = bytes.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    std::fs::write(folder.join("flipped"), flipped).unwrap();
    merge("a.ckpt short --allow-missing", &["cannot merge `short`", "damaged"]);
    merge("a.ckpt flipped --allow-missing", &["cannot merge `flipped`", "checksum is wrong"]);
    merge("a.ckpt old", &["cannot merge `old`: it was written by another version of caustica"]);
    merge("a.ckpt empty", &["cannot merge `empty`: it is not a checkpoint"]);
    refused(
        folder,
        1,
        "render s.xml --resume --checkpoint old",
        &["cannot resume from `old`: it was written by another"],
    );

    // What is there, with what is not in the header.
    done(folder, "merge a.ckpt c.ckpt --allow-missing -o some.exr");
    let some = std::fs::read(folder.join("some.exr")).unwrap();
    assert!(contains(&some, "missingPasses") && contains(&some, "4..6"));
    refused(
        folder,
        1,
        "merge a.ckpt c.ckpt --allow-missing -o some.exr --checkpoint all",
        &["4..6 of 0..8 are missing"],
    );
    refused(
        folder,
        2,
        "merge a.ckpt --allow-missing --layers albedo -o out.exr",
        &["without the layer `albedo`"],
    );
    done(folder, "merge a.ckpt --allow-missing --layers variance,direct -o out.exr");
}

#[test]
fn ranges_that_cannot_be_are_refused() {
    let folder = place("s.xml");
    let folder = folder.path();
    for range in ["4..4", "5..4", "4", "a..b", "-1..4", "0..99999999"] {
        refused(
            folder,
            2,
            &format!("render s.xml --pass-range={range} --checkpoint c"),
            &["--pass-range <A..B>"],
        );
    }
    refused(folder, 2, "render s.xml --pass-range 0..4", &["--checkpoint <FILE>"]);
    let beyond = "render s.xml --passes 8 --pass-range 6..9 --checkpoint c";
    refused(folder, 2, beyond, &["invalid value `6..9` for `--pass-range`: the whole render has 8 passes"]);
    done(folder, "render s.xml --quiet --photons 500 --pass-range 2..4 --checkpoint c");
    let resume = "render s.xml --quiet --photons 500 --resume --checkpoint c";
    refused(folder, 1, resume, &["it holds passes 2..4, and those from 0 on were asked for"]);
    refused(
        folder,
        1,
        &format!("{resume} --pass-range 3..9"),
        &["it holds passes 2..4, and 3..9 were asked for"],
    );
    refused(
        folder,
        1,
        &format!("{resume} --pass-range 2..3"),
        &["it holds passes 2..4, and 2..3 were asked for"],
    );
}

/// A pass with fewer light paths than asked for is no part, however little time there is.
#[test]
fn a_range_has_whole_passes_or_none() {
    let session = session(&[("photons", "20000000")], None);
    let budget = Budget { time: Some(Duration::from_millis(20)), ..Budget::default() };
    let outcome = session.render_range(0..4, budget, &mut |_| {});
    assert_eq!((outcome.statistics.passes, outcome.statistics.first_pass_cut), (0, false));
    assert!(matches!(session.part(&outcome), Err(Error::NotWhole)));
}

/// What a checkpoint takes: so many bytes for each sum at most, and one sum of luminance more for each power of two
/// between its passes, which a part of many has few of.
#[test]
fn parts_are_small() {
    let session = session(&[("integrator", "path")], None);
    let pixels = 12 * 12;
    for (range, powers) in [(0..9, 1), (16..24, 0), (15..17, 1), (1..33, 6)] {
        let bytes = part(&session, range.clone(), 0).len();
        let most = 4096 + pixels * BinnedSums::PACKED * (STRIDE + powers);
        assert!(bytes <= most, "{range:?}: {bytes} of {most} bytes");
        println!("{range:?}: {} bytes a pixel", bytes / pixels);
    }
}
