//! Layers that a scene asks for: read in each language, written in each.

use caustica_formats::diagnostic::Severity;
use caustica_formats::ir::{AovKind, CoordinateSystem, Scene};
use caustica_formats::{Read, Written};

use crate::shared::{read, written};

const CAMERA: &str = "<sensor type='perspective'/>";

fn mitsuba(version: &str, integrator: &str) -> Read {
    read("a.xml", &format!("<scene version='{version}'>{integrator}{CAMERA}</scene>"))
}

/// Name and kind of every layer.
fn layers(scene: &Scene) -> Vec<(&str, AovKind)> {
    let aovs = scene.integrator.as_ref().map_or(&[][..], |i| &i.aovs);
    aovs.iter().map(|aov| (aov.name.as_str(), aov.kind)).collect()
}

fn losses(written: &Written) -> Vec<String> {
    written.losses.iter().map(|loss| format!("{} -> {}", loss.what, loss.instead)).collect()
}

fn said(read: &Read) -> Vec<(Severity, &str)> {
    read.warnings.iter().map(|d| (d.severity, d.message.as_str())).collect()
}

#[test]
fn aov_names_layers_and_the_picture_and_comes_back_unchanged() {
    let read_once = mitsuba(
        "3.0.0",
        "<integrator type='aov'><string name='aovs' value='dd.y:depth, nn:sh_normal,b:boundary_test'/>
         <integrator type='path' name='img'/></integrator>",
    );
    let expected = [("img", AovKind::Picture), ("dd.y", AovKind::Depth), ("nn", AovKind::ShNormal)].to_vec();
    assert_eq!(layers(&read_once.scene), expected);
    assert_eq!(read_once.scene.integrator.as_ref().unwrap().plugin, "path");
    let left_out = "layer `b` is left out: `boundary_test` is not rendered";
    assert_eq!(said(&read_once), [(Severity::Warning, left_out)]);
    let [xml, pbrt] = written(&read_once);
    assert_eq!(losses(&xml), Vec::<String>::new());
    assert_eq!(layers(&read("b.xml", &xml.text).scene), expected);
    let what = "the choice of layers: `img`, `dd.y`, `nn` -> a gbuffer film with the layers that pbrt has, in the \
                coordinates of the world";
    assert!(losses(&pbrt).contains(&what.to_owned()), "{:?}", losses(&pbrt));
    let film = &read("b.pbrt", &pbrt.text).scene.sensors[0].film;
    assert_eq!(film.gbuffer, Some(CoordinateSystem::World));
}

#[test]
fn nested_layers_stand_below_the_name_of_what_holds_them() {
    let scene = mitsuba(
        "3.0.0",
        "<integrator type='aov'><string name='aovs' value='u:uv,u:depth'/>
         <integrator type='aov' name='in'><string name='aovs' value='p:position'/><integrator type='path'/></integrator>
         <integrator type='depth' name='z'/><integrator type='direct'/></integrator>",
    );
    let expected =
        [("in.p", AovKind::Position), ("in", AovKind::Picture), ("z", AovKind::Depth), ("u", AovKind::Uv)];
    assert_eq!(layers(&scene.scene), expected);
    let warnings: Vec<&str> = said(&scene).into_iter().map(|(_, text)| text).collect();
    assert_eq!(
        warnings,
        [
            "layer `u` is left out: there is one of that name",
            "only the first integrator of `aov` that gathers light is rendered",
        ]
    );
}

#[test]
fn fields_of_version_0_6_have_the_names_of_the_film() {
    let field =
        |name: &str| format!("<integrator type='field'><string name='field' value='{name}'/></integrator>");
    let integrator = format!(
        "<integrator type='multichannel'><integrator type='path'/>{}{}{}</integrator>",
        field("shNormal"),
        field("distance"),
        field("geoNormal")
    );
    let unnamed = mitsuba("0.6.0", &integrator);
    let kinds = [AovKind::ShNormal, AovKind::Distance, AovKind::GeoNormal];
    let own: Vec<_> = ["sh_normal", "depth", "geo_normal"].into_iter().zip(kinds).collect();
    assert_eq!(layers(&unnamed.scene), own);
    let film = "<sensor type='perspective'><film type='hdrfilm'>
        <string name='channelNames' value='color, n, t, g'/></film></sensor>";
    let named = read("a.xml", &format!("<scene version='0.6.0'>{integrator}{film}</scene>"));
    let mut expected = vec![("color", AovKind::Picture)];
    expected.extend(["n", "t", "g"].into_iter().zip(kinds));
    assert_eq!(layers(&named.scene), expected);
    // Mitsuba 3 counts from the near plane.
    let [xml, _] = written(&named);
    assert_eq!(losses(&xml), ["layer `t` of a 0.6 `field` integrator -> `depth`"]);
    expected[2].1 = AovKind::Depth;
    assert_eq!(layers(&read("b.xml", &xml.text).scene), expected);
}

#[test]
fn depth_by_itself_is_a_layer_beside_the_picture() {
    let scene = mitsuba("3.0.0", "<integrator type='depth'/>");
    assert_eq!(layers(&scene.scene), [("depth", AovKind::Depth)]);
    let text = "`depth` is rendered as a layer beside the picture, which is that of `path`";
    assert_eq!(said(&scene), [(Severity::Warning, text)]);
}

#[test]
fn a_gbuffer_film_is_kept_and_becomes_an_aov() {
    let pbrt = |rest: &str| read("a.pbrt", &format!("Film \"gbuffer\" {rest}\nWorldBegin\n"));
    assert_eq!(pbrt("").scene.sensors[0].film.gbuffer, Some(CoordinateSystem::Camera));
    let world = pbrt("\"string coordinatesystem\" \"world\"");
    assert_eq!(world.scene.sensors[0].film.gbuffer, Some(CoordinateSystem::World));
    let [xml, back] = written(&world);
    assert_eq!(losses(&back), Vec::<String>::new());
    assert_eq!(read("b.pbrt", &back.text).scene.sensors[0].film.gbuffer, Some(CoordinateSystem::World));
    let lost = "of the gbuffer film dzdx, dzdy, and the variances -> `aov` with its other channels, in the \
                coordinates of the world";
    assert!(losses(&xml).contains(&lost.to_owned()), "{:?}", losses(&xml));
    let expected = [
        ("Albedo", AovKind::Albedo),
        ("P", AovKind::Position),
        ("N", AovKind::GeoNormal),
        ("Ns", AovKind::ShNormal),
        ("uv", AovKind::Uv),
    ];
    assert_eq!(layers(&read("b.xml", &xml.text).scene), expected);
}
