//! `caustica convert`: the converted scene renders to the same picture as its source.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use caustica::render::Budget;
use caustica::session::{Options, Session};

fn convert(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_caustica"))
        .arg("convert")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut found = Vec::new();
    for folder in [root.clone(), root.join("reference")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "xml") {
                found.push(path);
            }
        }
    }
    found
}

/// Mitsuba can express everything in these scenes, so nothing may differ.
#[test]
fn mitsuba_scenes_keep_every_bit_of_their_picture() {
    let folder = tempfile::tempdir().unwrap();
    let scenes = scenes();
    assert!(scenes.len() > 3);
    for scene in scenes {
        let name = scene.file_name().unwrap().to_str().unwrap();
        let run = convert(&[scene.to_str().unwrap(), name, "--check"], folder.path());
        let said = text(&run.stdout);
        assert!(run.status.success(), "{name}: {said}{}", text(&run.stderr));
        assert!(said.contains("the same to the last bit"), "{name}: {said}");
    }
}

const PBRT: &str = r#"
LookAt 0 1 5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
WorldBegin
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [6 5 4]
  Translate 0 3 0
  Rotate 90 1 0 0
  Shape "disk" "float radius" 0.7
AttributeEnd
Material "diffuse" "rgb reflectance" [0.5 0.4 0.3]
Shape "trianglemesh" "point3 P" [-3 -1 -3  3 -1 -3  3 -1 3  -3 -1 3] "integer indices" [0 2 1 0 3 2]
AttributeBegin
  Material "dielectric" "float eta" 1.4
  Translate -0.8 0 0
  Shape "sphere" "float radius" 0.7
AttributeEnd
Material "conductor" "spectrum eta" "metal-Cu-eta" "spectrum k" "metal-Cu-k" "float roughness" 0.2
Translate 0.9 0 0
Shape "sphere" "float radius" 0.8
"#;

/// Mitsuba cannot express the shadowing of the metal, so it is listed with its location. It darkens grazing angles
/// by less than the noise of the check.
#[test]
fn what_mitsuba_cannot_express_is_listed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), PBRT).unwrap();
    let run = convert(&["a.pbrt", "b.xml", "--report", "loss.json", "--check"], folder.path());
    assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
    let losses = losses(&folder.path().join("loss.json"));
    let shadowing = losses.iter().find(|loss| loss["what"].as_str().unwrap().contains("shadowing"));
    assert_eq!(shadowing.unwrap()["place"], "a.pbrt:19:10");
    for loss in &losses {
        assert!(text(&run.stderr).contains(loss["what"].as_str().unwrap()));
        assert!(!loss["instead"].as_str().unwrap().is_empty());
    }
}

/// Scenes that list no loss when converted to pbrt keep their picture, up to noise: rounding of the camera and of
/// matrices sends some light paths elsewhere.
#[test]
fn scenes_that_lose_nothing_in_pbrt_keep_their_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut kept = 0;
    for scene in scenes() {
        let name = scene.file_stem().unwrap().to_str().unwrap();
        let (out, report) = (format!("{name}.pbrt"), format!("{name}.json"));
        let run = convert(&[scene.to_str().unwrap(), &out, "--report", &report], folder.path());
        assert!(run.status.success(), "{name}: {}", text(&run.stderr));
        let losses: Vec<serde_json::Value> =
            serde_json::from_str(&std::fs::read_to_string(folder.path().join(&report)).unwrap()).unwrap();
        // These losses do not show: nothing is behind the walls, and pbrt has none of our settings.
        let unseen = |loss: &serde_json::Value| {
            let what = loss["what"].as_str().unwrap();
            what.contains("black on its back") || what.contains("the setting")
        };
        if !losses.iter().all(unseen) {
            continue;
        }
        kept += 1;
        let run = convert(&[scene.to_str().unwrap(), &out, "--check", "--force"], folder.path());
        assert!(run.status.success(), "{name}: {}{}", text(&run.stdout), text(&run.stderr));
    }
    assert!(kept >= 3, "{kept}");
}

/// From pbrt to pbrt nothing is lost.
#[test]
fn pbrt_scenes_survive_being_written_again() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), PBRT).unwrap();
    let run = convert(&["a.pbrt", "b.pbrt", "--report", "loss.json", "--check"], folder.path());
    assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
    assert_eq!(std::fs::read_to_string(folder.path().join("loss.json")).unwrap(), "[]");
    let again = convert(&["b.pbrt", "c.pbrt"], folder.path());
    assert!(again.status.success(), "{}", text(&again.stderr));
    // Comments name the source location, and the camera's transform is inverted in between, which rounds; all
    // else is the same.
    let lines = |name: &str| -> Vec<String> {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        let (place, rest) = text.split_once("Camera").unwrap();
        assert!(place.contains("LookAt"), "{place}");
        rest.lines().filter(|line| !line.trim_start().starts_with('#')).map(str::to_owned).collect()
    };
    assert_eq!(lines("b.pbrt"), lines("c.pbrt"));
}

#[test]
fn files_are_overwritten_only_with_force_and_the_source_never() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), PBRT).unwrap();
    std::fs::write(folder.path().join("b.xml"), "mine").unwrap();
    let refused = convert(&["a.pbrt", "b.xml"], folder.path());
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("--force"), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read_to_string(folder.path().join("b.xml")).unwrap(), "mine");
    assert!(convert(&["a.pbrt", "b.xml", "--force"], folder.path()).status.success());
    let itself = convert(&["b.xml", "b.xml", "--force"], folder.path());
    assert!(text(&itself.stderr).contains("was read from"), "{}", text(&itself.stderr));
}

/// In pbrt, light that bounces between coat and base is coloured by the base each time; in Mitsuba's plastic
/// only if it is `nonlinear`. The base is written so that both reflect the same; unchanged, pbrt's would be a
/// quarter darker.
#[test]
fn plastic_keeps_its_brightness_in_pbrt() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective">
    <float name="fov" value="30"/>
    <transform name="to_world"><lookat origin="0, -4, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="32"/><rfilter type="box"/></film>
</sensor>
<emitter type="constant"/>
<shape type="sphere"><bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.6, 0.4, 0.1"/></bsdf></shape>
</scene>"#;
    std::fs::write(folder.path().join("a.xml"), scene).unwrap();
    let run = convert(&["a.xml", "b.pbrt", "--check"], folder.path());
    assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
}

/// What `--report` wrote.
fn losses(report: &Path) -> Vec<serde_json::Value> {
    serde_json::from_str(&std::fs::read_to_string(report).unwrap()).unwrap()
}

/// The light of a ball in even light, before and after. A metal dimmed to half of its reflectance is written as the
/// metal itself where a texture says its index; otherwise as one of the same reflectance r at normal incidence, which
/// is brighter where light grazes: by less than the mean (1 − r)/21 of Schlick's (1 − r)(1 − cos θ)⁵, 0.026 of 0.46.
#[test]
fn losses_of_materials_have_a_size() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/>
<shape type="sphere"><bsdf type="conductor"><texture name="eta" type="checkerboard"><float name="color0" value="1.1"/><float name="color1" value="1.1"/></texture><rgb name="k" value="6.8"/><float name="specular_reflectance" value="0.5"/></bsdf></shape>
<shape type="sphere"><bsdf type="conductor"><string name="material" value="Al"/><float name="specular_reflectance" value="0.5"/></bsdf></shape>
<shape type="cube"><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
</scene>"#;
    std::fs::write(folder.path().join("a.xml"), scene).unwrap();
    let run = convert(&["a.xml", "b.pbrt", "--report", "loss.json"], folder.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    let losses = losses(&folder.path().join("loss.json"));
    let mut dimmed = losses.iter().filter(|l| l["what"] == "the specular reflectance of a metal");
    let [whole, normal] = [dimmed.next(), dimmed.next()].map(|l| l.unwrap()["size"].as_f64().unwrap());
    // Of balls with the same paths; spectra differ by how they become RGB.
    assert!((whole - 1.0).abs() < 0.02, "{whole}");
    assert!(text(&run.stderr).contains("size: +1"), "{}", text(&run.stderr));
    assert!((0.0..0.056).contains(&normal), "{normal}");
    // What is seen from behind only has none.
    let back = losses.iter().find(|l| l["what"] == "a surface that is black on its back").unwrap();
    assert!(back["size"].is_null(), "{back}");
}

/// Mitsuba's model of roughness 1 reflects about three times what pbrt's coat does, a loss of 69 % in the mean of a
/// room that was seen.
#[test]
fn the_size_of_a_rough_principled_material_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/>
<shape type="sphere"><bsdf type="principled"><rgb name="base_color" value="0.8"/><float name="roughness" value="1"/></bsdf></shape>
</scene>"#;
    std::fs::write(folder.path().join("a.xml"), scene).unwrap();
    let run = convert(&["a.xml", "b.pbrt", "--report", "loss.json"], folder.path());
    assert!(run.status.success(), "{}", text(&run.stderr));
    let losses = losses(&folder.path().join("loss.json"));
    let size =
        losses.iter().find(|l| l["what"] == "the `principled` model").unwrap()["size"].as_f64().unwrap();
    assert!((-0.72..-0.64).contains(&size), "{size}");
}

/// A closed room of albedo 1/2 whose walls shine with 1: without end 2, and after pbrt's 5 bounces 2 − 2⁻⁵. Scenes of
/// Mitsuba that name no integrator follow paths without end, those of pbrt for 5 bounces, and a converted scene does as
/// its source.
#[test]
fn scenes_that_name_no_integrator_are_as_deep_as_in_their_renderers() {
    let folder = tempfile::tempdir().unwrap();
    let endless = r#"<scene version="3.0.0">
<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
<shape type="sphere"><boolean name="flip_normals" value="true"/>
<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
</scene>"#;
    let short = "Camera \"perspective\"\nFilm \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\n\
                 Material \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\nAreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\n\
                 ReverseOrientation\nShape \"sphere\"\n";
    std::fs::write(folder.path().join("a.xml"), endless).unwrap();
    std::fs::write(folder.path().join("b.pbrt"), short).unwrap();
    for (source, made, pbrt, mitsuba) in [
        ("a.xml", ["a.pbrt", "a2.xml"], Some("\"integer maxdepth\" 1000000"), None),
        ("b.pbrt", ["b2.pbrt", "b.xml"], Some("\"integer maxdepth\" 5"), Some("\"max_depth\" value=\"6\"")),
    ] {
        for (name, said) in made.iter().zip([pbrt, mitsuba]) {
            let run = convert(&[source, name, "--check"], folder.path());
            assert!(run.status.success(), "{}{}", text(&run.stdout), text(&run.stderr));
            let written = std::fs::read_to_string(folder.path().join(name)).unwrap();
            assert_eq!(said.is_none(), !written.contains("depth"), "{written}");
            assert!(said.is_none_or(|said| written.contains(said)), "{written}");
        }
    }
    for (name, right) in
        [("a.xml", 2.0), ("b.pbrt", 2.0 - 1.0 / 32.0), ("a.pbrt", 2.0), ("b.xml", 2.0 - 1.0 / 32.0)]
    {
        let options =
            Options { settings: vec![("integrator".to_owned(), "path".to_owned())], ..Options::default() };
        let session = Session::open(folder.path().join(name), &options).unwrap();
        let pixels = session.render(Budget::passes(64), &mut |_| {}).pixels;
        let mean = (0..pixels.len()).map(|i| pixels.beauty(i, 64)[1]).sum::<f64>() / pixels.len() as f64;
        // Paths end by roulette: the measured spread is 0.2 %, and the two lengths differ by 1.6 %.
        assert!((mean / right - 1.0).abs() < 0.006, "{name}: {mean}");
    }
}

const ELLIPSOID: &str = r#"
LookAt 0.7 3 6  0 0.7 0  0.1 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 48 "integer yresolution" 36
PixelFilter "box"
Sampler "independent"
WorldBegin
LightSource "infinite" "rgb L" [0.2 0.3 0.4]
LightSource "distant" "point3 from" [1 2 3] "point3 to" [0 0 0] "rgb L" [3 2 1]
Shape "bilinearmesh" "point3 P" [-3 0 -3 3 0 -3 -3 0 3 3 0 3]
Translate 0 1.01 0
Scale 1 0.4 0.7
Shape "sphere"
"#;

/// Mitsuba itself agrees, where it is installed; it drew the stretched sphere that was written once as a ball.
#[test]
fn the_renderer_of_the_language_is_asked_where_it_is_installed() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.pbrt"), ELLIPSOID).unwrap();
    for (renderer, output) in [("mitsuba", "b.xml"), ("pbrt", "b.pbrt")] {
        let run = convert(&["a.pbrt", output, "--check-with", renderer], folder.path());
        let said = text(&run.stdout);
        assert!(run.status.success(), "{said}{}", text(&run.stderr));
        let skipped = said.contains(&format!("check with {renderer}: skipped, it is not installed"));
        if skipped {
            println!("{}", said.trim());
        }
        assert!(skipped || said.contains(": equal"), "{said}");
    }
}
