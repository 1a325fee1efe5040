//! Emitters, sensors, textures and shapes beyond the everyday ones.

use std::path::PathBuf;

use caustica_formats::ir::{EmitterKind, EnvironmentMapping, LightImage, TextureEncoding, Transform};

use crate::{headlines, v3, v06};

fn emitter(scene: caustica_formats::ir::Scene) -> EmitterKind {
    scene.emitters[0].kind.clone()
}

#[test]
fn an_environment_map_is_a_picture_around_the_scene() {
    let image =
        |encoding, scale| LightImage { path: PathBuf::from("wood.png"), encoding, scale, illuminance: None };
    let expected = |image| EmitterKind::Environment {
        to_world: Transform::IDENTITY,
        image,
        mapping: EnvironmentMapping::LatLong,
    };
    let new =
        "<emitter type='envmap'><string name='filename' value='wood.png'/><float name='scale' value='2'/>
               <boolean name='mis_compensation' value='true'/></emitter>";
    assert_eq!(emitter(v3(new)), expected(image(TextureEncoding::Auto, 2.0)));
    let old =
        "<emitter type='envmap'><string name='filename' value='wood.png'/><float name='gamma' value='1'/>
               <boolean name='cache' value='false'/></emitter>";
    assert_eq!(emitter(v06(old)), expected(image(TextureEncoding::Linear, 1.0)));
    let two = "<scene version='3.0.0'><emitter type='constant'/><emitter type='envmap'>\
               <string name='filename' value='wood.png'/></emitter></scene>";
    assert_eq!(headlines(two), ["a scene has one environment; this is a second one"]);
}
