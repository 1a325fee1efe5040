//! What a user reads, word for word, with line and column.

use caustica_formats::ReadOptions;

use crate::{problems, problems_with};

/// `body` after the first line.
fn of(body: &str) -> Vec<String> {
    problems(&format!("WorldBegin LightSource \"infinite\"\n{body}"))
}

#[test]
fn names_that_do_not_exist() {
    assert_eq!(of("Shpe \"sphere\""), ["scene.pbrt:2:1: unknown directive `Shpe` (did you mean `Shape`?)"]);
    assert_eq!(
        of("Shape \"spere\" \"float radius\" 2"),
        ["scene.pbrt:2:7: unknown shape type `spere` (did you mean `sphere`?)"]
    );
    assert_eq!(
        of("Shape \"sphere\" \"float radus\" 2"),
        ["scene.pbrt:2:16: shape `sphere` takes no parameter `radus` (did you mean `radius`?)"]
    );
    assert_eq!(
        of("Shape \"sphere\" \"flaot radius\" 2"),
        ["scene.pbrt:2:16: unknown parameter type `flaot` (did you mean `float`?)"]
    );
    assert_eq!(
        of("MakeNamedMaterial \"red\" \"string type\" \"diffuse\"\nNamedMaterial \"rde\""),
        ["scene.pbrt:3:15: no material named `rde` (did you mean `red`?)"]
    );
    assert_eq!(
        of("Material \"diffuse\" \"texture reflectance\" \"wood\""),
        ["scene.pbrt:2:42: no spectrum texture named `wood` (a texture must be declared before it is \
             used)"]
    );
    assert_eq!(
        of("ObjectInstance \"tree\""),
        ["scene.pbrt:2:16: no object named `tree` (ObjectBegin defines one)"]
    );
}

#[test]
fn values_of_the_wrong_kind() {
    assert_eq!(
        of("Shape \"sphere\" \"integer radius\" 2"),
        ["scene.pbrt:2:16: `radius` of shape `sphere` has type float, not integer"]
    );
    assert_eq!(
        of("Shape \"sphere\" \"float radius\" [ 1 2 ]"),
        ["scene.pbrt:2:31: `radius` expects 1 value, got 2"]
    );
    assert_eq!(
        of("Shape \"sphere\" \"float radius\" 1.5x"),
        ["scene.pbrt:2:31: expected a number, found `1.5x`"]
    );
    assert_eq!(
        of(
            "Shape \"loopsubdiv\" \"integer levels\" 1.0 \"integer indices\" [0 1 2]\"point3 P\" [0 0 0 1 0 0 0 1 0]"
        ),
        ["scene.pbrt:2:37: expected a whole number of 32 bits, found `1.0`"]
    );
    assert_eq!(
        of("Material \"diffuse\" \"rgb reflectance\" [ 1.5 0 0 ]"),
        ["scene.pbrt:2:38: `reflectance` (1.5, 0, 0) reflects more light than arrives: the maximum is 1"]
    );
    assert_eq!(
        of("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]"),
        ["scene.pbrt:2:53: index 2 refers to vertex 3, but there are 3"]
    );
    assert_eq!(
        of("Scale 0 1 1 Shape \"sphere\""),
        ["scene.pbrt:2:19: the transform flattens this shape: it has no inverse"]
    );
}

#[test]
fn structure() {
    assert_eq!(of("AttributeEnd"), ["scene.pbrt:2:1: AttributeEnd without AttributeBegin"]);
    assert_eq!(of("AttributeBegin"), ["scene.pbrt:2:1: AttributeBegin has no AttributeEnd"]);
    assert_eq!(of("Film \"rgb\""), ["scene.pbrt:2:1: Film must come before WorldBegin"]);
    assert_eq!(
        of("Shape \"sphere\" \"float radius\" [ 1"),
        ["scene.pbrt:2:16: the list of `radius` is not closed"]
    );
    assert_eq!(
        of("Include \"loop.pbrt\""),
        ["loop.pbrt:1:9: files include each other: scene.pbrt → loop.pbrt → loop.pbrt"]
    );
    assert_eq!(
        of("Include \"Ball.pbrt\""),
        ["scene.pbrt:2:9: file `Ball.pbrt` not found (there is `ball.pbrt`; upper and lower case matter)"]
    );
    assert_eq!(
        problems("Film \"rgb\""),
        ["scene.pbrt:1:1: the scene has no WorldBegin (camera, film and integrator come before it, shapes \
         and lights after it)"]
    );
}

#[test]
fn all_problems_at_once() {
    let found =
        of("Shape \"sphere\" \"float radus\" 2\nNope\nShape \"cube\"\nLightSource \"point\" \"float i\" 1");
    assert_eq!(found.len(), 4, "{found:?}");
}

#[test]
fn what_is_not_rendered_is_refused_or_replaced_by_name() {
    let curve = "WorldBegin LightSource \"infinite\"\nShape \"curve\" \"point3 P\" [0 0 0 1 0 0]";
    assert_eq!(
        problems(curve),
        ["scene.pbrt:2:7: shape `curve` is not supported yet (--lenient renders without it: it is \
         skipped)"]
    );
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    assert_eq!(
        problems_with(curve, &options),
        ["scene.pbrt:2:7: shape `curve` is not supported yet: it is skipped"]
    );
    assert_eq!(
        of("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nMediumInterface \"fog\" \"\""),
        ["scene.pbrt:3:17: participating medium `fog` is not supported yet (--lenient renders \
             without it: vacuum is used)"]
    );
}

const V3: &str = "Film \"image\" \"integer xresolution\" 8\nWorldBegin\n\
    LightSource \"point\" \"color I\" [1 1 1]\n\
    Material \"matte\" \"rgb Kd\" [.2 .3 .4]\nShape \"sphere\"\nWorldEnd\n";

#[test]
fn the_third_version_is_named_once() {
    let note = "scene.pbrt:1:6: this is a pbrt-v3 scene (film `image`): it is read as pbrt-v3 means it";
    assert_eq!(problems(V3), [note]);
}

#[test]
fn a_blackbody_of_the_third_version_has_a_scale() {
    use caustica_formats::ir::{Color, EmitterKind};
    let options = ReadOptions::default();
    let lamp = "WorldBegin LightSource \"distant\" \"blackbody L\" [3000 1.5] \"bool twosided\" \"true\"";
    let told = problems_with(lamp, &options);
    assert_eq!(
        told,
        [
            "scene.pbrt:1:59: light `distant` takes no parameter `twosided` (it takes: from, to, L, scale, illuminance)"
        ]
    );
    let lamp =
        crate::try_read("WorldBegin LightSource \"distant\" \"blackbody L\" [3000 1.5]", &options).unwrap();
    let EmitterKind::Directional { irradiance, .. } = &lamp.scene.emitters[0].kind else { panic!() };
    // v3 scales the spectrum to a peak of 1, in the infrared at this temperature: by the curves of CIE 1931 its
    // luminance is 0.416 (± 0.5 % of the fit they were taken from).
    let Color::WithLuminance { luminance, .. } = irradiance else { panic!("{irradiance:?}") };
    assert!((luminance / (1.5 * 0.4164) - 1.0).abs() < 5e-3, "{luminance}");
    assert!(problems_with(V3, &options).is_empty());
}

/// Lights of pbrt-v3 multiply picture, `I` or `L`, and `scale`, all of them colours.
#[test]
fn lights_of_the_third_version_are_exact_or_say_what_is_lost() {
    use caustica_formats::ir::{Color, EmitterKind, EnvironmentMapping};
    let options = ReadOptions::default();
    let light = |text: &str| {
        let read = crate::try_read(&format!("WorldBegin {text} WorldEnd"), &options)
            .unwrap_or_else(|e| panic!("{e}"));
        let said: Vec<String> = read.warnings.iter().map(|d| d.message.clone()).collect();
        (read.scene.emitters[0].kind.clone(), said)
    };
    let (kind, said) =
        light("LightSource \"projection\" \"color I\" [10 10 10] \"string mapname\" \"wood.png\"");
    let EmitterKind::Projection { image, fov, .. } = kind else { panic!("{kind:?}") };
    assert_eq!((image.scale, fov), (10.0, 45.0));
    assert!(said.is_empty(), "{said:?}");

    let (kind, said) = light(
        "LightSource \"infinite\" \"string mapname\" \"wood.png\" \"rgb L\" [1 .5 .25] \"rgb scale\" [2 2 2]",
    );
    let EmitterKind::Environment { image, mapping, .. } = kind else { panic!("{kind:?}") };
    assert_eq!(mapping, EnvironmentMapping::LatLong);
    assert!((image.scale - 2.0 * 1.75 / 3.0).abs() < 1e-12, "{}", image.scale);
    let lost = "the colour of `L` is left out: the picture shines by itself, and its mean is kept (it was 1, 0.5, 0.25)";
    assert_eq!(said, [lost]);

    let (kind, said) =
        light("LightSource \"infinite\" \"string mapname\" \"wood.png\" \"blackbody L\" [6500 2]");
    let EmitterKind::Environment { image, .. } = kind else { panic!("{kind:?}") };
    assert!((image.scale / (2.0 * 0.8856) - 1.0).abs() < 5e-3, "{}", image.scale);
    assert_eq!(said, ["the colour of `L` is left out: the picture shines by itself, and its mean is kept"]);

    for (light_kind, name) in [("point", "I"), ("spot", "I"), ("distant", "L"), ("infinite", "L")] {
        let (kind, said) = light(&format!(
            "LightSource \"{light_kind}\" \"rgb {name}\" [1 2 3] \"rgb scale\" [2 1 .5] \"float conedeltaangle\" 0"
        ).replace(if light_kind == "spot" { "\0" } else { " \"float conedeltaangle\" 0" }, ""));
        let (EmitterKind::Point { intensity: color, .. }
        | EmitterKind::Spot { intensity: color, .. }
        | EmitterKind::Directional { irradiance: color, .. }
        | EmitterKind::Constant { radiance: color }) = kind
        else {
            panic!("{kind:?}")
        };
        assert_eq!(color, Color::Rgb([2.0, 2.0, 1.5]), "{light_kind}");
        assert!(said.is_empty(), "{said:?}");
    }

    let (_, said) = light("LightSource \"spot\"");
    assert!(said[0].contains("fourth power"), "{said:?}");
    let (_, said) = light("LightSource \"goniometric\" \"string mapname\" \"wood.png\"");
    assert!(said.iter().any(|s| s.contains("the light shines evenly")), "{said:?}");
}

/// In pbrt-v3 the shutter decides how far things move, and never how bright the picture is.
#[test]
fn the_shutter_of_the_third_version_does_not_expose() {
    let options = ReadOptions::default();
    for (open, close) in [("0", "0.25"), ("1", "1"), ("0", "1")] {
        let text = format!(
            "Camera \"perspective\" \"float shutteropen\" {open} \"float shutterclose\" {close}\n\
             WorldBegin LightSource \"infinite\" WorldEnd"
        );
        let read = crate::try_read(&text, &options).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read.scene.sensors[0].film.imaging_ratio, 1.0, "{open} to {close}");
        assert!(read.warnings.is_empty());
    }
    // v4 exposes for so long.
    let text = "Camera \"perspective\" \"float shutterclose\" 0.25 WorldBegin LightSource \"infinite\"";
    let read = crate::try_read(text, &options).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read.scene.sensors[0].film.imaging_ratio, 0.25);
}
