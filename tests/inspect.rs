//! `caustica inspect`: what is said of a scene, for people and for machines.

use std::path::Path;
use std::process::Command;

fn inspect(folder: &Path, arguments: &[&str]) -> String {
    let mut program = Command::new(env!("CARGO_BIN_EXE_caustica"));
    let output = program.arg("inspect").args(arguments).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(folder: &Path, scene: &str) -> serde_json::Value {
    serde_json::from_str(&inspect(folder, &[scene, "--json"])).unwrap()
}

const PARTLY: &str = "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 4\nWorldBegin\n\
    Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0]\nShape \"sphere\"\n\
    LightSource \"infinite\" \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]\n";

/// Features that are not rendered are listed with their places, not fatal.
#[test]
fn what_is_not_supported_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), PARTLY).unwrap();
    let said = json(folder.path(), "a.pbrt");
    let list = said["unsupported"].as_array().unwrap();
    let places: Vec<_> = list.iter().map(|finding| finding["place"].as_str().unwrap()).collect();
    assert_eq!(places, ["a.pbrt:3:7", "a.pbrt:5:24"], "{said:#}");
    assert!(list[0]["message"].as_str().unwrap().contains("`curve`"));
    let text = inspect(folder.path(), &["a.pbrt"]);
    assert!(text.contains("not supported\n  a.pbrt:3:7: shape `curve`"), "{text}");
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
        assert_eq!(said["unsupported"], serde_json::json!([]));
        assert_eq!(said["settings"]["integrator"], "photonmap");
    }
    assert_eq!(xml["statistics"]["primitives"], pbrt["statistics"]["primitives"]);
    // One of them turns the lamp by a matrix, in single precision.
    let power = |said: &serde_json::Value| said["statistics"]["emitted_power"][0].as_f64().unwrap();
    assert!((power(&xml) / power(&pbrt) - 1.0).abs() < 1e-6);
    assert_eq!(xml["plan"], pbrt["plan"]);
    let text = inspect(&scenes, &["cornell-glass.pbrt"]);
    assert!(text.contains("nothing: all of the scene is rendered"), "{text}");
}
