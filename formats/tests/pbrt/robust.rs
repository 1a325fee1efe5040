//! No bytes make the reader panic or run away.

use std::path::Path;

use caustica_formats::files::Memory;
use caustica_formats::{ReadOptions, diagnostic, read_scene};

use crate::{files, gzip, problems};

const SCENE: &str = r#"Scale -1 1 1 LookAt 0 -5 1  0 0 0  0 0 1 # camera
Camera "perspective" "float fov" [ 40 ] "float lensradius" .1 "float focaldistance" 5
Film "rgb" "integer xresolution" 8 "integer yresolution" [ 6 ] "string filename" "a.exr" "float cropwindow" [0 .5 0 1]
Sampler "halton" "integer pixelsamples" 4 PixelFilter "mitchell" Option "seed" 3 ColorSpace "rec2020"
Integrator "sppm" "integer maxdepth" 7 "float radius" .1
WorldBegin
Attribute "shape" "float radius" 2
Texture "t" "spectrum" "checkerboard" "rgb tex1" [.1 .2 .3] "float uscale" 4
Texture "f" "float" "fbm" "integer octaves" 3
MakeNamedMaterial "m" "string type" "coateddiffuse" "texture reflectance" "t" "texture roughness" "f"
Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" [400 2 700 3]
ObjectBegin "o" Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2] ObjectEnd
AttributeBegin Rotate 30 1 0 0 ObjectInstance "o" AttributeEnd
AttributeBegin ReverseOrientation AreaLightSource "diffuse" "blackbody L" 5000 "bool twosided" true
NamedMaterial "m" Shape "sphere" AttributeEnd
Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 1]
Shape "loopsubdiv" "integer levels" 2 "point3 P" [0 0 0 1 0 0 0 1 0 1 1 1] "integer indices" [0 1 2 1 3 2]
LightSource "spot" "rgb I" [1 1 1] "float power" 5 "point3 from" [1 2 3]
Include "ball.pbrt"
"#;

fn read(bytes: Vec<u8>) -> bool {
    let Memory(mut map) = files("");
    map.insert("scene.pbrt".into(), bytes);
    let options = ReadOptions::default();
    let result = read_scene(&Memory(map), Path::new("scene.pbrt"), &options);
    // Rendering must survive every span as well.
    result.map_err(|failure| failure.to_string()).map(|r| r.sources.render(&r.warnings)).is_ok()
}

#[test]
fn the_scene_itself_is_accepted() {
    assert!(read(SCENE.into()), "{:?}", problems(SCENE));
}

#[test]
fn truncation_at_every_byte() {
    for end in 0..SCENE.len() {
        read(SCENE.as_bytes()[..end].to_vec());
    }
}

#[test]
fn flipped_and_replaced_bytes() {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    for _ in 0..3000 {
        let mut bytes = SCENE.as_bytes().to_vec();
        for _ in 0..=random() % 4 {
            let at = random() % bytes.len();
            match random() % 3 {
                0 => bytes[at] ^= 1 << (random() % 8),
                1 => bytes[at] = b"[]\"\\#\0 -.e9\xff"[random() % 12],
                _ => {
                    let from = random() % bytes.len();
                    bytes[at] = bytes[from];
                }
            }
        }
        read(bytes);
    }
}

#[test]
fn compressed_scenes_and_bombs() {
    let mut map = files("").0;
    map.insert("s.pbrt.gz".into(), gzip(SCENE.as_bytes()));
    map.insert("bomb.pbrt.gz".into(), gzip(&vec![b' '; 50 << 20]));
    let files = Memory(map);
    assert!(read_scene(&files, Path::new("s.pbrt.gz"), &ReadOptions::default()).is_ok());
    let bomb = read_scene(&files, Path::new("bomb.pbrt.gz"), &ReadOptions::default()).unwrap_err();
    assert!(bomb.to_string().contains("unpacks to more than"), "{bomb}");
}

/// Twenty files that include the next one three times each.
#[test]
fn includes_that_multiply_are_refused() {
    let mut map = files("").0;
    map.insert("scene.pbrt".into(), b"Include \"0.pbrt\"".to_vec());
    for i in 0..20 {
        let text = format!("Include \"{}.pbrt\"\n", i + 1).repeat(3);
        map.insert(format!("{i}.pbrt").into(), text.into_bytes());
    }
    map.insert("20.pbrt".into(), Vec::new());
    let failure = read_scene(&Memory(map), Path::new("scene.pbrt"), &ReadOptions::default()).unwrap_err();
    let told: Vec<&str> = failure.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert!(
        matches!(told[..], [only] if only.contains("files included again and again add up to more than")),
        "{told:?}"
    );
}

/// Depth and size are limited, not the number.
#[test]
fn twenty_thousand_includes_are_read() {
    let mut map = files("").0;
    let text = format!("WorldBegin\n{}", "Include \"part.pbrt\"\n".repeat(20_000));
    map.insert("scene.pbrt".into(), text.into_bytes());
    map.insert("part.pbrt".into(), b"Shape \"sphere\"".to_vec());
    let read = read_scene(&Memory(map), Path::new("scene.pbrt"), &ReadOptions::default()).unwrap();
    assert_eq!(read.scene.shapes.len(), 20_000);
}

/// A file of a megabyte, included over and over; and a mesh that would be subdivided to twenty million triangles.
#[test]
fn what_multiplies_is_refused() {
    let mut map = files("").0;
    map.insert("scene.pbrt".into(), "Include \"part.pbrt\"\n".repeat(1000).into_bytes());
    map.insert("part.pbrt".into(), "Translate 0 0 0\n".repeat(64_000).into_bytes());
    let failure = read_scene(&Memory(map), Path::new("scene.pbrt"), &ReadOptions::default()).unwrap_err();
    let told =
        |d: &diagnostic::Diagnostic| d.message.contains("files included again and again add up to more than");
    assert!(failure.diagnostics.iter().any(told), "{:?}", failure.diagnostics.first());

    let shape = "Shape \"loopsubdiv\" \"integer levels\" 8 \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]";
    let told = problems(&format!("WorldBegin {shape} \"integer indices\" [{}]", "0 1 2 ".repeat(300)));
    assert!(told.iter().any(|p| p.contains("8 levels of subdivision make too many triangles")), "{told:?}");
}
