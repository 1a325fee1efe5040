//! The same scene and settings give the same bytes, for any number of threads, in one run or resumed.

use std::path::Path;
use std::process::Command;

use caustica::film::Pixels;
use caustica::render::{Budget, Checkpoint, Head, Sums, render as render_passes};

use crate::support::{Stage, box_camera, lamp, render, scene, settings, sphere, walls};

const BODY_GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";

fn body() -> String {
    [box_camera(20), walls("0.6"), lamp(0.4, "3"), sphere("0,-0.4,0", 0.5, BODY_GLASS)].concat()
}

const MODES: [&[(&str, &str)]; 7] = [
    &[("integrator", "path")],
    &[],
    &[("indirect", "density")],
    &[("indirect", "gather")],
    &[("indirect", "trace")],
    &[("nee", "false"), ("lookup", "nearest"), ("photons", "stored:5000")],
    &[("mode", "classic"), ("photons", "20000"), ("caustic_cap", "30")],
];

fn threads(n: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap()
}

#[test]
fn threads_do_not_change_a_bit() {
    let scene = scene(&body());
    for changes in MODES {
        let one = threads(1).install(|| render(&scene, changes, 4).pixels);
        let three = threads(3).install(|| render(&scene, changes, 4).pixels);
        assert!(one == three, "{changes:?}");
    }
}

fn passes(scene: &Stage, changes: &[(&str, &str)], sums: Sums, until: u32) -> Pixels {
    let settings = settings(scene, changes);
    render_passes(scene.0.task_with(&settings), Budget::passes(until), sums, &mut |_| {}).pixels
}

#[test]
fn a_resumed_render_is_the_whole_render() {
    let scene = scene(&body());
    let fresh = || Sums::none(scene.0.view.film.pixel_count());
    for changes in MODES {
        let whole = passes(&scene, changes, fresh(), 8);
        let first = passes(&scene, changes, fresh(), 4);
        let saved = Checkpoint::encode(&Head { passes: 4, ..Head::default() }, &first);
        let loaded = Checkpoint::decode(&saved).unwrap();
        let sums = Sums { pixels: loaded.pixels, first: 0, passes: loaded.head.passes };
        let resumed = passes(&scene, changes, sums, 8);
        assert!(whole == resumed, "{changes:?}");
    }
}

fn caustica(folder: &Path, arguments: &str) {
    let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_program_writes_the_same_bytes_for_any_threads_and_when_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    std::fs::write(
        folder.path().join("box.xml"),
        format!("<scene version='3.0.0'><integrator type='path'/>{}</scene>", body()),
    )
    .unwrap();
    for mode in ["--integrator photonmap", "--integrator photonmap --mode classic", "--integrator path"] {
        let run = |rest: &str| caustica(folder.path(), &format!("render box.xml --quiet {mode} {rest}"));
        run("--spp 8 --threads 1 -o one.exr");
        run("--spp 8 --threads 2 -o two.exr");
        run("--spp 4 -o half.exr --checkpoint half.checkpoint");
        run("--spp 8 -o resumed.exr --checkpoint half.checkpoint --resume");
        assert!(at("one.exr") == at("two.exr"), "threads, {mode}");
        assert!(at("one.exr") == at("resumed.exr"), "resumed, {mode}");
    }
}
