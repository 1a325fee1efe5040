//! What stops a scene and what is only said, in both versions.

use caustica_formats::ir::ShapeKind;
use caustica_formats::{Failure, Read, ReadOptions};

use crate::{problems, try_read};

const OLD: &str = "Film \"image\" ";
const NEW: &str = "Film \"rgb\" ";

fn read(version: &str, head: &str, body: &str, lenient: bool) -> Result<Read, Box<Failure>> {
    let text = format!("{version}{head} WorldBegin LightSource \"infinite\"\n{body}");
    try_read(&text, &ReadOptions { lenient, ..ReadOptions::default() })
}

/// What no light depends on is never an error.
#[test]
fn unknown_things_around_the_scene_are_named_and_replaced() {
    let head = "Integrator \"vcm\" \"integer maxdepth\" 3 Sampler \"neural\" PixelFilter \"lanczos\" Accelerator \"grid\"";
    for version in [OLD, NEW] {
        let read = read(version, head, "", false).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read.scene.integrator, None);
        for said in [
            "unknown integrator type `vcm`: photon mapping is used",
            "unknown sampler type `neural`: 16 samples a pixel are taken",
            "unknown filter type `lanczos`: the gaussian filter is used",
            "unknown accelerator type `grid`: it does not matter",
        ] {
            assert!(
                read.warnings.iter().any(|d| d.message == said && d.span.is_some()),
                "{:?}",
                read.warnings
            );
        }
    }
    assert_eq!(
        problems(
            "Film \"gbuffer\" \"bool saveDepth\" true Film \"cv\" \"integer xresolution\" 9 WorldBegin LightSource \"infinite\""
        ),
        ["scene.pbrt:1:43: unknown film type `cv`: the rgb film is used (known: rgb, gbuffer, spectral)"]
    );
    assert_eq!(
        problems("Film \"rgb\" \"bool saveDepth\" true WorldBegin LightSource \"infinite\"")[0]
            .split(" (")
            .next(),
        Some("scene.pbrt:1:12: film `rgb` takes no parameter `saveDepth`: it is ignored")
    );
    assert_eq!(
        problems("Film \"rgb\" Integrator \"ambientocclusion\" WorldBegin LightSource \"infinite\""),
        ["scene.pbrt:1:23: integrator `ambientocclusion` is not rendered: photon mapping is used"]
    );
}

#[test]
fn what_changes_the_light_is_an_error_unless_it_is_asked_for() {
    for version in [OLD, NEW] {
        for body in [
            "Shape \"aaplane\"",
            "Material \"wood\"",
            "LightSource \"sun\"",
            "AreaLightSource \"portal\" Shape \"sphere\"",
            "Texture \"t\" \"float\" \"pounamu\"",
            "MakeNamedMedium \"m\" \"string type\" \"fog\"",
        ] {
            // pbrt-v3 goes on without it, and says so.
            assert_eq!(read(version, "", body, false).is_err(), version == NEW, "{version}{body}");
            let lenient = read(version, "", body, true).unwrap_or_else(|e| panic!("{e}"));
            assert!(
                lenient.warnings.iter().any(|d| d.message.contains("unknown ")),
                "{:?}",
                lenient.warnings
            );
        }
    }
}

/// What pbrt-v4 stops at, and older versions only mention.
#[test]
fn mistakes_that_older_versions_forgive() {
    for (body, said) in [
        ("Shape \"sphere\" \"float radus\" 2", "shape `sphere` takes no parameter `radus`: it is ignored"),
        (
            "Shape \"sphere\" \"integer radius\" 2",
            "`radius` of shape `sphere` has type float, not integer: it counts as not given",
        ),
        (
            "Shape \"sphere\" \"float radius\" [2 3]",
            "`radius` expects 1 value, got 2: it counts as not given",
        ),
        ("Shape \"sphere\" \"float radius\" []", "the list of `radius` is empty: it counts as not given"),
        ("Shape \"sphere\" \"flaot radius\" 2", "unknown parameter type `flaot`: the parameter is ignored"),
        ("Shape \"sphere\" \"float radius\" \"2\"", "`radius` expects numbers"),
        ("ObjectInstance \"tree\"", "no object named `tree`: it is left out"),
        ("MediumInterface \"fog\" \"\"", "no medium named `fog`: vacuum is used"),
        ("Film \"image\"", "Film must come before WorldBegin: it is ignored"),
        ("Shape \"sphere\" \"float radius\" 1.5x", "expected a number, found `1.5x`: 1.5 is used"),
        ("Translate .5. 0 0", "expected a number, found `.5.`: 0.5 is used"),
    ] {
        let old = read(OLD, "", body, false);
        if said == "`radius` expects numbers" {
            // Not even pbrt-v3 reads on without brackets.
            continue;
        }
        let old = old.unwrap_or_else(|e| panic!("{body}: {e}"));
        assert!(old.warnings.iter().any(|d| d.message == said), "{body}: {:?}", old.warnings);
        assert!(read(NEW, "", body, false).is_err(), "{body}");
        assert!(read(NEW, "", body, true).is_ok(), "{body}");
    }
}

#[test]
fn numbers_as_pbrt_reads_them() {
    let radius = |version: &str, number: &str| {
        let read = read(version, "", &format!("Shape \"sphere\" \"float radius\" {number}"), false)?;
        match read.scene.shapes[0].kind {
            ShapeKind::Sphere { radius, .. } => Ok::<f64, Box<Failure>>(radius),
            _ => panic!(),
        }
    };
    for (number, value) in [("1.e3", 1000.0), ("+3", 3.0), (".5", 0.5), ("0x10", 16.0), ("[2.]", 2.0)] {
        assert_eq!(radius(NEW, number).ok(), Some(value), "{number}");
        assert_eq!(radius(OLD, number).ok(), Some(value), "{number}");
    }
    assert_eq!(radius(OLD, "2,").ok(), Some(2.0));
    assert!(radius(NEW, "2,").is_err());
    // pbrt-v3 reads whole numbers as any, and says nothing.
    let width = |version: &str, number: &str| {
        let text = format!(
            "{version}Camera \"perspective\" \"float fov\" 40 Sampler \"halton\" \"integer pixelsamples\" {number} WorldBegin LightSource \"infinite\""
        );
        try_read(&text, &ReadOptions::default())
            .map(|read| (read.scene.sensors[0].sampler.sample_count, read.warnings.len()))
    };
    assert_eq!(width(OLD, "8.0").ok(), Some((8, 1)));
    assert_eq!(width(OLD, "1e2").ok(), Some((100, 1)));
    assert!(width(NEW, "8.0").is_err());
}

#[test]
fn lists_without_brackets_are_taken_as_far_as_numbers_go() {
    let text =
        "Film \"rgb\" WorldBegin LightSource \"point\" \"rgb I\" 1 2 3 \"float scale\" 2\nShape \"sphere\"";
    let read = try_read(text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read.warnings[0].message, "the 3 numbers of `I` have no brackets");
    assert_eq!(read.scene.shapes.len(), 1);
    assert_eq!(
        problems("WorldBegin LightSource \"infinite\" Shape \"sphere\" \"float radius\" 2 Shpe \"disk\""),
        ["scene.pbrt:1:67: unknown directive `Shpe` (did you mean `Shape`?)"]
    );
}

/// What a missing file defines is not known: only the file is reported.
#[test]
fn a_missing_include_is_the_only_fault() {
    for version in [OLD, NEW] {
        let text = format!(
            "{version}WorldBegin LightSource \"infinite\" Include \"materials.pbrt\"\nNamedMaterial \"m\" \
             MediumInterface \"fog\" \"\" ObjectInstance \"o\" Material \"plastic\" \"texture Kd\" \"t\" Shape \"sphere\""
        );
        let found = problems(&text);
        assert!(found[0].contains("file `materials.pbrt` not found"), "{found:?}");
        assert!(found.iter().all(|p| !p.contains(" named ")), "{found:?}");
    }
}

/// It ends with the file, and nothing is left that the end would change.
#[test]
fn a_scope_that_is_not_closed_changes_nothing() {
    let open = "WorldBegin LightSource \"infinite\"\nAttributeBegin Shape \"sphere\"";
    let read = try_read(open, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read.warnings[0].message, "AttributeBegin has no AttributeEnd: it ends with the scene");
    let object = "WorldBegin LightSource \"infinite\"\nObjectBegin \"o\" Shape \"sphere\"";
    assert!(try_read(object, &ReadOptions::default()).is_err());
}

#[test]
fn a_medium_may_be_defined_after_it_is_used() {
    let text = "Film \"rgb\" WorldBegin LightSource \"infinite\"\nMediumInterface \"fog\" \"\"\n\
        MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nMediumInterface \"fog\" \"\"";
    assert_eq!(problems(text), [""; 0]);
}
