//! The `caustica bench` command: other renderers, bench files, resuming, masks.

use std::path::{Path, PathBuf};
use std::process::Command;

use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use serde_json::Value;

const SIDE: usize = 24;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn caustica(&self, arguments: &[&str], path: &str) -> (i32, String) {
        let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
            .args(arguments)
            .current_dir(self.0.path())
            .env("PATH", path)
            .env("CAUSTICA", env!("CARGO_BIN_EXE_caustica"))
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        (output.status.code().unwrap_or(-1), text + &String::from_utf8_lossy(&output.stderr))
    }

    /// Renders a reference of the scene with our path tracer.
    fn reference(&self, name: &str) {
        let (scene, size) = (scene(), format!("{SIDE}x{SIDE}"));
        let arguments =
            ["--integrator", "path", "--layers", "none", "--filter", "box", "--seed", "77", "--quiet"];
        let all = [&["render", &scene, "--size", &size, "--spp", "256", "-o", name], &arguments[..]].concat();
        let (status, said) = self.caustica(&all, "");
        assert_eq!(status, 0, "{said}");
    }

    /// Makes a script the `pbrt` of the folder `bin`.
    #[cfg(unix)]
    fn pbrt(&self, script: &str) {
        use std::os::unix::fs::PermissionsExt;
        std::fs::create_dir(self.path("bin")).unwrap();
        let stub = self.path("bin/pbrt");
        std::fs::write(&stub, script).unwrap();
        std::fs::set_permissions(&stub, std::fs::Permissions::from_mode(0o755)).unwrap();
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }
}

fn scene() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-diffuse.xml").display().to_string()
}

fn median(row: &Value, point: usize, what: &str) -> f64 {
    row["points"][point][what]["median"].as_f64().unwrap()
}

/// A benchmark in which no render succeeds fails.
#[test]
fn a_bench_without_any_render_fails() {
    let folder = Folder::new();
    folder.reference("reference.exr");
    let broken = folder.path("broken.xml");
    std::fs::write(&broken, "<scene version='3.0.0'><shape type='spher'/></scene>").unwrap();
    let arguments = [
        "bench",
        "broken.xml",
        "--reference",
        "reference.exr",
        "--passes",
        "1",
        "--config",
        "caustica",
        "-o",
        "out",
    ];
    let (status, said) = folder.caustica(&arguments, "");
    assert_eq!(status, 1, "{said}");
    assert!(said.contains("no render of this benchmark succeeded"), "{said}");
}

/// A stand-in for pbrt: it takes pbrt's arguments and renders with our path tracer, so that the picture shows what
/// pbrt was given.
#[cfg(unix)]
const PBRT: &str = r#"#!/bin/sh
while [ $# -gt 1 ]; do
    case $1 in
        --spp) spp=$2; shift 2 ;;
        --outfile) out=$2; shift 2 ;;
        --seed) seed=$2; shift 2 ;;
        --quiet) shift ;;
        *) echo "unknown option $1" >&2; exit 9 ;;
    esac
done
grep -q '^Integrator "path"' "$1" || { echo "another integrator" >&2; exit 8; }
exec "$CAUSTICA" render "$1" --integrator path --spp "$spp" --seed "$seed" --layers none --quiet -o "$out"
"#;

#[cfg(unix)]
#[test]
fn pbrt_is_given_the_scene_in_its_language() {
    let f = Folder::new();
    f.reference("truth.exr");
    f.pbrt(PBRT);
    let scene = scene();
    let configs = ["--config", "caustica:path", "pbrt:path", "--passes", "4,16", "--seeds", "1"];
    let arguments = [&["bench", &scene, "--reference", "truth.exr", "-o", "out"], &configs[..]].concat();

    let (status, said) = f.caustica(&arguments, "/usr/bin:/bin");
    assert_eq!(status, 0, "{said}");
    assert!(said.contains("skipped pbrt:path: there is no `pbrt` on PATH: build "), "{said}");
    let rows = &f.json("out/bench.json")["scenes"][0]["rows"];
    assert_eq!(rows.as_array().unwrap().len(), 1);

    let path = format!("{}:/usr/bin:/bin", f.path("bin").display());
    let (status, said) = f.caustica(&arguments, &path);
    assert_eq!(status, 0, "{said}");
    let rows = &f.json("out/bench.json")["scenes"][0]["rows"];
    let (ours, theirs) = (&rows[0], &rows[1]);
    assert_eq!(theirs["config"], "pbrt:path", "{said}");
    assert_eq!(median(theirs, 1, "passes"), 16.0);
    // The same integrator and sampler: the errors differ only because of the seeds, which over 1728 values makes a
    // few percent.
    let ratio = median(theirs, 1, "rmse") / median(ours, 1, "rmse");
    assert!((0.75..1.33).contains(&ratio), "{ratio}");
    assert!(median(theirs, 1, "bias").abs() < 0.03);
    let reach = &f.json("out/bench.json")["scenes"][0]["reach"][0];
    assert_eq!(reach["config"], "pbrt:path");
    let error = |i: usize| reach["reached"][i]["error"].as_f64().unwrap();
    assert_eq!(error(1), median(theirs, 1, "relmse"));
    assert_eq!(error(2), median(theirs, 1, "flip"));
    let table = std::fs::read_to_string(f.path("out/bench.md")).unwrap();
    assert!(table.contains("| cornell-diffuse | caustica:path | pbrt:path | "), "{table}");
    let page = std::fs::read_to_string(f.path("out/bench.html")).unwrap();
    assert!(page.contains("<td>cornell-diffuse</td><td>caustica:path</td><td>pbrt:path</td>"), "{page}");
}

/// A stand-in for a pbrt that never ends with more than four samples, together with a process that it has started.
#[cfg(unix)]
const ENDLESS: &str = r#"#!/bin/sh
grep -q '"integer maxdepth" 100$' "$8" || { echo "another depth" >&2; exit 8; }
[ "$3" -gt 4 ] && { sleep 1000 & wait; }
exec "$CAUSTICA" render "$8" --integrator path --spp "$3" --quiet --layers none -o "$7"
"#;

/// A render that takes too long is stopped and reported where its point would be; paths are followed as long as the
/// scene asks for, but not for ever.
#[cfg(unix)]
#[test]
fn endless_renders_are_stopped() {
    let f = Folder::new();
    f.reference("truth.exr");
    f.pbrt(ENDLESS);
    let scene = scene();
    let configs = ["--config", "pbrt:path", "--passes", "4,16,32", "--seeds", "1", "--limit", "10"];
    let depth = ["--max-depth", "-1"];
    let arguments =
        [&["bench", &scene, "--reference", "truth.exr", "-o", "out"], &configs[..], &depth].concat();
    let (status, said) = f.caustica(&arguments, &format!("{}:/usr/bin:/bin", f.path("bin").display()));
    assert_eq!(status, 0, "{said}");
    assert!(said.contains("note: pbrt follows paths for 100 bounces at most"), "{said}");
    let row = &f.json("out/bench.json")["scenes"][0]["rows"][0];
    assert_eq!(row["points"].as_array().unwrap().len(), 1, "{row}");
    // A larger budget is not tried.
    assert_eq!(row["stopped"], serde_json::json!([{ "budget": { "passes": 16 }, "seconds": 10.0 }]));
    assert!(said.contains("16 passes   stopped after 10 s"), "{said}");
    let page = std::fs::read_to_string(f.path("out/bench.html")).unwrap();
    // In the table, and in the legend of every plot.
    assert_eq!(page.matches("pbrt:path (16 passes: stopped after 10 s)").count(), 5, "{page}");
}

/// A stand-in for a pbrt whose samples take 5 ticks (50 ms) of CPU time each, beside 10 for loading.
#[cfg(target_os = "linux")]
const BURNER: &str = r#"#!/bin/sh
spp=$3 out=$7
while read -r line < /proc/self/stat; set -- $line; [ $((${14} + ${15})) -lt $((10 + 5 * spp)) ]; do :; done
cp truth.exr "$out"
"#;

/// The number of passes is chosen so that the CPU time without loading is near the budget; budgets that are too short
/// for a second pass are one point.
#[cfg(target_os = "linux")]
#[test]
fn budgets_are_cpu_seconds() {
    let f = Folder::new();
    f.reference("truth.exr");
    f.pbrt(BURNER);
    let scene = scene();
    let configs = ["--config", "pbrt:path", "--budgets", "0.01,0.02,0.5", "--seeds", "2"];
    let arguments = [&["bench", &scene, "--reference", "truth.exr", "-o", "out"], &configs[..]].concat();
    let (status, said) = f.caustica(&arguments, &format!("{}:/usr/bin:/bin", f.path("bin").display()));
    assert_eq!(status, 0, "{said}");
    let row = &f.json("out/bench.json")["scenes"][0]["rows"][0];
    let points = row["points"].as_array().unwrap();
    assert_eq!(points.len(), 2, "{said}");
    assert_eq!((median(row, 0, "passes"), points[0]["seeds"].as_u64()), (1.0, Some(2)));
    // Ten samples make half a second. The trials are of one, two and four samples, whose times are off by a tick or
    // two, as is that of loading: 10 to 15 ticks for three samples.
    let (passes, cpu) = (median(row, 1, "passes"), median(row, 1, "cpu_seconds"));
    assert!((7.0..=16.0).contains(&passes), "{said}");
    assert!((cpu - 0.05 * passes).abs() < 0.1, "{said}");
    assert!(said.contains("pbrt:path 0.5 CPU s seed 1: "), "{said}");
}

/// Every scene and reference of the repository's own benchmark is there.
#[test]
fn the_bench_file_of_the_repository_renders() {
    let f = Folder::new();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/bench.json").display().to_string();
    let arguments =
        ["bench", &file, "--config", "caustica:path", "--passes", "1", "--seeds", "1", "-o", "out"];
    let (status, said) = f.caustica(&arguments, "");
    assert_eq!(status, 0, "{said}");
    let scenes = f.json("out/bench.json")["scenes"].as_array().unwrap().clone();
    assert!(scenes.len() >= 6 && scenes.iter().all(|s| s["rows"][0]["points"][0]["seeds"] == 1), "{said}");
    let glass = scenes.iter().find(|s| s["scene"] == "cornell-glass").unwrap();
    // As reference/cornell-glass.toml says, which has it from the samples themselves.
    let noise = glass["noise"]["rmse"].as_f64().unwrap();
    assert!((noise / 0.007_638_31 - 1.0).abs() < 0.01, "{noise}");
    let row = &glass["rows"][0];
    // One thread; two ticks of a hundredth of a second for rounding, and as much between the two clocks' ends.
    assert!(median(row, 0, "cpu_seconds") <= median(row, 0, "seconds") + 0.04, "{row}");
}

#[test]
fn an_interrupted_bench_resumes() {
    let f = Folder::new();
    f.reference("truth.exr");
    let file = format!(
        r#"{{"scenes": [{:?}], "references": ["truth.exr"], "configs": ["caustica:path"], "passes": [1, 2],
            "seeds": 2, "output": "out"}}"#,
        scene()
    );
    std::fs::write(f.path("bench.json"), file).unwrap();
    let (status, said) = f.caustica(&["bench", "bench.json"], "");
    assert_eq!(status, 0, "{said}");
    let log = f.path("out/points.jsonl");
    let whole = std::fs::read_to_string(&log).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    assert_eq!(lines.len(), 4);
    let csv = std::fs::read_to_string(f.path("out/bench.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5, "{csv}");

    // As if killed while writing its third line.
    let cut = format!("{}\n{}\n{}", lines[0], lines[1], &lines[2][..lines[2].len() / 2]);
    std::fs::write(&log, &cut).unwrap();
    let (status, said) = f.caustica(&["bench", "bench.json"], "");
    assert_eq!(status, 0, "{said}");
    assert_eq!(said.matches("seed 1: ").count(), 2, "{said}");
    assert!(!said.contains("seed 0: "), "{said}");
    let resumed = std::fs::read_to_string(&log).unwrap();
    assert!(resumed.starts_with(&cut) && resumed.lines().count() == 5);
    let points = f.json("out/bench.json")["scenes"][0]["rows"][0]["points"].clone();
    assert!(points.as_array().unwrap().iter().all(|p| p["seeds"] == 2), "{points}");
    let (_, said) = f.caustica(&["bench", "bench.json"], "");
    assert!(!said.contains(" seed "), "nothing was left to render: {said}");
    let page = std::fs::read_to_string(f.path("out/bench.html")).unwrap();
    assert!(
        page.contains("Machine: ") && page.contains("<svg"),
        "the page names the machine and plots the times"
    );
}

/// Folder in /proc of a process that `parent` has started.
#[cfg(target_os = "linux")]
fn child_of(parent: u32) -> Option<PathBuf> {
    let is_child = |folder: &PathBuf| {
        let stat = std::fs::read_to_string(folder.join("stat")).unwrap_or_default();
        let after_name = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
        after_name.split_whitespace().nth(1) == Some(&parent.to_string())
    };
    std::fs::read_dir("/proc").ok()?.filter_map(|entry| Some(entry.ok()?.path())).find(is_child)
}

/// Ctrl-C stops the render that is running too, so that the same command can go on at once. Results from before stay.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_stops_the_render_and_keeps_what_is_there() {
    let f = Folder::new();
    f.reference("truth.exr");
    std::fs::create_dir(f.path("out")).unwrap();
    std::fs::write(f.path("out/bench.html"), "earlier").unwrap();
    let child = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(["bench", &scene(), "--reference", "truth.exr", "--config", "caustica:path"])
        // A render of hours.
        .args(["--passes", "100000000", "--seeds", "1", "-o", "out"])
        .current_dir(f.0.path())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let render = loop {
        if let Some(render) = child_of(child.id()) {
            break render;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    };
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("the same command goes on"), "{said}");
    assert!(!render.exists(), "the render goes on");
    assert_eq!(std::fs::read_to_string(f.path("out/bench.html")).unwrap(), "earlier");
}

#[test]
fn pixels_outside_the_mask_do_not_count() {
    let f = Folder::new();
    f.reference("whole.exr");
    let truth = caustica_tools::compare::load(&f.path("whole.exr"), None).unwrap().pixels;
    let left = |i: usize| i % SIDE < SIDE / 2;
    let write = |name: &str, value: &dyn Fn(usize) -> [f32; 3]| {
        let data: Vec<f32> = (0..SIDE * SIDE).flat_map(value).collect();
        let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &data };
        write_exr(f.path(name), SIDE, SIDE, &[layer], &[], ExrOptions::default()).unwrap();
    };
    // The left half of the reference is missing.
    write("half.exr", &|i| if left(i) { [0.0; 3] } else { truth.rgb[i] });
    let scene = scene();
    let bias = |output: &str| {
        let configs = ["--config", "caustica:path", "--passes", "64", "--seeds", "1", "-o", output];
        let arguments = [&["bench", &scene, "--reference", "half.exr"], &configs[..]].concat();
        let (status, said) = f.caustica(&arguments, "");
        assert_eq!(status, 0, "{said}");
        let result = f.json(&format!("{output}/bench.json"))["scenes"][0].clone();
        (median(&result["rows"][0], 0, "bias"), result["left_out"].as_u64().unwrap())
    };
    let (without, none) = bias("without");
    assert!(without > 0.5 && none == 0, "{without}");
    write("half.mask.exr", &|i| if left(i) { [0.0; 3] } else { [1.0; 3] });
    let (with, left_out) = bias("with");
    assert!(with.abs() < 0.02 && left_out == (SIDE * SIDE / 2) as u64, "{with}");
}
