//! Emitters, sensors, textures and shapes beyond the everyday ones.

use std::path::PathBuf;

use caustica_formats::ir::{
    Color, ColorInput, EmitterKind, EnvironmentMapping, Fov, FovAxis, LightImage, ShapeKind, TextureEncoding,
    TextureKind, Transform,
};

use crate::{failure, headlines, v3, v06};

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
    assert_eq!(headlines(two), ["a scene may have only one environment; this is a second one"]);
}

#[test]
fn a_projector_has_the_angles_of_a_camera() {
    let text = "<emitter type='projector'><float name='fov' value='30'/><string name='fov_axis' value='y'/>
                <texture name='irradiance' type='bitmap'><string name='filename' value='wood.png'/></texture></emitter>";
    let EmitterKind::Projector { irradiance, scale, fov, fov_axis, .. } = emitter(v3(text)) else {
        panic!("no projector");
    };
    assert!(matches!(irradiance, ColorInput::Texture(_)));
    assert_eq!((scale, fov, fov_axis), (1.0, Fov::Degrees(30.0), FovAxis::Y));
}

#[test]
fn a_collimated_lamp_is_part_of_a_shape() {
    let scene = v3(
        "<shape type='rectangle'><emitter type='directionalarea'><rgb name='radiance' value='3'/></emitter></shape>",
    );
    let emission = scene.shapes[0].emission.clone().expect("the shape shines");
    assert!(emission.collimated && !emission.two_sided);
}

#[test]
fn what_is_not_rendered_says_what_to_use() {
    let text = failure("<scene version='0.6.0'><emitter type='collimated'/></scene>");
    assert!(text.contains("use a small rectangle with a `directionalarea` emitter"), "{text}");
}

#[test]
fn a_grid_has_the_defaults_of_the_manual() {
    let scene = v06(
        "<emitter type='constant'/><shape type='cube'><bsdf type='diffuse'><texture type='gridtexture' name='reflectance'>\
        <float name='uscale' value='4'/></texture></bsdf></shape>",
    );
    let (_, texture) = scene.textures.iter().next().expect("a texture");
    let TextureKind::Grid { color0, color1, line_width, to_uv } = &texture.kind else { panic!("no grid") };
    let gray = |v| ColorInput::Color(Color::Gray(v));
    assert_eq!((color0, color1, *line_width), (&gray(0.2), &gray(0.4), 0.01));
    assert_eq!(*to_uv, Transform::scale([4.0, 1.0, 1.0]));
}

#[test]
fn a_merge_is_its_parts() {
    let scene = v3(
        "<shape type='merge'><shape type='cube'/><shape type='ply'><string name='filename' value='mesh.ply'/></shape></shape>",
    );
    assert_eq!(scene.shapes.len(), 2);
    assert_eq!(scene.shapes[0].kind, ShapeKind::Cube);
    let wrong = "<scene version='3.0.0'><shape type='merge'><float name='radius' value='1'/></shape></scene>";
    assert_eq!(headlines(wrong), ["unknown parameter `radius` of merge"]);
}
