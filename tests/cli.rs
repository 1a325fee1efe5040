//! What the program says when it cannot do its work, word for word, and its exit status.

use std::path::Path;
use std::process::Command;

use insta::assert_snapshot;

use crate::support::box_camera;

struct Run {
    status: i32,
    text: String,
}

/// Runs `caustica` in a folder that holds these files.
fn run(files: &[(&str, &str)], arguments: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let output = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    // Blanks at line ends are removed by editors from snapshots.
    let text = text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
    Run { status: output.status.code().unwrap_or(-1), text: text.trim_end().to_owned() }
}

/// The message about a scene of these lines, which must end with status 1 and write no picture.
fn message(scene: &str, more: &[(&str, &str)]) -> String {
    let files = [&[("scene.xml", scene)], more].concat();
    let run = run(&files, &["render", "scene.xml", "-o", "out.exr"]);
    assert_eq!(run.status, 1, "{}", run.text);
    run.text
}

fn whole_scene() -> String {
    format!("<scene version='3.0.0'><integrator type='path'/>{}</scene>", box_camera(4))
}

#[test]
fn unknown_plugin() {
    assert_snapshot!(message("<scene version='3.0.0'>\n  <shape type='spher'/>\n</scene>", &[]), @r#"
    error: unknown shape plugin `spher`
      ┌─ scene.xml:2:16
      │
    2 │   <shape type='spher'/>
      │                ^^^^^
      │
      = help: with --lenient it is skipped
      = help: did you mean `sphere`?
    "#);
}

#[test]
fn misspelt_parameter() {
    assert_snapshot!(message("<scene version='3.0.0'>\n  <shape type='sphere'>\n    <float name='radus' value='2'/>\n  </shape>\n</scene>", &[]), @r#"
    error: unknown parameter `radus` of sphere
      ┌─ scene.xml:3:18
      │
    3 │     <float name='radus' value='2'/>
      │                  ^^^^^
      │
      = help: did you mean `radius`?
    "#);
}

#[test]
fn missing_mesh() {
    assert_snapshot!(message("<scene version='3.0.0'>\n  <shape type='obj'>\n    <string name='filename' value='bunny.obj'/>\n  </shape>\n</scene>", &[]), @r#"
    error: mesh `bunny.obj` not found
      ┌─ scene.xml:3:36
      │
    3 │     <string name='filename' value='bunny.obj'/>
      │                                    ^^^^^^^^^
      │
      = help: searched in: .
    "#);
}

#[test]
fn malformed_xml() {
    assert_snapshot!(message("<scene version='3.0.0'>\n  <shape type='sphere'>\n  </bsdf>\n</scene>", &[]), @r#"
    error: mismatched end tag </bsdf>, expected </shape>
      ┌─ scene.xml:3:3
      │
    2 │   <shape type='sphere'>
      │    ----- <shape> begins here
    3 │   </bsdf>
      │   ^^^^^^^
    "#);
}

#[test]
fn include_cycle() {
    assert_snapshot!(message(
        "<scene version='3.0.0'>\n  <include filename='a.xml'/>\n</scene>",
        &[
            ("a.xml", "<scene version='3.0.0'>\n  <include filename='b.xml'/>\n</scene>"),
            ("b.xml", "<scene version='3.0.0'>\n  <include filename='a.xml'/>\n</scene>"),
        ],
    ), @r#"
    error: include cycle: a.xml → b.xml → a.xml
      ┌─ b.xml:2:22
      │
    2 │   <include filename='a.xml'/>
      │                      ^^^^^
      │
      ┌─ a.xml:2:22
      │
    2 │   <include filename='b.xml'/>
      │                      ----- through this
    "#);
}

#[test]
fn unresolved_reference() {
    assert_snapshot!(message("<scene version='3.0.0'>\n  <bsdf type='diffuse' id='wall'/>\n  <shape type='sphere'>\n    <ref id='wal'/>\n  </shape>\n</scene>", &[]), @r#"
    error: no object has the id `wal`
      ┌─ scene.xml:4:14
      │
    4 │     <ref id='wal'/>
      │              ^^^
      │
      = help: did you mean `wall`?
    "#);
}

#[test]
fn vertex_that_is_not_a_number() {
    assert_snapshot!(message(
        "<scene version='3.0.0'>\n  <sensor type='perspective'/>\n  <shape type='obj'>\n    <string name='filename' value='mesh.obj'/>\n  </shape>\n</scene>",
        &[("mesh.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n")],
    ), @r#"
    error: cannot read mesh `mesh.obj`: vertex 2 (line 2) has a coordinate that is not finite
      ┌─ scene.xml:3:16
      │
    3 │   <shape type='obj'>
      │                ^^^
    "#);
}

#[test]
fn all_problems_are_listed_at_once() {
    let text = message(
        "<scene version='3.0.0'>\n  <shape type='spher'/>\n  <shape type='sphere'><bsdf type='difuse'/></shape>\n</scene>",
        &[],
    );
    assert_eq!(text.matches("error: ").count(), 2, "{text}");
}

#[test]
fn scene_file_that_is_not_there_or_of_no_known_language() {
    let gone = run(&[], &["render", "gone.xml"]);
    assert_eq!(gone.status, 1);
    assert_snapshot!(gone.text, @"error: gone.xml: No such file or directory");
    let other = run(&[("scene.txt", "")], &["render", "scene.txt"]);
    assert_eq!(other.status, 1);
    assert_snapshot!(other.text, @r#"
    error: scene.txt: not a scene language caustica reads
     = help: the extension decides; known: .xml, .pbrt, .pbrt.gz
    "#);
}

#[test]
fn output_that_cannot_be_written() {
    let scene = whole_scene();
    let files = [("scene.xml", scene.as_str()), ("plain", "")];
    for output in ["none/out.exr", "plain/out.exr"] {
        let run = run(&files, &["render", "scene.xml", "--quiet", "-o", output]);
        assert_eq!(run.status, 1);
        // The system's own words differ between systems; ours come first.
        assert!(run.text.starts_with(&format!("error: cannot write `{output}`: ")), "{}", run.text);
    }
    // Nobody may write there, whoever runs the tests.
    if cfg!(target_os = "linux") && Path::new("/sys").is_dir() {
        let run = run(&files, &["render", "scene.xml", "--quiet", "-o", "/sys/out.exr"]);
        let expected = "error: cannot write `/sys/out.exr`: the folder `/sys` is not writable: ";
        assert!(run.text.starts_with(expected) && !run.text.contains("probe"), "{}", run.text);
    }
    let run = run(&files, &["render", "scene.xml", "--quiet", "-o", "out.gif"]);
    assert_eq!(run.status, 2);
    assert_snapshot!(run.text, @"error: cannot write `out.gif`: the extension is `gif`; pictures are .exr, .png, .hdr or .pfm");
}

#[test]
fn settings_that_do_not_exist_or_do_not_parse() {
    let scene = whole_scene();
    let files = [("scene.xml", scene.as_str())];
    let name = run(&files, &["render", "scene.xml", "--set", "kernal=cone"]);
    assert_eq!(name.status, 2);
    assert_snapshot!(name.text, @"error: there is no setting `kernal`; did you mean `kernel`?");
    let far = run(&files, &["render", "scene.xml", "--set", "nosuchname=1"]);
    assert_snapshot!(far.text, @"error: there is no setting `nosuchname`; `--help-settings` lists all");
    let radius = run(&files, &["render", "scene.xml", "--set", "radius=2Q"]);
    assert_snapshot!(radius.text, @"error: invalid value `2Q` for setting `radius`: expected a positive length, a share of the scene's radius such as `0.0125R`, or `auto`");
    let value = run(&files, &["render", "scene.xml", "--set", "kernel=round"]);
    assert_eq!(value.status, 2);
    assert_snapshot!(value.text, @"error: invalid value `round` for setting `kernel`: expected one of constant, cone, epanechnikov, biweight, triweight, tricube, gaussian, logistic, silverman");
    let twice = run(&files, &["render", "scene.xml", "--photons", "10", "--set", "photons=20"]);
    assert_eq!(twice.status, 2);
    assert_snapshot!(twice.text, @"error: `--photons 10` and `--set photons=20` are of one setting; leave out one of them");
    let twice = run(&files, &["inspect", "scene.xml", "--spp", "4", "--set", "passes=5"]);
    assert_snapshot!(twice.text, @"error: `--spp 4` and `--set passes=5` are of one setting; leave out one of them");
    let layer = run(&files, &["render", "scene.xml", "--quiet", "--layers", "direkt"]);
    assert_eq!(layer.status, 2);
    assert_snapshot!(layer.text, @"error: there is no layer `direkt`; did you mean `direct`?");
}

/// What is asked for and the scene does not have is wrong on the command line, and nothing else.
#[test]
fn requests_that_a_scene_cannot_meet_are_usage_errors() {
    let scene = whole_scene();
    let files = [("scene.xml", scene.as_str())];
    let asked = |arguments: &[&str]| {
        let run = run(&files, &[&["render", "scene.xml"], arguments].concat());
        assert_eq!(run.status, 2, "{}", run.text);
        run.text
    };
    assert_snapshot!(asked(&["--sensor", "1"]), @"error: invalid value `1` for `--sensor`: expected 0, as the scene has one sensor");
    assert_snapshot!(asked(&["--crop", "2,0,3,4"]), @"error: invalid value `2,0,3,4` for `--crop`: expected a part of the film, which has 4 × 4 pixels");
    assert_snapshot!(asked(&["-D", "size=3"]), @r#"
    error: the scene never uses the parameter `size` given by -D
     = help: the scene's parameters: none
    "#);
    let value = asked(&["--set", "mode=progresive"]);
    assert!(value.ends_with("expected one of progressive, classic; did you mean `progressive`?"), "{value}");
    let bench = run(&files, &["bench", "scene.xml"]);
    assert_eq!(bench.status, 2, "{}", bench.text);
}

/// A resumed render tells its own passes from those of the checkpoint, and nothing it does not know; a black picture
/// has no relative error, and is said to be black however quiet the program is to be.
#[test]
fn summaries_say_what_was_done() {
    let scene =
        whole_scene().replace("</scene>", "<shape type='sphere'><emitter type='area'/></shape></scene>");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.xml"), scene).unwrap();
    std::fs::write(folder.path().join("black.xml"), whole_scene()).unwrap();
    let render = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
        let output = command.current_dir(folder.path()).arg("render").args(arguments).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{text}");
        text
    };
    let kept = ["scene.xml", "--integrator", "photonmap", "-o", "out.exr", "--checkpoint", "c"];
    let first = render(&[&kept[..], &["--spp", "2"]].concat());
    assert!(first.contains("passes          2 in ") && first.contains("wrote c (checkpoint)"), "{first}");
    let more = render(&[&kept[..], &["--spp", "5", "--resume"]].concat());
    assert!(more.contains("passes          5 = 2 of the checkpoint + 3 in "), "{more}");
    let none = render(&[&kept[..], &["--spp", "5", "--resume"]].concat());
    assert!(none.contains("passes          5 = 5 of the checkpoint + 0 in "), "{none}");
    assert!(!none.contains("radius") && !none.contains("rays"), "{none}");
    let black = render(&["black.xml", "--spp", "4", "-o", "black.exr"]);
    assert!(black.contains("standard error  none: all is black"), "{black}");
    let quiet = render(&["black.xml", "--spp", "1", "-q", "-o", "black.exr"]);
    assert_eq!(quiet, "warning: black.xml: the scene has no light; the picture will be black\n");
}

#[test]
fn sizes_and_counts_beyond_sense_point_at_their_option() {
    let scene = whole_scene();
    let files = [("scene.xml", scene.as_str())];
    let size = run(&files, &["render", "scene.xml", "--size", "60000x60000"]);
    assert_eq!(size.status, 2);
    assert_snapshot!(size.text, @r#"
    error: invalid value '60000x60000' for '--size <WxH>': a film has 1073741824 pixels at most

    For more information, try '--help'.
    "#);
    let photons = run(&files, &["render", "scene.xml", "--photons", "0"]);
    assert_eq!(photons.status, 2);
    assert_snapshot!(photons.text, @"error: invalid value `0` for setting `photons`: expected a whole number from 1 (integrator `path` needs no photons), `stored:NUMBER` or `auto`");
}

#[test]
fn a_time_beyond_all_clocks_is_no_limit() {
    let scene = whole_scene();
    let arguments = ["render", "scene.xml", "--quiet", "--time", "1.8e19", "--spp", "1", "-o", "out.pfm"];
    let run = run(&[("scene.xml", &scene)], &arguments);
    assert_eq!(run.status, 0, "{}", run.text);
}

#[test]
fn files_with_nearly_the_right_name_are_suggested() {
    let mesh = "<scene version='3.0.0'>\n  <shape type='obj'>\n    <string name='filename' value='bunnny.obj'/>\n  </shape>\n</scene>";
    assert_snapshot!(message(mesh, &[("bunny.obj", ""), ("other.obj", "")]), @r#"
    error: mesh `bunnny.obj` not found
      ┌─ scene.xml:3:36
      │
    3 │     <string name='filename' value='bunnny.obj'/>
      │                                    ^^^^^^^^^^
      │
      = help: did you mean `bunny.obj`?
      = help: searched in: .
    "#);
}

#[test]
fn arguments_that_do_not_parse() {
    let scene = whole_scene();
    let files = [("scene.xml", scene.as_str())];
    let size = run(&files, &["render", "scene.xml", "--size", "640"]);
    // clap's status for usage errors.
    assert_eq!(size.status, 2);
    assert_snapshot!(size.text, @r#"
    error: invalid value '640' for '--size <WxH>': expected WIDTHxHEIGHT, such as 640x480

    For more information, try '--help'.
    "#);
    // FLIP's filters would have been as wide as that.
    for ppd in ["1e400", "18446744073709551616", "nan", "0"] {
        let flip = run(&files, &["compare", "a.exr", "b.exr", &format!("--ppd={ppd}")]);
        assert_eq!(flip.status, 2);
        assert!(flip.text.contains("expected a number from 1 to 10000"), "{}", flip.text);
    }
    let option = run(&files, &["render", "scene.xml", "--sise", "6x4"]);
    assert_eq!(option.status, 2);
    assert_snapshot!(option.text, @r#"
    error: unexpected argument '--sise' found

      tip: a similar argument exists: '--size'

    Usage: caustica render --size <WxH> <SCENE>

    For more information, try '--help'.
    "#);
}

#[test]
fn checkpoints_of_other_renders_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.xml"), whole_scene()).unwrap();
    let run = |seed: &str, rest: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
        command.current_dir(folder.path()).args(["render", "scene.xml", "--quiet", "--spp", "1"]);
        command.args(["-o", "out.exr", "--checkpoint", "c", "--seed", seed]).args(rest).output().unwrap()
    };
    assert!(run("1", &[]).status.success());
    assert!(run("1", &["--resume"]).status.success());
    let refused = run("2", &["--resume"]);
    assert_eq!(refused.status.code(), Some(1));
    assert_snapshot!(String::from_utf8(refused.stderr).unwrap().trim(), @"error: cannot resume from `c`: it belongs to another render: seed was `1`, now it is `2`");
}

/// A layer named twice is stored once; what only an EXR can hold is asked of one before the render.
#[test]
fn layers_are_stored_once_and_by_exr_only() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.xml"), whole_scene()).unwrap();
    let run = |rest: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
        command.current_dir(folder.path()).args(["render", "scene.xml", "--quiet"]);
        command.args(rest).output().unwrap()
    };
    let done = run(&["--spp", "1", "--layers", "all,direct", "-o", "out.exr"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let picture =
        caustica_formats::image::read(&std::fs::read(folder.path().join("out.exr")).unwrap()).unwrap();
    let direct = picture.channels.iter().filter(|name| name.starts_with("direct.")).count();
    // The picture, its parts, two statistics, and twelve pictures of surfaces.
    assert_eq!((direct, picture.channels.len()), (3, 3 + 5 * 3 + 2 + 27), "{:?}", picture.channels);
    // As many passes as would take for ever: the error comes before them.
    for asked in [&["--layers", "direct"][..], &["--half"]] {
        let refused = run(&[&["--spp", "4000000000", "-o", "out.png"], asked].concat());
        assert_eq!(refused.status.code(), Some(2));
        let text = String::from_utf8(refused.stderr).unwrap();
        assert!(text.contains("can be stored in .exr files only, and `out.png`"), "{text}");
    }
    assert!(!folder.path().join("out.png").exists());
    let neither = run(&["--spp", "1", "--layers", "none", "-o", "out.png"]);
    assert!(neither.status.success(), "{}", String::from_utf8_lossy(&neither.stderr));
}
