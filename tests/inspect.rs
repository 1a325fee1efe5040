//! `caustica inspect`: what is said of a scene, for people and for machines.

use std::path::Path;
use std::process::Command;

/// Exit status, stdout and stderr.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_caustica"));
    let output = program.arg("inspect").args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

fn inspect(folder: &Path, arguments: &[&str]) -> String {
    let (status, out, errors) = run(folder, arguments);
    assert_eq!(status, 0, "{errors}");
    out
}

fn json(folder: &Path, scene: &str) -> serde_json::Value {
    serde_json::from_str(&inspect(folder, &[scene, "--json"])).unwrap()
}

const PARTLY: &str = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 4\nWorldBegin\n\
    Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0]\nShape \"sphere\"\n\
    LightSource \"infinite\" \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]\n";

/// Features that are not supported are errors, with as much said of the scene as without them; with `--lenient`
/// they are listed.
#[test]
fn what_is_not_supported_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), PARTLY).unwrap();
    let (status, out, errors) = run(folder.path(), &["a.pbrt", "--json"]);
    assert_eq!(status, 1);
    assert!(errors.starts_with("error: shape `curve` is not supported"), "{errors}");
    let said: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(said["renders"], false);
    assert_eq!(said["read"]["shapes"]["Sphere"], 1);
    assert_eq!(said["statistics"]["primitives"], 1);
    let list = said["diagnostics"].as_array().unwrap();
    let errors: Vec<_> = list.iter().filter(|d| d["severity"] == "error").collect();
    let lines: Vec<_> = errors.iter().map(|d| (d["line"].as_u64(), d["column"].as_u64())).collect();
    assert_eq!(lines, [(Some(3), Some(7)), (Some(5), Some(24))], "{said:#}");
    assert!(errors.iter().all(|d| d["file"] == "a.pbrt" && d["unsupported"] == true), "{said:#}");
    assert!(errors[0]["help"][0].as_str().unwrap().contains("--lenient"), "{said:#}");
    let (_, text, _) = run(folder.path(), &["a.pbrt"]);
    assert!(text.contains("not supported\n  a.pbrt:3:7: shape `curve`"), "{text}");
    assert!(text.ends_with("this scene is refused\n"), "{text}");
    let text = inspect(folder.path(), &["a.pbrt", "--lenient"]);
    assert!(text.contains("not supported\n  a.pbrt:3:7: shape `curve`"), "{text}");
}

/// JSON is all of stdout, whatever is wrong: a file that is not there, text that cannot be read, an error of the
/// scene with a further place.
#[test]
fn errors_are_json_too() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("cut.xml", "<scene version='3.0.0'>\n  <shape type='sphere'>\n  </bsdf>\n</scene>");
    write(
        "mesh.xml",
        "<scene version='3.0.0'><sensor type='perspective'/><shape type='cube'/>\n<shape type='ply'><string name='filename' value='a.ply'/></shape></scene>",
    );
    write("a.ply", "no mesh");
    for (scene, message, line) in [
        ("gone.xml", "gone.xml: No such file or directory", None),
        ("cut.xml", "mismatched end tag </bsdf>, expected </shape>", Some(3)),
        ("mesh.xml", "cannot read mesh `a.ply`: it is a text that begins with \"no mesh\"", Some(2)),
    ] {
        let (status, out, _) = run(folder.path(), &[scene, "--json"]);
        assert_eq!(status, 1);
        let said: serde_json::Value = serde_json::from_str(&out).unwrap();
        let first = &said["diagnostics"][0];
        assert_eq!((&first["message"], &first["severity"]), (&message.into(), &"error".into()), "{said:#}");
        assert_eq!(first["line"].as_u64(), line, "{said:#}");
        if scene == "cut.xml" {
            assert_eq!(first["labels"][0]["line"], 2, "{said:#}");
        }
        // What the files say is known where they could be read.
        assert_eq!(
            said["read"]["shapes"]["Cube"],
            if scene == "mesh.xml" { 1.into() } else { serde_json::Value::Null }
        );
    }
}

/// The middle is that of the shapes, wherever the camera is; lamps are counted once, by their kind.
#[test]
fn the_middle_is_that_of_the_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let camera = crate::support::camera("100,20,3", "100,20,0", 40.0, 4);
    let lamp = "<shape type='sphere'><point name='center' x='100' y='20' z='-30'/><float name='radius' value='2'/>\
        <emitter type='area'/></shape>";
    std::fs::write(folder.path().join("s.xml"), format!("<scene version='3.0.0'>{camera}{lamp}</scene>"))
        .unwrap();
    let said = json(folder.path(), "s.xml");
    let middle: Vec<f64> =
        said["statistics"]["middle"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    // Places are single precision.
    for (found, expected) in middle.iter().zip([100.0, 20.0, -30.0]) {
        assert!((found - expected).abs() < 1e-3, "{middle:?}");
    }
    let text = inspect(folder.path(), &["s.xml"]);
    assert!(text.contains("emitters             1: 1 Area\n") && !text.contains("area lamps"), "{text}");
}

/// A picture of one scene, in both languages: the mirror and the glass need a caustic map.
#[test]
fn the_same_scene_is_described_alike_in_both_languages() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let [xml, pbrt] = ["cornell-glass.xml", "cornell-glass.pbrt"].map(|name| json(&scenes, name));
    for said in [&xml, &pbrt] {
        assert_eq!(said["read"]["film"], serde_json::json!([512, 512]));
        assert_eq!(said["read"]["shapes"]["Sphere"], 2);
        assert_eq!(said["read"]["area_lamps"], 1);
        assert_eq!(said["plan"]["caustic_map"], true);
        assert_eq!(said["plan"]["textured"], false);
        assert_eq!(said["renders"], true);
        assert_eq!(said["diagnostics"], serde_json::json!([]));
        assert_eq!(said["settings"]["integrator"], "photonmap");
    }
    assert_eq!(xml["statistics"]["primitives"], pbrt["statistics"]["primitives"]);
    // One of them turns the lamp by a matrix, in single precision.
    let power = |said: &serde_json::Value| said["statistics"]["emitted_power"][0].as_f64().unwrap();
    assert!((power(&xml) / power(&pbrt) - 1.0).abs() < 1e-6);
    // What a pilot measures differs with the rounding; what it leads to is the same.
    assert_eq!(xml["plan"]["indirect"]["indirect"], pbrt["plan"]["indirect"]["indirect"]);
    let decided = |said: &serde_json::Value| {
        let mut plan = said["plan"].as_object().unwrap().clone();
        ["indirect", "global_paths", "caustic_paths"].iter().for_each(|name| drop(plan.remove(*name)));
        plan
    };
    assert_eq!(decided(&xml), decided(&pbrt));
    let text = inspect(&scenes, &["cornell-glass.pbrt"]);
    assert!(text.contains("nothing: all of the scene is rendered"), "{text}");
}

/// Media are described by what they scatter and where; a note on surfaces in media only where they take photons.
#[test]
fn media_are_described() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/media");
    let milk = inspect(&folder, &["milk.xml", "--size", "16x16", "--threads", "1"]);
    assert!(milk.contains("Henyey-Greenstein phase function, g 0."), "{milk}");
    let smoke = inspect(&folder, &["smoke.xml", "--size", "16x16", "--set", "indirect=trace"]);
    assert!(smoke.contains("varies, in the mean of its box, mean free path 3.2"), "{smoke}");
    assert!(smoke.contains("Henyey-Greenstein phase function, g 0.3"), "{smoke}");
    let note = "media: light of surfaces from photons at the first rough surface";
    assert!(!smoke.contains(note), "{smoke}");
    let photons = inspect(&folder, &["smoke.xml", "--size", "16x16", "--set", "indirect=density"]);
    assert!(photons.contains(note), "{photons}");
}
