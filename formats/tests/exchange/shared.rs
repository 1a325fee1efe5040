//! Objects that refer twice to the one below, forty levels deep: 2^40 paths through a few kilobytes. Each test
//! ends only if every object is looked at once.

use std::fmt::Write;
use std::path::Path;

use caustica_formats::files::Memory;
use caustica_formats::ir::{BsdfKind, Query, uses_textures};
use caustica_formats::{Read, ReadOptions, Written, read_scene, write_scene};

use crate::round_trip::placed;

const LEVELS: usize = 40;

fn memory(name: &str, text: &str) -> Memory {
    Memory([(name.into(), text.as_bytes().to_vec())].into_iter().collect())
}

pub fn read(name: &str, text: &str) -> Read {
    read_scene(&memory(name, text), Path::new(name), &ReadOptions::default()).expect("a valid scene")
}

/// Into both languages.
pub fn written(scene: &Read) -> [Written; 2] {
    let files = memory("", "");
    ["new.xml", "new.pbrt"]
        .map(|name| write_scene(scene, &files, Path::new(name)).expect("it can be written"))
}

/// `top` is the material of the only shape, `base` what all blends are made of.
fn mitsuba(base: &str, top: &str) -> String {
    let mut text = format!("<scene version='3.0.0'>{base}");
    for level in 1..=LEVELS {
        let below = level - 1;
        let refs = format!("<ref id='m{below}'/><ref id='m{below}'/>");
        write!(text, "<bsdf type='blendbsdf' id='m{level}'><float name='weight' value='0.25'/>{refs}</bsdf>")
            .expect("a string takes all");
    }
    format!("{text}<emitter type='constant'/><shape type='sphere'>{top}</shape></scene>")
}

fn pbrt(base: &str, level: impl Fn(usize, usize) -> String, shape: &str) -> String {
    let levels: String = (1..=LEVELS).map(|n| level(n, n - 1)).collect();
    format!("WorldBegin\nLightSource \"infinite\"\n{base}\n{levels}{shape}\n")
}

#[test]
fn two_sided_over_doubled_blends_is_read_and_written() {
    let top = format!("<bsdf type='twosided'><ref id='m{LEVELS}'/></bsdf>");
    let scene = read("s.xml", &mitsuba("<bsdf type='diffuse' id='m0'/>", &top));
    assert_eq!(scene.scene.bsdfs.len(), LEVELS + 2);
    assert!(!uses_textures(&scene.scene, &scene.scene.shapes[0]));
    let [xml, pbrt] = written(&scene);
    assert_eq!(xml.text.matches("blendbsdf").count(), LEVELS);
    assert_eq!(pbrt.text.matches("\"mix\"").count(), LEVELS);
}

#[test]
fn glass_under_doubled_blends_is_still_found() {
    let top = format!("<bsdf type='twosided'><ref id='m{LEVELS}'/></bsdf>");
    let text = mitsuba("<bsdf type='dielectric' id='m0'/>", &top);
    let failure = read_scene(&memory("s.xml", &text), Path::new("s.xml"), &ReadOptions::default())
        .expect_err("glass is not two-sided");
    assert_eq!(failure.diagnostics.len(), 1, "{failure}");
    let scene = read("s.xml", &text.replace("<bsdf type='twosided'>", "<bsdf type='mask'>")).scene;
    let nature = Query::default().bsdf(&scene.bsdfs, scene.shapes[0].bsdf.expect("it has one"));
    assert!(nature.transmits && !nature.textured && !nature.anisotropic);
}

#[test]
fn doubled_mixes_of_pbrt_are_read_and_written() {
    let mix = |level: usize, below: usize| {
        format!(
            "MakeNamedMaterial \"m{level}\" \"string type\" \"mix\" \
             \"string materials\" [\"m{below}\" \"m{below}\"] \"float amount\" 0.25\n"
        )
    };
    let base = "MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"";
    let shape = format!("NamedMaterial \"m{LEVELS}\"\nShape \"disk\" \"float radius\" 2");
    let scene = read("s.pbrt", &pbrt(base, mix, &shape));
    let blends = scene.scene.bsdfs.iter().filter(|(_, bsdf)| matches!(bsdf.kind, BsdfKind::Blend { .. }));
    assert_eq!(blends.count(), LEVELS);
    let [xml, pbrt] = written(&scene);
    assert_eq!(xml.text.matches("blendbsdf").count(), LEVELS);
    assert_eq!(pbrt.text.matches("\"mix\"").count(), LEVELS);
}

/// A doubled texture of `kind`, with and without a factor around it.
fn doubled_textures(kind: &str, parts: [&str; 2]) -> [Written; 2] {
    let [a, b] = parts;
    let level = |level: usize, below: usize| {
        format!(
            "Texture \"t{level}\" \"spectrum\" \"{kind}\" \"texture {a}\" \"t{below}\" \
             \"texture {b}\" \"t{below}\"\n"
        )
    };
    let base = "Texture \"t0\" \"spectrum\" \"checkerboard\"";
    let shape = format!(
        "Texture \"half\" \"spectrum\" \"scale\" \"texture tex\" \"t{LEVELS}\" \"float scale\" 0.5\n\
         Material \"diffuse\" \"texture reflectance\" \"t{LEVELS}\"\nShape \"disk\"\n\
         Material \"diffuse\" \"texture reflectance\" \"half\"\nShape \"sphere\""
    );
    let scene = read("s.pbrt", &pbrt(base, level, &shape));
    assert!(scene.scene.shapes.iter().all(|shape| uses_textures(&scene.scene, shape)));
    written(&scene)
}

#[test]
fn doubled_textures_are_written() {
    let [xml, pbrt] = doubled_textures("checkerboard", ["tex1", "tex2"]);
    assert_eq!(pbrt.text.matches("\"checkerboard\"").count(), LEVELS + 1);
    assert!(xml.text.len() < 1_000_000, "{} bytes", xml.text.len());
    assert!(xml.losses.iter().any(|loss| loss.what == "a factor on a very large tree of textures"));
    let [_, pbrt] = doubled_textures("mix", ["tex1", "tex2"]);
    assert_eq!(pbrt.text.matches("\"mix\"").count(), LEVELS);
}

/// pbrt's mixes in a chain: deep ones are refused, because whoever follows them is recursive.
#[test]
fn long_chains_of_mixes_are_refused() {
    let chain = |length: usize| {
        let base = "MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"";
        let levels: String = (1..=length)
            .map(|level| {
                let parts = format!("[\"m{}\" \"m0\"]", level - 1);
                format!(
                    "MakeNamedMaterial \"m{level}\" \"string type\" \"mix\" \"string materials\" {parts}\n"
                )
            })
            .collect();
        let text = format!(
            "WorldBegin\nLightSource \"infinite\"\n{base}\n{levels}NamedMaterial \"m{length}\"\nShape \"disk\""
        );
        read_scene(&memory("s.pbrt", &text), Path::new("s.pbrt"), &ReadOptions::default())
    };
    let [_, pbrt] = written(&chain(255).expect("a chain that may be followed"));
    assert_eq!(pbrt.text.matches("\"mix\"").count(), 255);
    let failure = chain(2000).expect_err("a chain that is too long");
    assert_eq!(failure.diagnostics[0].message, "materials refer to each other more than 256 deep");
}

/// What Mitsuba 3 lacks is written as the model below it, and that may be shared and have an id of its own.
#[test]
fn a_coating_over_a_shared_metal_is_written_as_a_copy() {
    let text = "<scene version='0.6.0'><bsdf type='conductor' id='metal'/>\
         <bsdf type='coating' id='coated'><ref id='metal'/></bsdf><emitter type='constant'/>\
         <shape type='sphere'><ref id='coated'/></shape><shape type='cube'><ref id='metal'/></shape></scene>";
    let [xml, _] = written(&read("s.xml", text));
    assert_eq!(xml.text.matches("<bsdf type=\"conductor\"").count(), 2, "{}", xml.text);
    let again = read("new.xml", &xml.text).scene;
    let kinds = again.shapes.iter().map(|shape| &again.bsdfs[shape.bsdf.expect("a material")].kind);
    assert!(kinds.into_iter().all(|kind| matches!(kind, BsdfKind::Conductor(_))));
}

/// Mitsuba 3 takes the colours of a checkerboard one for the other where it wants a number (3.9.1: the opacity of a mask).
/// pbrt does not, so they are exchanged on the way there and on the way back; those of a colour stay.
#[test]
fn checkerboards_of_numbers_are_exchanged() {
    let leaf = "Film \"rgb\" Camera \"perspective\" WorldBegin LightSource \"infinite\"
        Texture \"holes\" \"float\" \"checkerboard\" \"float tex1\" 0.1 \"float tex2\" 0.9
        Texture \"cells\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [0.1 0.1 0.1] \"rgb tex2\" [0.9 0.9 0.9]
        Material \"diffuse\" \"texture reflectance\" \"cells\" Shape \"sphere\" \"texture alpha\" \"holes\"";
    let read = |files: &Memory, name: &str| {
        read_scene(files, Path::new(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
    };
    let first = memory("leaf.pbrt", leaf);
    let there = write_scene(&read(&first, "leaf.pbrt"), &first, Path::new("leaf.xml")).unwrap();
    let one_line = there.text.split_whitespace().collect::<Vec<_>>().join(" ");
    for said in [
        "name=\"opacity\"> <float name=\"color1\" value=\"0.1\"/> <float name=\"color0\" value=\"0.9\"/>",
        "id=\"cells\"> <rgb name=\"color0\" value=\"0.1\"/> <rgb name=\"color1\" value=\"0.9\"/>",
    ] {
        assert!(one_line.contains(said), "{said}\n{}", there.text);
    }
    let second = placed(&there, first);
    let back = write_scene(&read(&second, "leaf.xml"), &second, Path::new("again.pbrt")).unwrap();
    assert!(back.text.contains("\"float tex1\" 0.1 \"float tex2\" 0.9"), "{}", back.text);
    assert!(back.text.contains("\"rgb tex1\" [0.1 0.1 0.1] \"rgb tex2\" [0.9 0.9 0.9]"), "{}", back.text);
}
