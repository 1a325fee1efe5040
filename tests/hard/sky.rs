//! White furnace: under a constant sky of radiance 1 lossless objects of any shape show 1, also rotated,
//! stretched, mirrored or partial ones.

use super::{METHODS, agree};
use crate::support::{Estimate, Stage, camera, diffuse, pbrt_scene, render, scene};

const GLASS: &str =
    "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
const PANE: &str = "<bsdf type='thindielectric'><float name='int_ior' value='1.7'/></bsdf>";
const MIRROR: &str =
    "<bsdf type='twosided'><bsdf type='conductor'><string name='material' value='none'/></bsdf></bsdf>";
const TURNED: &str = "<rotate x='1' y='1' angle='40'/>";

fn shape(kind: &str, transform: &str, bsdf: &str) -> String {
    format!("<shape type='{kind}'><transform name='to_world'>{transform}</transform>{bsdf}</shape>")
}

/// Radiance is scaled by η² or 1/η² at every glass surface, so pixels are noisy, but the mean is 1. Open sheets of
/// `dielectric` are left out: the space behind them would be glass.
#[test]
fn lossless_objects_in_a_constant_sky_are_invisible() {
    let group = format!(
        "<shape type='shapegroup' id='g'>{}</shape><shape type='instance'><ref id='g'/>
         <transform name='to_world'><scale x='-1' y='1' z='1'/><rotate y='1' angle='30'/></transform></shape>",
        shape("cube", "<scale value='0.6'/>", GLASS)
    );
    let white = format!("<bsdf type='twosided'>{}</bsdf>", diffuse("1"));
    let blend = format!(
        "<bsdf type='twosided'><bsdf type='blendbsdf'><float name='weight' value='0.3'/>
         <bsdf type='conductor'><string name='material' value='none'/></bsdf>{}</bsdf></bsdf>",
        diffuse("1")
    );
    let masked = format!("<bsdf type='mask'><float name='opacity' value='0.5'/>{MIRROR}</bsdf>");
    let mut things = vec![
        ("glass ball", shape("sphere", TURNED, GLASS)),
        ("glass cube", shape("cube", TURNED, GLASS)),
        ("glass ball, flattened to a fifth", shape("sphere", "<scale x='1' y='0.2' z='1.5'/>", GLASS)),
        ("mirror ball, flattened to a hundredth", shape("sphere", "<scale x='1' y='0.01' z='1.5'/>", MIRROR)),
        ("mirrored instance of a glass cube", group),
        ("half-opaque mirror ball", shape("sphere", "", &masked)),
        ("blend of white and mirror ball", shape("sphere", "", &blend)),
        ("white cube", shape("cube", TURNED, &white)),
        ("index-matched cube", shape("cube", TURNED, "<bsdf type='null'/>")),
    ];
    for kind in ["cylinder", "disk", "rectangle"] {
        things.push(("open mirror", shape(kind, TURNED, MIRROR)));
        things.push(("open pane", shape(kind, TURNED, PANE)));
    }
    let sky = "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>";
    for (number, (thing, body)) in things.iter().enumerate() {
        let scene = scene(&format!("{}{sky}{body}", camera("0,0,4", "0,0,0", 45.0, 16)));
        check(&format!("{thing} ({number}) in a constant sky"), &scene);
    }
}

#[test]
fn partial_and_curved_shapes_of_pbrt_are_invisible_too() {
    let mirror = "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"float roughness\" 0\n";
    let glass = "Material \"dielectric\" \"float eta\" 1.5\n";
    let tetrahedron = "Scale .7 .7 .7\nShape \"loopsubdiv\" \"integer levels\" 3 \"integer indices\"
        [0 2 1 0 1 3 0 3 2 1 2 3] \"point3 P\" [1 1 1 -1 -1 1 -1 1 -1 1 -1 -1]";
    for (thing, body) in [
        (
            "partial sphere",
            format!("{mirror}Rotate 30 1 1 0\nShape \"sphere\" \"float zmin\" -0.5 \"float phimax\" 270"),
        ),
        ("partial cylinder", format!("{mirror}Rotate 70 1 1 0\nShape \"cylinder\" \"float phimax\" 200")),
        ("ring", format!("{mirror}Rotate 30 1 1 0\nShape \"disk\" \"float innerradius\" 0.3")),
        (
            "bilinear patch",
            format!("{mirror}Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0.5 -1 1 0.5 1 1 -0.3]"),
        ),
        ("subdivided mirror", format!("{mirror}{tetrahedron}")),
        ("subdivided glass", format!("{glass}{tetrahedron}")),
        (
            "glass ball, inside out twice",
            format!("ReverseOrientation\n{glass}Scale -1 1 1\nShape \"sphere\""),
        ),
    ] {
        let sky = "LightSource \"infinite\" \"rgb L\" [1 1 1]";
        let mut scene = pbrt_scene(&format!("{sky}\nScale 4 4 4\n{body}"), vec![]);
        scene.0.view.film = caustica::film::FilmSize::full(24, 16);
        check(&format!("{thing} in a constant sky, pbrt"), &scene);
    }
}

/// 1 % is above 4.5 standard errors of the noisiest case, a white cube by path tracing.
fn check(case: &str, scene: &Stage) {
    for (name, settings) in METHODS {
        let settings = [settings, &[("max_depth", "-1")]].concat();
        let picture = render(scene, &settings, 64);
        agree(&format!("{case}, {name}"), "1", picture.beauty(1), Estimate::exact(1.0), 0.01);
    }
}
