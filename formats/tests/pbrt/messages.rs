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
    assert_eq!(of("AttributeEnd"), ["scene.pbrt:2:1: AttributeEnd without AttributeBegin: it is ignored"]);
    assert_eq!(
        of("AttributeBegin"),
        ["scene.pbrt:2:1: AttributeBegin has no AttributeEnd: it ends with the scene"]
    );
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
        ["scene.pbrt:2:7: shape `curve` is not supported yet (with --lenient it is \
         skipped)"]
    );
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    assert_eq!(
        problems_with(curve, &options),
        ["scene.pbrt:2:7: shape `curve` is not supported yet: it is skipped"]
    );
}

/// What was left open is named, not what follows it.
#[test]
fn lists_and_strings_that_are_left_open() {
    let unclosed = |name: &str| [format!("scene.pbrt:2:20: the list of `{name}` is not closed")];
    assert_eq!(
        of("Material \"diffuse\" \"rgb reflectance\" [ 0.5 0.5 0.5\nShape \"sphere\""),
        unclosed("reflectance")
    );
    assert_eq!(of("Shape \"sphere\"     \"float radius\" [ 1 \"float zmin\" -1"), unclosed("radius"));
    assert_eq!(
        of("Transform [ 1 0 0 0  0 1 0 0\nShape \"sphere\""),
        ["scene.pbrt:2:1: Transform expects 16 numbers, got 8"]
    );
    assert_eq!(
        of("Material \"diffuse\" \"rgb reflectance [ 0.5 0.5 0.5 ]\nShape \"sphere\""),
        ["scene.pbrt:2:20: the string is not closed on its line"]
    );
}

/// One line about WorldBegin, not one for all that should stand behind it.
#[test]
fn a_world_that_does_not_begin() {
    let found = problems("LightSource \"infinite\"\nMaterial \"diffuse\"\nShape \"sphere\"");
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].starts_with("scene.pbrt:1:1: LightSource must come after WorldBegin"), "{found:?}");
    assert!(found[1].contains("the scene has no WorldBegin"), "{found:?}");
}

#[test]
fn xml_is_told_from_pbrt() {
    let found = problems("<?xml version='1.0'?>\n<scene version='3.0.0'/>");
    let last = found.last().expect("an error");
    assert_eq!(last, ": the file begins as XML does (the extension decides: scenes of Mitsuba end in .xml)");
}

/// The renderer takes them and makes something of them; what that is nobody means.
#[test]
fn numbers_that_make_no_sense() {
    let of = |body: &str| of(&format!("{body}\nShape \"sphere\""));
    assert_eq!(
        of("Material \"conductor\" \"float roughness\" -0.2"),
        ["scene.pbrt:2:22: `roughness` should not be negative; it is -0.2"]
    );
    assert_eq!(
        of("Material \"coateddiffuse\" \"float thickness\" -1"),
        ["scene.pbrt:2:26: `thickness` should not be negative; it is -1"]
    );
    assert_eq!(
        of("Material \"coatedconductor\" \"float interface.roughness\" -1"),
        ["scene.pbrt:2:28: `interface.roughness` should not be negative; it is -1"]
    );
    assert!(of("Material \"conductor\" \"float roughness\" 1.5").is_empty());
}
