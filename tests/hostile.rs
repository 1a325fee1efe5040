//! Scenes that would never end or grow without bound give a finite picture or an error, in finite time.

use std::path::Path;
use std::time::{Duration, Instant};

use caustica::session::Session;
use caustica_formats::files::Memory;
use caustica_formats::{ReadOptions, read_scene};

use crate::support::{Picture, area, box_camera, camera, diffuse, lamp, plain, render, scene, sphere, walls};

const METHODS: [&[(&str, &str)]; 5] = [
    &[("integrator", "path")],
    &[],
    &[("nee", "false")],
    &[("indirect", "gather")],
    &[("indirect", "density")],
];

fn assert_finite(picture: &Picture) {
    assert!(picture.pixel_values().iter().flatten().all(|v| v.is_finite() && *v >= 0.0));
}

/// A closed emitting shell of albedo 1 has no equilibrium; Russian roulette still ends every path.
#[test]
fn a_furnace_without_absorption_ends() {
    let shell = format!("<boolean name='flip_normals' value='true'/>{}{}", diffuse("1"), area("1"));
    let scene = scene(&format!("{}{}", camera("0,0,0", "0,0,1", 90.0, 4), sphere("0,0,0", 1.0, &shell)));
    for settings in METHODS {
        let picture = render(&scene, settings, 4);
        assert_finite(&picture);
        assert!(picture.beauty(0).mean > 1.0);
    }
}

/// Light and camera paths between perfect mirrors.
#[test]
fn a_box_of_mirrors_ends() {
    let mirror = "<bsdf type='conductor'><string name='material' value='none'/></bsdf>";
    let room = format!("<shape type='cube'><boolean name='flip_normals' value='true'/>{mirror}</shape>");
    let bulb = sphere("0.5,0.5,0.5", 0.1, &area("3"));
    let stone = sphere("-0.4,-0.4,0.4", 0.3, &diffuse("0.5"));
    for body in [format!("{room}{bulb}{stone}"), format!("{room}{bulb}")] {
        let scene = scene(&format!("{}{body}", camera("0,0,0", "0,0,1", 90.0, 4)));
        for settings in METHODS {
            assert_finite(&render(&scene, settings, 4));
        }
    }
}

#[test]
fn a_scene_without_lamps_is_black() {
    let scene = scene(&[box_camera(4), walls("0.6")].concat());
    for settings in METHODS {
        let picture = render(&scene, settings, 2);
        assert!(picture.pixel_values().iter().flatten().all(|v| *v == 0.0));
    }
}

/// Nothing but a sky; nothing at all; a lamp of radiance 0; radiance near the largest float; a lens in
/// contact with a wall; a lamp in a wall; a flat triangle and a sphere of no size.
#[test]
fn degenerate_scenes_give_finite_pictures() {
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    let wall = "<shape type='rectangle'/>";
    let point = |at: &str| {
        format!(
            "<emitter type='point'><point name='position' value='{at}'/><rgb name='intensity' value='1'/></emitter>"
        )
    };
    let near = camera("0,0,0.000001", "0,0,-1", 90.0, 4);
    let view = camera("0,0,3", "0,0,0", 40.0, 4);
    for body in [
        format!("{view}{sky}"),
        view.clone(),
        format!("{view}{}{}", walls("0.6"), lamp(0.4, "0")),
        format!("{view}{}{}", walls("0.6"), lamp(0.4, "1e30")),
        format!("{near}{wall}{}", point("0,0,1")),
        format!("{view}{wall}{}", point("0,0,0")),
        format!("{view}{wall}{}", point("0,0,1e-30")),
        format!(
            "{view}{wall}<shape type='rectangle'><transform name='to_world'><scale x='1e-20' y='1'/></transform>{}</shape>",
            area("1")
        ),
        format!("{view}{wall}{}{}", sphere("0,0,1", 1e-12, &area("1")), point("1,1,1")),
    ] {
        let scene = scene(&body);
        for settings in METHODS {
            assert_finite(&render(&scene, settings, 2));
        }
    }
}

fn problems(name: &str, text: &str) -> String {
    let files = Memory([(name.into(), text.as_bytes().to_vec())].into());
    match Session::open_in(&files, Path::new(name), &plain()) {
        Ok(_) => String::new(),
        Err(problem) => problem.to_string(),
    }
}

fn nested(version: &str, layers: usize, tag: &str) -> String {
    let (open, close) = (tag.repeat(layers), "</bsdf>".repeat(layers));
    let view = camera("0,0,3", "0,0,0", 40.0, 4);
    format!(
        "<scene version='{version}'>{view}<shape type='sphere'>{open}<bsdf type='diffuse'/>{close}</shape></scene>"
    )
}

/// A `twosided` holds its nested material twice, and a coat evaluates its base twice. Four nested coats are
/// rendered.
#[test]
fn materials_nested_in_themselves_are_refused() {
    for layers in [30, 250] {
        let said = problems("s.xml", &nested("3.0.0", layers, "<bsdf type='twosided'>"));
        assert!(said.contains("a material of more than 1024 BSDFs is not supported"), "{said}");
    }
    let coats = |layers| problems("s.xml", &nested("0.6.0", layers, "<bsdf type='coating'>"));
    assert_eq!(coats(4), "");
    for layers in [5, 200] {
        let said = coats(layers);
        assert!(said.contains("a material under more than 4 coats is not supported"), "{said}");
        assert_eq!(said.matches("error").count(), 1, "{said}");
    }
}

/// Textures are evaluated recursively, so the depth is limited.
#[test]
fn a_long_chain_of_textures_is_refused() {
    let chain = |length: usize| {
        let links: String = (1..length)
            .map(|i| format!("Texture \"{i}\" \"spectrum\" \"scale\" \"texture tex\" \"{}\"\n", i - 1))
            .collect();
        format!(
            "Camera \"perspective\" WorldBegin Texture \"0\" \"spectrum\" \"dots\"\n{links}Material \"diffuse\" \"texture reflectance\" \"{}\" Shape \"sphere\"\n",
            length - 1
        )
    };
    assert_eq!(problems("s.pbrt", &chain(256)), "");
    let files = Memory([("s.pbrt".into(), chain(50_000).into_bytes())].into());
    let failure = read_scene(&files, Path::new("s.pbrt"), &ReadOptions::default()).expect_err("too deep");
    let said = failure.to_string();
    assert!(said.contains("s.pbrt:257:9"), "{}", &said[..300]);
    assert!(said.contains("textures refer to each other more than 256 deep"), "{}", &said[..300]);
}

/// A hundred thousand mistakes in a line of two megabytes: some are shown and the rest counted, within seconds.
#[test]
fn mistakes_by_the_thousand_are_counted() {
    let text = format!("<scene version='3.0.0'>{}</scene>", "<shape type='spheer'/>".repeat(100_000));
    let files = Memory([("s.xml".into(), text.into_bytes())].into());
    let begun = Instant::now();
    let failure = read_scene(&files, Path::new("s.xml"), &ReadOptions::default()).expect_err("wrong");
    let said = failure.to_string();
    // A second on an idle machine; hours if every one is shown.
    assert!(begun.elapsed() < Duration::from_secs(60), "{:?}", begun.elapsed());
    assert!(said.contains("s.xml:1:") && said.len() < 200_000, "{}", said.len());
    assert!(said.ends_with(" more like these"), "{}", &said[said.len() - 300..]);
}

/// Forty blends, and forty mixed textures, each of which holds the one before twice.
#[test]
fn what_doubles_itself_is_refused() {
    let blend = |i: u32| {
        let below = i - 1;
        format!(
            "<bsdf type='blendbsdf' id='{i}'><float name='weight' value='0.5'/><ref id='{below}'/><ref id='{below}'/></bsdf>"
        )
    };
    let blends: String = (1..40).map(blend).collect();
    let view = camera("0,0,3", "0,0,0", 40.0, 4);
    let text = format!(
        "<scene version='3.0.0'>{view}<bsdf type='diffuse' id='0'/>{blends}<shape type='sphere'><ref id='39'/></shape></scene>"
    );
    assert!(problems("scene.xml", &text).contains("a material of more than 1024 BSDFs is not supported"));

    let mix = |i: u32| {
        let below = i - 1;
        format!(
            "Texture \"{i}\" \"spectrum\" \"mix\" \"texture tex1\" \"{below}\" \"texture tex2\" \"{below}\"\n"
        )
    };
    let mixes: String = (1..40).map(mix).collect();
    let text = format!(
        "Camera \"perspective\" WorldBegin Texture \"0\" \"spectrum\" \"dots\"\n{mixes}Material \"diffuse\" \"texture reflectance\" \"39\" Shape \"sphere\"\n"
    );
    assert!(problems("scene.pbrt", &text).contains("takes more than 4096 lookups"));
}

/// A tree over a hundred thousand equal triangles is built as fast as over as many different ones.
#[test]
fn equal_triangles_do_not_stop_the_builder() {
    let face = "f 1 2 3\n".repeat(100_000);
    for vertices in ["v 0 0 0\nv 1 0 0\nv 0 1 0\n", "v 0 0 0\nv 0 0 0\nv 0 0 0\n"] {
        let mesh = format!("{vertices}{face}");
        let body = format!(
            "{}<shape type='obj'><string name='filename' value='m.obj'/></shape>",
            camera("0,0,3", "0,0,0", 40.0, 4)
        );
        let begun = Instant::now();
        crate::support::scene_with(&body, &[("m.obj", &mesh)]);
        // 0.1 s on an idle machine; merging equal boxes pair by pair takes minutes.
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    }
}

/// A NanoVDB file of three kilobytes whose box has three thousand million points: it takes memory for what it holds.
#[test]
fn a_small_file_of_a_vast_volume_stays_small() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("formats/tests/readers/volumes");
    let file = std::fs::read(folder.join("float.nvdb")).unwrap();
    let word = |bytes: &[u8], at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    // A header, what the file says of the grid, its name; then a length, and the grid packed.
    let (header, meta) = (16, 176);
    let start =
        header + meta + u32::from_le_bytes(file[header + 136..header + 140].try_into().unwrap()) as usize;
    let mut grid = Vec::new();
    let packed = flate2::read::ZlibDecoder::new(&file[start + 8..start + 8 + word(&file, start)]);
    std::io::Read::read_to_end(&mut { packed }, &mut grid).unwrap();
    // The upper corner of the box, at the root of the tree.
    let root = 672 + word(&grid, 672 + 24);
    for axis in 0..3 {
        grid[root + 12 + 4 * axis..][..4].copy_from_slice(&1440i32.to_le_bytes());
    }
    let mut vast = file[..start].to_vec();
    vast[14..16].copy_from_slice(&0u16.to_le_bytes());
    vast[header + 8..header + 16].copy_from_slice(&(grid.len() as u64).to_le_bytes());
    vast.extend(grid);
    let world = r#"LightSource "infinite" "rgb L" [ 1 1 1 ]
        MakeNamedMedium "smoke" "string type" "nanovdb" "string filename" "a.nvdb"
            "rgb sigma_a" [ 1 1 1 ] "rgb sigma_s" [ 0 0 0 ]
        AttributeBegin MediumInterface "smoke" "" Material "interface" Shape "sphere" "float radius" 900 AttributeEnd"#;
    let view = r#"LookAt 1 2.5 -2000  1 2.5 4  0 1 0 Camera "perspective" "float fov" 0.05
        Film "rgb" "integer xresolution" 8 "integer yresolution" 8"#;
    let stage = crate::support::pbrt_scene_seen(view, world, vec![("a.nvdb", vast)]);
    let picture = render(&stage, &[("integrator", "path")], 4);
    assert_finite(&picture);
    // Some rays meet what the file holds.
    let mean = picture.beauty(0).mean;
    assert!(mean > 0.1 && mean < 0.999, "{mean}");
}
