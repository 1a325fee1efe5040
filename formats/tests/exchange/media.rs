//! Media in both languages, and from one to the other.

use std::path::{Path, PathBuf};

use caustica_formats::files::Memory;
use caustica_formats::ir::{
    Coefficients, Color, Medium, Phase, Scene, Volume, VolumeData, VolumeFormat, canonical,
};
use caustica_formats::{Read, ReadOptions, Written, read_scene, volume, write_scene};

use crate::round_trip::placed;

fn vol(resolution: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let head = [1, resolution[0], resolution[1], resolution[2], channels];
    bytes.extend(head.into_iter().flat_map(i32::to_le_bytes));
    bytes.extend([-1.0f32, 0.0, 0.0, 1.0, 1.0, 3.0].into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

fn files(name: &str, text: &str) -> Memory {
    let densities: Vec<f32> = (0..8).map(|i| i as f32).collect();
    let colours: Vec<f32> = (0..24).map(|i| i as f32 / 24.0).collect();
    let nvdb = include_bytes!("../readers/volumes/two.nvdb");
    let all = [
        (name, text.as_bytes().to_vec()),
        ("smoke.vol", vol([2, 2, 2], 1, &densities)),
        ("tint.vol", vol([2, 2, 2], 3, &colours)),
        ("fire.nvdb", nvdb.to_vec()),
    ];
    Memory(all.into_iter().map(|(name, bytes)| (PathBuf::from(name), bytes)).collect())
}

fn read(name: &str, text: &str) -> (Read, Memory) {
    let files = files(name, text);
    let read = read_scene(&files, Path::new(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    (read, files)
}

/// Written to `to` and read again, with the losses.
fn copied((scene, files): (Read, Memory), to: &str) -> (Written, Read, Memory) {
    let written = write_scene(&scene, &files, Path::new(to)).unwrap_or_else(|e| panic!("{e}"));
    let files = placed(&written, files);
    let again = read_scene(&files, &written.path, &ReadOptions::default());
    let again = again.unwrap_or_else(|e| panic!("{e}\n{}", written.text));
    (written, again, files)
}

fn media(scene: &Scene) -> Vec<Medium> {
    canonical(scene).media.iter().map(|(_, medium)| medium.clone()).collect()
}

fn what(written: &Written) -> Vec<&str> {
    written.losses.iter().map(|loss| loss.what.as_str()).collect()
}

const MITSUBA: &str = "<scene version='3.0.0'>
    <medium type='homogeneous' id='fog'><rgb name='sigma_t' value='.1, .2, .3'/><float name='scale' value='10'/><float name='albedo' value='.5'/>
        <phase type='hg'><float name='g' value='.4'/></phase></medium>
    <medium type='heterogeneous' id='smoke'><float name='scale' value='20'/>
        <volume name='sigma_t' type='gridvolume'><string name='filename' value='smoke.vol'/>
            <boolean name='use_grid_bbox' value='true'/><transform name='to_world'><scale value='2'/></transform></volume>
        <volume name='albedo' type='gridvolume'><string name='filename' value='tint.vol'/>
            <string name='filter_type' value='nearest'/><string name='wrap_mode' value='mirror'/></volume>
        <phase type='blendphase'><float name='weight' value='.25'/><phase type='rayleigh'/>
            <phase type='tabphase'><string name='values' value='1, 2, 4'/></phase></phase></medium>
    <medium type='heterogeneous' id='cube'><rgb name='sigma_t' value='.1, .2, .3'/></medium>
    <sensor type='perspective'><ref id='fog'/></sensor>
    <emitter type='point'><ref id='fog'/></emitter>
    <shape type='sphere'><bsdf type='dielectric'/><ref name='interior' id='smoke'/><ref name='exterior' id='fog'/></shape>
    <shape type='cube'><bsdf type='null'/><ref name='interior' id='cube'/></shape></scene>";

const PBRT: &str = "MediumInterface \"\" \"fog\" Camera \"perspective\" MediumInterface \"\" \"\" WorldBegin
    MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [3 2 1] \"float scale\" 2
        \"float g\" .3 \"rgb Le\" [1 2 3] \"float Lescale\" 5
    Translate 1 2 3
    MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" [3 3 3]
        \"integer nx\" 2 \"float density\" [1 2] \"float temperature\" [500 900] \"float Lescale\" [1 .5]
        \"point3 p0\" [-1 -1 -1] \"float temperatureoffset\" 10
    MakeNamedMedium \"tinted\" \"string type\" \"rgbgrid\" \"integer ny\" 2 \"rgb sigma_a\" [1 2 3 4 5 6]
        \"rgb sigma_s\" [6 5 4 3 2 1] \"rgb Le\" [1 0 0 0 1 0] \"float Lescale\" .5 \"float scale\" 3
    MakeNamedMedium \"cloud\" \"string type\" \"cloud\" \"rgb sigma_a\" [0 0 0] \"rgb sigma_s\" [4 4 4] \"float wispiness\" 2
    MakeNamedMedium \"fire\" \"string type\" \"nanovdb\" \"string filename\" \"fire.nvdb\" \"rgb sigma_a\" [2 2 2]
        \"rgb sigma_s\" [0 0 0] \"float temperaturescale\" 3 \"float Lescale\" 2
    AttributeBegin MediumInterface \"\" \"fog\" LightSource \"point\" AttributeEnd
    MediumInterface \"smoke\" \"fog\" Shape \"sphere\" MediumInterface \"tinted\" \"\" Shape \"sphere\"
    MediumInterface \"cloud\" \"\" Shape \"sphere\" MediumInterface \"fire\" \"\" Material \"interface\" Shape \"sphere\"";

/// Each language says all of what it has: the copy is equal.
#[test]
fn media_survive_their_own_language() {
    for (name, text, to) in [("scene.xml", MITSUBA, "copy.xml"), ("scene.pbrt", PBRT, "copy.pbrt")] {
        let original = read(name, text);
        let before = media(&original.0.scene);
        let sides = |scene: &Scene| -> Vec<_> { canonical(scene).shapes.iter().map(|s| s.media).collect() };
        let around =
            |scene: &Scene| (canonical(scene).sensors[0].medium, canonical(scene).emitters[0].medium);
        let (of_shapes, of_others) = (sides(&original.0.scene), around(&original.0.scene));
        let (written, again, _) = copied(original, to);
        let losses: Vec<_> = what(&written).into_iter().filter(|w| !w.contains("sampler")).collect();
        assert!(losses.is_empty(), "{losses:?}");
        let after = media(&again.scene);
        assert_eq!(before.len(), if name == "scene.xml" { 3 } else { 5 });
        for (a, b) in before.iter().zip(&after) {
            assert_eq!(a, b, "{}", written.text);
        }
        assert_eq!((of_shapes, of_others), (sides(&again.scene), around(&again.scene)), "{}", written.text);
    }
}

/// Mitsuba 3 takes no colour above 1, in media neither: what is more goes into the scale.
#[test]
fn a_coloured_extinction_above_1_is_written_as_mitsuba_takes_it() {
    let text = "<scene version='0.6.0'><medium type='homogeneous' id='fog'>
        <rgb name='sigmaA' value='1, 2, 3'/><rgb name='sigmaS' value='1, 2, 5'/></medium>
        <shape type='cube'><ref name='interior' id='fog'/></shape></scene>";
    let (written, again, _) = copied(read("scene.xml", text), "copy.xml");
    let medium = &media(&again.scene)[0];
    let Coefficients::Extinction { sigma_t, albedo } = &medium.coefficients else {
        panic!("{}", written.text)
    };
    assert!(constant(sigma_t).into_iter().all(|v| v <= 1.0), "{}", written.text);
    for (c, (absorbed, scattered)) in [(1.0, 1.0), (2.0, 2.0), (3.0, 5.0)].into_iter().enumerate() {
        let extinction = medium.scale * constant(sigma_t)[c];
        assert!((extinction - absorbed - scattered).abs() < 1e-9, "{}", written.text);
        assert!((extinction * constant(albedo)[c] - scattered).abs() < 1e-9, "{}", written.text);
    }
}

fn named<'a>(media: &'a [Medium], name: &str) -> &'a Medium {
    media.iter().find(|medium| medium.name.as_deref() == Some(name)).unwrap()
}

fn constant(volume: &Volume) -> [f64; 3] {
    match volume {
        Volume::Constant(Color::Rgb(rgb)) => *rgb,
        Volume::Constant(Color::Gray(v)) => [*v; 3],
        other => panic!("{other:?}"),
    }
}

#[test]
fn from_mitsuba_to_pbrt() {
    let (written, again, _) = copied(read("scene.xml", MITSUBA), "copy.pbrt");
    let media = media(&again.scene);
    let fog = named(&media, "fog");
    let Coefficients::Parts { sigma_a, sigma_s } = &fog.coefficients else { panic!() };
    assert_eq!((constant(sigma_a), constant(sigma_s)), ([0.05, 0.1, 0.15], [0.05, 0.1, 0.15]));
    assert_eq!(fog.scale, 10.0);
    assert_eq!(fog.phase, Phase::HenyeyGreenstein { g: 0.4 });
    // A quarter of it is the table; the rest, Rayleigh's, has a mean cosine of 0.
    let smoke = named(&media, "smoke");
    assert!(!smoke.is_homogeneous());
    let g = 0.25 * mean_cosine(&[1.0, 2.0, 4.0]);
    let Phase::HenyeyGreenstein { g: found } = smoke.phase else { panic!() };
    // In a million steps.
    assert!((found - g).abs() < 1e-9, "{found} {g}");
    let lost = what(&written);
    for said in ["a phase function of kind `blend`", "extinction and albedo vary", "outermost values last"] {
        assert!(lost.iter().any(|w| w.contains(said)), "{said}: {lost:?}");
    }
}

/// What is computed of decimal numbers is written without the noise of their last digits, both ways.
#[test]
fn sums_are_written_as_decimals() {
    let fog =
        "<scene version='3.0.0'><medium type='homogeneous' id='fog'><rgb name='sigma_t' value='.5, .12, 1'/>
        <rgb name='albedo' value='.9, .8, .998'/></medium>
        <shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/></shape></scene>";
    let (written, again, files) = copied(read("scene.xml", fog), "copy.pbrt");
    for said in ["\"rgb sigma_a\" [0.05 0.024 0.002]", "\"rgb sigma_s\" [0.45 0.096 0.998]"] {
        assert!(written.text.contains(said), "{}", written.text);
    }
    let (written, ..) = copied((again, files), "copy.xml");
    for said in ["name=\"sigma_t\" value=\"0.5, 0.12, 1\"", "name=\"albedo\" value=\"0.9, 0.8, 0.998\""] {
        assert!(written.text.contains(said), "{}", written.text);
    }
}

/// Of a table by its definition, in many small steps.
fn mean_cosine(values: &[f64]) -> f64 {
    let (mut sum, mut first) = (0.0, 0.0);
    let steps = 1_000_000;
    for i in 0..steps {
        let mu = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(steps);
        let at = (mu + 1.0) / 2.0 * (values.len() - 1) as f64;
        let cell = (at as usize).min(values.len() - 2);
        let value = values[cell] + (values[cell + 1] - values[cell]) * (at - cell as f64);
        (sum, first) = (sum + value, first + value * mu);
    }
    first / sum
}

#[test]
fn from_pbrt_to_mitsuba() {
    let (written, again, files) = copied(read("scene.pbrt", PBRT), "copy.xml");
    let media = media(&again.scene);
    let fog = named(&media, "fog");
    let Coefficients::Extinction { sigma_t, albedo } = &fog.coefficients else { panic!() };
    assert_eq!((constant(sigma_t), constant(albedo), fog.scale), ([4.0; 3], [0.75, 0.5, 0.25], 2.0));
    let smoke = named(&media, "smoke");
    let Coefficients::Extinction { sigma_t: Volume::Grid(grid), albedo } = &smoke.coefficients else {
        panic!()
    };
    assert_eq!((constant(albedo), smoke.scale), ([0.75; 3], 4.0));
    let VolumeData::File(file) = &grid.data else { panic!() };
    let values = volume::read(&files.0[&file.path], &VolumeFormat::Vol).unwrap();
    assert_eq!((values.value([0; 3], 0), values.value([1, 0, 0], 0)), (1.0, 2.0));
    // The box of p0 and p1 as the transform gave it.
    assert_eq!(grid.to_world.point([0.0; 3]), [0.0, 1.0, 2.0]);
    assert_eq!(grid.to_world.point([1.0; 3]), [2.0, 3.0, 4.0]);
    let lost = what(&written);
    for said in
        ["light that a medium emits", "procedural cloud", "vary in colour", "ends at its outermost values"]
    {
        assert!(lost.iter().any(|w| w.contains(said)), "{said}: {lost:?}");
    }
    let tinted = named(&media, "tinted");
    let Coefficients::Extinction { sigma_t: Volume::Grid(grid), .. } = &tinted.coefficients else { panic!() };
    let VolumeData::File(file) = &grid.data else { panic!() };
    let values = volume::read(&files.0[&file.path], &VolumeFormat::Vol).unwrap();
    assert_eq!([0, 1, 2].map(|c| values.value([0, 1, 0], c)), [21.0; 3]);
}

/// A scene with fog is converted to an integrator that renders fog, where it had one: most of Mitsuba's and of pbrt's
/// look through it.
#[test]
fn integrators_render_the_media_that_they_rendered() {
    let pbrt = |integrator: &str| {
        format!(
            "{integrator} Film \"rgb\" Camera \"perspective\" WorldBegin LightSource \"infinite\"
             MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" AttributeBegin MediumInterface \"fog\" \"\"
             Material \"interface\" Shape \"sphere\" AttributeEnd"
        )
    };
    let mitsuba = |version: &str, integrator: &str| {
        format!(
            "<scene version='{version}'>{integrator}<medium type='homogeneous' id='fog'/>
             <emitter type='constant'/><sensor type='perspective'/><shape type='sphere'><ref name='interior' id='fog'/>
             </shape></scene>"
        )
    };
    let photons = "<integrator type='photonmapper'/>";
    let by = |plugin: &str| format!("<integrator type=\"{plugin}\"");
    let to = |plugin: &str| format!("Integrator \"{plugin}\"");
    let cases = [
        ("scene.pbrt", pbrt(""), "copy.xml", by("volpath")),
        ("scene.pbrt", pbrt("Integrator \"volpath\""), "copy.xml", by("volpath")),
        ("scene.pbrt", pbrt("Integrator \"bdpt\""), "copy.xml", by("volpath")),
        ("scene.pbrt", pbrt("Integrator \"path\""), "copy.xml", by("path")),
        ("scene.xml", mitsuba("3.0.0", "<integrator type='path'/>"), "copy.pbrt", to("path")),
        ("scene.xml", mitsuba("3.0.0", ""), "copy.pbrt", to("volpath")),
        ("scene.xml", mitsuba("3.0.0", ""), "copy.xml", by("volpath")),
        ("scene.xml", mitsuba("0.6.0", photons), "copy.pbrt", to("volpath")),
        ("scene.xml", mitsuba("0.6.0", photons), "copy.xml", by("volpath")),
        ("scene.xml", mitsuba("0.6.0", "<integrator type='bdpt'/>"), "copy.xml", by("volpath")),
    ];
    for (name, text, target, integrator) in cases {
        let read = read(name, &text);
        let warned =
            read.0.warnings.iter().any(|w| w.message.contains("ignores media; they are rendered here"));
        let (written, ..) = copied(read, target);
        assert!(written.text.contains(&integrator), "{text}\n{}", written.text);
        assert_eq!(warned, integrator.contains("\"path\""), "{text}");
    }
    let without =
        "Integrator \"volpath\" Film \"rgb\" Camera \"perspective\" WorldBegin LightSource \"infinite\"";
    let (written, ..) = copied(read("scene.pbrt", without), "copy.xml");
    assert!(written.text.contains(&by("path")), "{}", written.text);
}

/// Straight passages are segments of paths for Mitsuba's `path` alone: what pbrt makes of a cut-out leaf is `volpath` there,
/// and the other way it is listed.
#[test]
fn straight_passages_count_as_they_did() {
    let leaf = "Integrator \"volpath\" \"integer maxdepth\" 3 Film \"rgb\" Camera \"perspective\" WorldBegin
                LightSource \"infinite\" Shape \"sphere\" \"float alpha\" 0.5";
    let (written, ..) = copied(read("scene.pbrt", leaf), "copy.xml");
    assert!(written.text.contains("<integrator type=\"volpath\""), "{}", written.text);
    let masked = |plugin: &str| {
        format!(
            "<scene version='3.0.0'><integrator type='{plugin}'><integer name='max_depth' value='4'/></integrator>
             <emitter type='constant'/><sensor type='perspective'/>
             <shape type='sphere'><bsdf type='mask'><bsdf type='diffuse'/></bsdf></shape></scene>"
        )
    };
    for (plugin, lost) in [("path", true), ("volpath", false)] {
        let (written, ..) = copied(read("scene.xml", &masked(plugin)), "copy.pbrt");
        let listed = what(&written).iter().any(|what| what.starts_with("that passing a mask"));
        assert_eq!(listed, lost, "{plugin}: {:?}", what(&written));
    }
}
