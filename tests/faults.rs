//! What signals, kills, full places and other processes do to a render: outcomes of the program itself.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use caustica_formats::image;

const SCENE: &str = "scenes/cornell-glass.xml";

fn program(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
    command.current_dir(env!("CARGO_MANIFEST_DIR")).args(args).stdin(Stdio::null());
    command
}

fn render(output: &Path, more: &[&str]) -> Command {
    let output = output.to_str().expect("a path in UTF-8");
    let mut command = program(&["render", SCENE, "--quiet", "-o", output]);
    if !more.contains(&"--size") {
        command.args(["--size", "48x48"]);
    }
    command.args(more);
    command
}

fn done(command: &mut Command) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = command.output().expect("the program starts");
    (status.code(), String::from_utf8_lossy(&stderr).into_owned())
}

fn spawned(command: &mut Command) -> Child {
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([&format!("-{name}"), &child.id().to_string()]).status();
    assert!(status.expect("kill starts").success());
}

fn wait_for(path: &Path) {
    let begun = Instant::now();
    while !path.exists() {
        assert!(begun.elapsed() < Duration::from_secs(120), "{} never came", path.display());
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn place() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("out.exr");
    (folder, output)
}

fn pixels(path: &Path) -> Vec<f32> {
    let bytes = std::fs::read(path).expect("readable");
    image::read(&bytes).expect("a whole picture").data
}

#[test]
fn signals_leave_a_valid_picture_and_the_status_that_shells_expect() {
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let (_folder, output) = place();
        let checkpoint = output.with_extension("checkpoint");
        let checkpoint = checkpoint.to_str().expect("a path in UTF-8");
        let mut child = spawned(&mut render(&output, &["--passes", "1000000", "--checkpoint", checkpoint]));
        wait_for(Path::new(checkpoint));
        // Twice at once, as `timeout` does: the process, then its group.
        signal(&child, name);
        signal(&child, name);
        assert_eq!(child.wait().expect("waited").code(), Some(status), "after SIG{name}");
        let finite = pixels(&output).iter().all(|v| v.is_finite());
        assert!(finite, "a picture of finite numbers after SIG{name}");
    }
}

/// A render that is killed and resumed at any moment ends with the picture of one that was left alone.
#[test]
fn killed_renders_resume_to_the_same_bytes() {
    let (folder, whole) = place();
    assert_eq!(done(&mut render(&whole, &["--passes", "300"])).0, Some(0));
    let expected = std::fs::read(&whole).expect("written");
    let output = folder.path().join("killed.exr");
    // One render, killed again and again after delays that cover loading, passes and writing.
    let mut kills = 0;
    for attempt in 0_u64.. {
        assert!(attempt < 400, "the render never ended");
        let mut child = spawned(&mut render(&output, &["--passes", "300", "--resume"]));
        std::thread::sleep(Duration::from_millis(20 + attempt * 37 % 300 + attempt * 20));
        signal_if_running(&mut child, &mut kills);
        if child.wait().expect("waited").success() {
            break;
        }
        if output.exists() {
            assert!(!pixels(&output).is_empty());
        }
    }
    assert!(kills >= 3, "killed {kills} times only");
    assert!(std::fs::read(&output).expect("written") == expected, "after {kills} kills");
}

fn signal_if_running(child: &mut Child, kills: &mut u32) {
    if child.try_wait().expect("asked").is_none() && child.kill().is_ok() {
        *kills += 1;
    }
}

#[test]
fn checkpoints_of_other_renders_are_refused_by_name() {
    let (_folder, output) = place();
    let begin = |more: &[&str]| done(render(&output, &["--passes", "2", "--resume"]).args(more));
    assert_eq!(begin(&[]).0, Some(0));
    for (change, named) in
        [(["--seed", "7"], "seed"), (["--filter", "mitchell"], "filter"), (["--max-depth", "3"], "max_depth")]
    {
        let (status, text) = begin(&change);
        assert_eq!(status, Some(1), "{change:?}: {text}");
        assert!(text.contains("cannot resume") && text.contains(named), "{text}");
    }
    let checkpoint = output.with_extension("checkpoint");
    let bytes = std::fs::read(&checkpoint).expect("written");
    std::fs::write(&checkpoint, &bytes[..bytes.len() / 2]).expect("writable");
    let (status, text) = begin(&[]);
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("cannot resume"), "{text}");
}

#[test]
fn places_that_cannot_be_written_are_found_before_rendering() {
    let (folder, output) = place();
    let missing = folder.path().join("no/such/out.exr");
    let directory = folder.path().join("dir.exr");
    std::fs::create_dir(&directory).expect("creatable");
    for bad in [&missing, &directory, &PathBuf::from("/proc/out.exr")] {
        // A number of passes that would take hours: the error comes before them.
        let (status, text) = done(&mut render(bad, &["--passes", "1000000"]));
        assert_eq!(status, Some(1), "{text}");
        assert!(text.contains("cannot write") && text.contains(bad.to_str().expect("UTF-8")), "{text}");
    }
    let stats = missing.to_str().expect("UTF-8");
    let (status, text) = done(&mut render(&output, &["--passes", "1000000", "--stats", stats]));
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("cannot write"), "{text}");
}

/// The folder goes away while the render runs: the picture is kept, its place is told.
#[test]
fn a_picture_that_cannot_be_written_is_kept_elsewhere() {
    let (folder, _) = place();
    let gone = folder.path().join("gone");
    let elsewhere = folder.path().join("elsewhere");
    for f in [&gone, &elsewhere] {
        std::fs::create_dir(f).expect("creatable");
    }
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join(SCENE);
    let output = gone.join("out.png");
    let checkpoint = elsewhere.join("c");
    let mut command = program(&["render", scene.to_str().expect("UTF-8"), "--size", "32x32", "--quiet"]);
    command.current_dir(&elsewhere).env("TMPDIR", &elsewhere).args(["--passes", "1000000", "-o"]);
    command.arg(&output).arg("--checkpoint").arg(&checkpoint).stderr(Stdio::piped());
    let child = command.spawn().expect("the program starts");
    wait_for(&checkpoint);
    std::fs::remove_dir_all(&gone).expect("removable");
    signal(&child, "TERM");
    let ended = child.wait_with_output().expect("waited");
    let text = String::from_utf8_lossy(&ended.stderr);
    assert!(!ended.status.success(), "{text}");
    let kept = std::fs::read_dir(&elsewhere).expect("readable").flatten();
    let kept: Vec<_> = kept.filter(|f| f.path().extension().is_some_and(|e| e == "png")).collect();
    assert_eq!(kept.len(), 1, "{text}");
    assert!(text.contains(&*kept[0].file_name().to_string_lossy()), "{text}");
    assert!(!pixels(&kept[0].path()).is_empty());
}

#[test]
fn two_processes_do_not_write_one_output() {
    let (_folder, output) = place();
    let checkpoint = output.with_extension("checkpoint");
    let name = checkpoint.to_str().expect("UTF-8");
    let mut first = spawned(&mut render(&output, &["--passes", "1000000", "--checkpoint", name]));
    wait_for(&checkpoint);
    let (status, text) = done(&mut render(&output, &["--passes", "1"]));
    signal(&first, "TERM");
    assert_eq!(first.wait().expect("waited").code(), Some(143));
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("another process is writing"), "{text}");
    // The lock went with the process.
    assert_eq!(done(&mut render(&output, &["--passes", "1"])).0, Some(0));
}

#[test]
fn what_memory_cannot_hold_is_refused_with_the_setting() {
    let (_folder, output) = place();
    for (setting, value, named) in [
        ("--size", "30000x30000", "30000 × 30000 pixels (--size, --crop) needs about"),
        ("--photons", "1000000000000", "setting `photons` = 1000000000000 needs about"),
    ] {
        let (status, text) = done(&mut render(&output, &[setting, value]));
        assert_eq!(status, Some(1), "{text}");
        assert!(text.contains(named), "{text}");
    }
}

/// Light paths of a first pass that takes seconds, and the memory for them.
const MANY: &str = "10000000";

#[test]
fn an_interrupt_in_the_first_pass_leaves_older_pictures_alone() {
    let (folder, output) = place();
    let lock = folder.path().join(".out.exr.lock");
    for (older, name, status) in [(true, "INT", 130), (true, "TERM", 143), (false, "INT", 130)] {
        let _absent = std::fs::remove_file(&output);
        if older {
            std::fs::write(&output, "older").expect("writable");
        }
        let mut child = render(&output, &["--photons", MANY, "--passes", "2"])
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        wait_for(&lock);
        // Signals are watched right after the lock; the pass takes far longer.
        std::thread::sleep(Duration::from_millis(200));
        signal(&child, name);
        let begun = Instant::now();
        assert_eq!(child.wait().expect("waited").code(), Some(status));
        let waited = begun.elapsed();
        assert!(
            waited < Duration::from_secs(3),
            "it took {waited:?} on a busy machine; 0.1 s on an idle one"
        );
        if older {
            assert_eq!(std::fs::read(&output).expect("there"), b"older");
            let mut said = String::new();
            std::io::Read::read_to_string(&mut child.stderr.take().expect("piped"), &mut said)
                .expect("UTF-8");
            assert!(said.contains("nothing was written to") && said.contains("out.exr"), "{said}");
        } else {
            assert!(pixels(&output).iter().all(|v| v.is_finite()));
        }
        assert!(!output.with_extension("checkpoint").exists());
    }
}

/// A first pass that is longer than the time is made of fewer light paths, which carry all the power:
/// the picture is as bright as it should be, and nothing may be added to it.
#[test]
fn time_holds_in_the_first_pass_too() {
    let (folder, output) = place();
    let stats = folder.path().join("stats.json");
    let (_, checkpoint) = (stats.to_str().expect("UTF-8"), output.with_extension("checkpoint"));
    let names = [stats.to_str().expect("UTF-8"), checkpoint.to_str().expect("UTF-8")];
    let args = ["--photons", MANY, "--time", "0.3", "--stats", names[0], "--checkpoint", names[1]];
    let (status, text) = done(&mut render(&output, &args));
    assert_eq!(status, Some(0), "{text}");
    let said: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&stats).expect("written")).expect("JSON");
    let said = &said["render"];
    assert_eq!((&said["passes"], &said["first_pass_cut"]), (&1.into(), &true.into()), "{said}");
    assert!(!checkpoint.exists());
    let whole = folder.path().join("whole.exr");
    assert_eq!(done(&mut render(&whole, &["--photons", "200000", "--passes", "1"])).0, Some(0));
    let mean = |path: &Path| {
        let picture = image::read(&std::fs::read(path).expect("readable")).expect("a whole picture");
        let channels = picture.channels.len();
        let rgb = picture.rgb().expect("a picture");
        let sum: f64 = picture.data.chunks(channels).map(|p| f64::from(p[rgb[1]])).sum();
        sum / (picture.width * picture.height) as f64
    };
    // The same camera rays and lamp samples; only photons differ, 65 536 or more of them on 2304
    // pixels: their share of the mean has a relative deviation of about 1/√65536.
    let ratio = mean(&output) / mean(&whole);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

/// A scene, a mesh of it, and two outputs in one file: nothing is lost by a slip of the hand.
#[test]
fn outputs_spare_the_scene_and_each_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let mesh = "<shape type='obj'><string name='filename' value='m.obj'/></shape>";
    let text = format!("<scene version='3.0.0'><sensor type='perspective'/>{mesh}</scene>");
    std::fs::write(at("s.xml"), text).expect("writable");
    std::fs::write(at("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("writable");
    std::os::unix::fs::symlink(at("s.xml"), at("link")).expect("linkable");
    let files = || ["s.xml", "m.obj"].map(|name| std::fs::read(at(name)).expect("readable"));
    let before = files();
    let out = at("out.exr");
    let twice = folder.path().join(".").join("out.exr");
    let twice = twice.to_str().expect("UTF-8");
    for (option, target, told) in [
        ("--checkpoint", at("s.xml"), "the scene was read from it"),
        ("--checkpoint", at("link"), "the scene was read from it"),
        ("--stats", at("m.obj"), "the scene was read from it"),
        ("--stats", twice.to_owned(), "is named for two outputs"),
        ("--checkpoint", out.clone(), "is named for two outputs"),
    ] {
        let args = ["render", &at("s.xml"), "--size", "8x8", "--passes", "1", "-o", &out, option, &target];
        let (status, text) = done(&mut program(&args));
        assert_eq!(status, Some(2), "{option} {target}: {text}");
        assert!(text.contains(told), "{text}");
        assert!(!Path::new(&out).exists());
    }
    let converted = ["convert", &at("s.xml"), &at("c.pbrt"), "--report", &at("link")];
    assert_eq!(done(&mut program(&converted)).0, Some(1));
    assert_eq!(
        done(&mut program(&["convert", &at("s.xml"), &at("link.xml"), "--report", &at("m.obj")])).0,
        Some(1)
    );
    assert!(files() == before);
    // The same picture named twice is written once.
    let args = ["render", &at("s.xml"), "--size", "8x8", "--passes", "1", "-o", &at("p.png"), "--png"];
    let (status, text) = done(&mut program(&args));
    assert_eq!(status, Some(0), "{text}");
}

/// While the scene is loaded there is nothing to write; the status is the one of later.
#[test]
fn signals_while_loading_have_the_status_that_shells_expect() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scene = folder.path().join("s.xml");
    // Seconds of loading.
    let sphere = "<shape type='sphere'><point name='center' x='1'/></shape>";
    let text =
        format!("<scene version='3.0.0'><sensor type='perspective'/>{}</scene>", sphere.repeat(400_000));
    std::fs::write(&scene, text).expect("writable");
    for (name, status) in [("INT", 130), ("TERM", 143)] {
        let output = folder.path().join("out.exr");
        let args = ["render", scene.to_str().expect("UTF-8"), "-o", output.to_str().expect("UTF-8")];
        let mut child = spawned(&mut program(&args));
        std::thread::sleep(Duration::from_millis(200));
        signal(&child, name);
        assert_eq!(child.wait().expect("waited").code(), Some(status), "after SIG{name}");
        assert!(!output.exists());
    }
}

/// `| head`: a reader that has seen enough is no error.
#[test]
fn a_closed_pipe_is_no_error() {
    let exe = env!("CARGO_BIN_EXE_caustica");
    for args in ["render --help-settings", "inspect --json scenes/cornell-glass.xml", "--help"] {
        let mut shell = Command::new("sh");
        shell.current_dir(env!("CARGO_MANIFEST_DIR"));
        let line = format!("(sleep 0.2; '{exe}' {args}; echo status $? >&2) | true");
        let (_, text) = done(shell.arg("-c").arg(line));
        assert_eq!(text, "status 0\n", "{args}");
    }
}

/// What cannot be written is said, and leaves nothing broken behind.
#[test]
fn compare_says_what_it_cannot_write() {
    let (folder, output) = place();
    assert_eq!(done(&mut render(&output, &["--passes", "1", "--size", "8x8"])).0, Some(0));
    let picture = output.to_str().expect("UTF-8");
    let missing = folder.path().join("no/such/file");
    for option in ["--json", "--html"] {
        let ended = program(&["compare", picture, picture, &format!("{option}={}", missing.display())]);
        let Output { status, stdout, .. } = { ended }.output().expect("the program starts");
        let text = String::from_utf8_lossy(&stdout).into_owned();
        assert_eq!(status.code(), Some(2), "{text}");
        assert!(text.contains("no/such/file"), "{text}");
    }
}

/// An address space of a few hundred megabytes (`ulimit -v`): an error, not the end by the allocator.
#[test]
fn limits_of_the_process_count_as_its_memory() {
    let (_folder, output) = place();
    let render = render(&output, &["--passes", "1", "--size", "8000x8000"]);
    let quoted = |s: &std::ffi::OsStr| format!("'{}'", s.to_string_lossy());
    let line: Vec<String> = [render.get_program()].into_iter().chain(render.get_args()).map(quoted).collect();
    let mut shell = Command::new("sh");
    shell.current_dir(env!("CARGO_MANIFEST_DIR"));
    let (status, text) = done(shell.arg("-c").arg(format!("ulimit -v 2000000; exec {}", line.join(" "))));
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("(--size, --crop) needs about"), "{text}");
}

#[test]
fn scenes_read_below_their_folder_only() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scenes = folder.path().join("scenes");
    std::fs::create_dir(&scenes).expect("creatable");
    std::fs::write(folder.path().join("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("writable");
    let mesh = |name: &str| {
        format!(
            "<scene version='3.0.0'><sensor type='perspective'/><shape type='obj'><string name='filename' value='{name}'/></shape></scene>"
        )
    };
    let absolute = folder.path().join("m.obj");
    let scene = scenes.join("s.xml");
    for name in ["../m.obj", absolute.to_str().expect("UTF-8")] {
        std::fs::write(&scene, mesh(name)).expect("writable");
        let scene = scene.to_str().expect("UTF-8");
        let (status, text) = done(&mut program(&["inspect", scene]));
        assert_eq!(status, Some(1), "{text}");
        assert!(text.contains("--allow-path"), "{text}");
        let allowed = folder.path().to_str().expect("UTF-8");
        let (status, text) = done(&mut program(&["inspect", scene, "--allow-path", allowed]));
        assert_eq!(status, Some(0), "{text}");
    }
}

/// Files may not grow beyond a few kilobytes (`ulimit -f`), as on a full disk: no half picture, an error.
#[test]
fn a_place_too_small_for_the_picture_is_an_error() {
    let (folder, output) = place();
    let render = render(&output, &["--passes", "2"]);
    let quoted = |s: &std::ffi::OsStr| format!("'{}'", s.to_string_lossy());
    let line: Vec<String> = [render.get_program()].into_iter().chain(render.get_args()).map(quoted).collect();
    let mut shell = Command::new("sh");
    shell.current_dir(env!("CARGO_MANIFEST_DIR")).env("TMPDIR", folder.path());
    let (status, text) = done(shell.arg("-c").arg(format!("ulimit -f 8; exec {}", line.join(" "))));
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("cannot write") && text.contains("File too large"), "{text}");
    assert!(!output.exists());
}

/// Two textures that exchange their contents make another scene, which no checkpoint is mixed with.
#[test]
fn exchanged_textures_are_another_scene() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let texture = |name: &str| {
        format!(
            "<shape type='sphere'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'>
             <string name='filename' value='{name}'/></texture></bsdf></shape>"
        )
    };
    let body = texture("a.pfm") + &texture("b.pfm");
    let text = format!("<scene version='3.0.0'><sensor type='perspective'/>{body}</scene>");
    std::fs::write(at("s.xml"), text).expect("writable");
    let picture = |value: f32| image::encode_pfm(1, 1, &[value; 3]).expect("a picture");
    let write = |a, b| {
        std::fs::write(at("a.pfm"), picture(a)).expect("writable");
        std::fs::write(at("b.pfm"), picture(b)).expect("writable");
    };
    let resume = || {
        let args = ["render", &at("s.xml"), "--size", "8x8", "--passes", "1", "-o", &at("o.exr"), "--resume"];
        done(&mut program(&args))
    };
    write(0.25, 0.75);
    assert_eq!(resume().0, Some(0));
    assert_eq!(resume().0, Some(0));
    write(0.75, 0.25);
    let (status, text) = resume();
    assert_eq!(status, Some(1), "{text}");
    assert!(text.contains("it belongs to another render: scene hash was"), "{text}");
}
