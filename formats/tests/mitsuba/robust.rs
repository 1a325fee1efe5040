//! No bytes make the reader panic or run away.

use std::path::Path;

use caustica_formats::files::Memory;
use caustica_formats::{ReadOptions, read_scene};

use crate::{files, headlines};

const SCENE: &str = r##"<?xml version="1.0"?><!-- c -->
<scene version="0.6.0"><default name="n" value="4"/><path value="p"/>
<integrator type="photonmapper"><integer name="maxDepth" value="$n"/></integrator>
<sensor type="thinlens"><float name="apertureRadius" value=".1"/><transform name="toWorld">
<lookAt origin="0,0,5" target="0 0 0" up="0 1 0"/><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform>
<film type="hdrfilm"><integer name="width" value="8"/><rfilter type="box"/></film></sensor>
<bsdf type="mask" id="m"><texture type="bitmap" name="opacity"><string name="filename" value="wood.png"/></texture>
<bsdf type="roughconductor"><spectrum name="eta" value="400:1, 700:2"/><srgb name="k" value="#ff8000"/></bsdf></bsdf>
<shape type="shapegroup" id="g"><shape type="obj"><string name="filename" value="mesh.obj"/><ref id="m"/></shape></shape>
<shape type="instance"><ref id="g"/><transform name="toWorld"><rotate y="1" angle="3"/><scale value="2"/></transform></shape>
<alias id="m" as="&lt;q&gt;"/><emitter type="point"><blackbody name="intensity" temperature="5000K"/></emitter>
<shape type="sphere"><point name="center" x="1" y="2" z="3"/><emitter type="area"/><ref name="bsdf" id="m"/></shape></scene>"##;

fn read(bytes: Vec<u8>) -> bool {
    let Memory(mut map) = files("", &[]);
    map.insert("scene.xml".into(), bytes);
    let result = read_scene(&Memory(map), Path::new("scene.xml"), &ReadOptions::default());
    // Rendering must survive every span as well.
    result.map_err(|failure| failure.to_string()).map(|r| r.sources.render(&r.warnings)).is_ok()
}

#[test]
fn the_scene_itself_is_accepted() {
    assert!(read(SCENE.into()), "{:?}", headlines(SCENE));
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
                1 => bytes[at] = b"<>\"'&;$\0 =/\xff"[random() % 12],
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
fn deep_nesting_is_refused() {
    let open = "<bsdf type='twosided'>".repeat(100_000);
    assert_eq!(
        headlines(&format!("<scene version='3.0.0'>{open}")),
        ["elements are nested more than 256 deep"]
    );
}

#[test]
fn long_chains_of_references_are_refused() {
    for forwards in [true, false] {
        let link = |i: usize| format!("<bsdf type='twosided' id='{i}'><ref id='{}'/></bsdf>", i + 1);
        let mut links: Vec<String> = (0..5000).map(link).collect();
        links.push("<bsdf type='diffuse' id='5000'/>".to_owned());
        if !forwards {
            links.reverse();
        }
        let found = headlines(&format!("<scene version='3.0.0'>{}</scene>", links.concat()));
        assert!(found.contains(&"objects refer to each other more than 256 deep".to_owned()), "{found:?}");
    }
}

#[test]
fn definitions_that_double_are_refused() {
    let doubles: String =
        (1..64).map(|i| format!("<default name='a{i:02}' value='$a{:02}$a{:02}'/>", i - 1, i - 1)).collect();
    let text = format!("<scene version='3.0.0'><default name='a00' value='xxxxxxxx'/>{doubles}</scene>");
    assert!(headlines(&text).contains(&"the value becomes too long by `$` substitution".to_owned()));
}

/// A value that doubles twenty times, used over and over; and a file of a megabyte, likewise.
#[test]
fn what_multiplies_is_refused() {
    let mut text = "<scene version='3.0.0'><default name='a' value='0123456789abcdef'/>".to_owned();
    let mut name = 'a';
    for next in 'b'..='s' {
        text.push_str(&format!("<default name='{next}' value='${name}${name}'/>"));
        name = next;
    }
    text.push_str(&format!("<bsdf type='diffuse' id='${name}'/>").repeat(1000));
    let found = headlines(&(text + "</scene>"));
    assert!(found.contains(&"the value becomes too long by `$` substitution".to_owned()));

    let part = format!("<scene version='3.0.0'>{}</scene>", "<bsdf type='diffuse'/>".repeat(50_000));
    let scene = format!("<scene version='3.0.0'>{}</scene>", "<include filename='part.xml'/>".repeat(1000));
    let memory =
        Memory([("scene.xml".into(), scene.into_bytes()), ("part.xml".into(), part.into_bytes())].into());
    let failure = read_scene(&memory, Path::new("scene.xml"), &ReadOptions::default()).unwrap_err();
    let first = &failure.diagnostics[0].message;
    assert!(first.contains("files included again and again add up to more than"), "{first}");
}

/// Depth and size are limited, not the number.
#[test]
fn twenty_thousand_includes_are_read() {
    let scene = format!("<scene version='3.0.0'>{}</scene>", "<include filename='part.xml'/>".repeat(20_000));
    let part = b"<shape type='sphere'/>".to_vec();
    let memory = Memory([("scene.xml".into(), scene.into_bytes()), ("part.xml".into(), part)].into());
    let read = read_scene(&memory, Path::new("scene.xml"), &ReadOptions::default()).unwrap();
    assert_eq!(read.scene.shapes.len(), 20_000);
}

/// Ten files that include the next one ten times each.
#[test]
fn includes_that_multiply_are_refused_once() {
    let text = |i: usize| {
        format!("<scene version='3.0.0'>{}</scene>", format!("<include filename='{i}.xml'/>").repeat(10))
    };
    let files = (0..10).map(|i| (format!("{i}.xml").into(), text(i + 1).into_bytes()));
    let ends =
        [("scene.xml".into(), text(0).into_bytes()), ("10.xml".into(), b"<scene version='3.0.0'/>".to_vec())];
    let memory = Memory(files.chain(ends).collect());
    let failure = read_scene(&memory, Path::new("scene.xml"), &ReadOptions::default()).unwrap_err();
    let told: Vec<&str> = failure.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert!(
        matches!(told[..], [only] if only.contains("files included again and again add up to more than")),
        "{told:?}"
    );
}
