//! Laws that every BSDF obeys, and numbers printed by Mitsuba 3.9.1. Materials come through scene files,
//! so the defaults of the format are part of what is checked.

mod albedo;
mod coats;
mod golden;
mod laws;
mod specular;
mod version3;

use caustica::bsdf::{Closure, Point};
use caustica::math::{Vec2, Vec3};
use caustica::scene::Scene;

use crate::support::{Stage, camera, pbrt_scene, scene};

const RHO: &str = "<rgb name='reflectance' value='0.2,0.5,0.8'/>";

fn material(bsdf: &str) -> Stage {
    scene(&format!("{}<shape type='rectangle'>{bsdf}</shape>", camera("0,0,3", "0,0,0", 40.0, 4)))
}

fn closure(scene: &Scene, wi: Vec3) -> Closure<'_> {
    // Off the middle, where textures of the examples vary.
    let point = Point::flat(&scene.textures, Vec2::new(0.3, 0.6));
    scene.materials[scene.shapes[0].material as usize].closure(&point, wi)
}

fn bsdf(kind: &str, inside: &str) -> String {
    format!("<bsdf type='{kind}'>{inside}</bsdf>")
}

fn float(name: &str, value: f64) -> String {
    format!("<float name='{name}' value='{value}'/>")
}

fn string(name: &str, value: &str) -> String {
    format!("<string name='{name}' value='{value}'/>")
}

fn rgb(name: &str, value: &str) -> String {
    format!("<rgb name='{name}' value='{value}'/>")
}

fn ggx(alpha: f64) -> String {
    string("distribution", "ggx") + &float("alpha", alpha)
}

fn ggx_uv(u: f64, v: f64) -> String {
    string("distribution", "ggx") + &float("alpha_u", u) + &float("alpha_v", v)
}

fn plastic(kind: &str, rest: &str) -> String {
    bsdf(kind, &(rgb("diffuse_reflectance", "0.2,0.5,0.8") + rest))
}

const NONLINEAR: &str = "<boolean name='nonlinear' value='true'/>";

/// Every model that is rendered, by name.
fn examples() -> Vec<(&'static str, Stage)> {
    let diffuse = bsdf("diffuse", RHO);
    let base = rgb("base_color", "0.2,0.5,0.8");
    let shiny = rgb("specular_reflectance", "0.3") + &rgb("diffuse_reflectance", "0.2,0.5,0.6");
    let floats = |pairs: &[(&str, f64)]| pairs.iter().map(|(name, v)| float(name, *v)).collect::<String>();
    let two = |first: &str, second: &str| first.to_owned() + second;
    let tilted = |n: &str, rest: &str| {
        // A texture that is one colour.
        let map = format!(
            "<texture type='checkerboard' name='normalmap'>{}{}</texture>",
            rgb("color0", n),
            rgb("color1", n)
        );
        bsdf("normalmap", &(map + rest))
    };
    let gold = string("material", "Au");
    let coated = |alpha: f64| {
        let base = two(&plastic("roughplastic", &ggx(alpha)), &bsdf("roughconductor", &ggx(0.3)));
        bsdf("roughcoating", &(ggx(alpha) + &bsdf("blendbsdf", &(float("weight", 0.3) + &base))))
    };
    let coats = bsdf("blendbsdf", &(float("weight", 0.5) + &two(&coated(0.4), &coated(0.6))));
    [
        ("diffuse", diffuse.clone()),
        ("plastic", plastic("plastic", "")),
        ("plastic, nonlinear", plastic("plastic", NONLINEAR)),
        ("plastic, dim", plastic("plastic", &rgb("specular_reflectance", "0.2"))),
        ("twosided", bsdf("twosided", &diffuse)),
        ("twosided plastic", bsdf("twosided", &plastic("plastic", ""))),
        ("mask", bsdf("mask", &(float("opacity", 0.3) + &diffuse))),
        ("masked plastic", bsdf("mask", &(float("opacity", 0.6) + &plastic("plastic", "")))),
        ("dielectric", bsdf("dielectric", "")),
        ("thindielectric", bsdf("thindielectric", "")),
        ("conductor", bsdf("conductor", &gold)),
        ("null", bsdf("null", "")),
        ("roughconductor, beckmann", bsdf("roughconductor", &(gold.clone() + &float("alpha", 0.3)))),
        ("roughconductor, ggx", bsdf("roughconductor", &(gold.clone() + &ggx(0.3)))),
        ("roughconductor, brushed", bsdf("roughconductor", &(gold.clone() + &ggx_uv(0.25, 0.6)))),
        ("roughdielectric, beckmann", bsdf("roughdielectric", &float("alpha", 0.3))),
        ("roughdielectric, ggx", bsdf("roughdielectric", &ggx(0.4))),
        ("roughplastic, ggx", plastic("roughplastic", &ggx(0.22))),
        ("roughplastic, beckmann", plastic("roughplastic", &(float("alpha", 0.4) + NONLINEAR))),
        ("principled", bsdf("principled", &base)),
        (
            "principled metal",
            bsdf(
                "principled",
                &(base.clone() + &floats(&[("metallic", 1.0), ("roughness", 0.6), ("anisotropic", 0.5)])),
            ),
        ),
        (
            "principled, transparent",
            bsdf(
                "principled",
                &(base.clone() + &floats(&[("spec_trans", 0.7), ("roughness", 0.6), ("eta", 1.5)])),
            ),
        ),
        (
            "principled, coated",
            bsdf(
                "principled",
                &(base.clone()
                    + &floats(&[
                        ("clearcoat", 1.0),
                        ("sheen", 0.5),
                        ("flatness", 0.5),
                        ("spec_tint", 0.5),
                        ("metallic", 0.3),
                    ])),
            ),
        ),
        (
            "principledthin, transparent",
            bsdf(
                "principledthin",
                &(base.clone()
                    + &floats(&[
                        ("spec_trans", 0.5),
                        ("diff_trans", 0.8),
                        ("roughness", 0.7),
                        ("sheen", 0.3),
                        ("flatness", 0.4),
                    ])),
            ),
        ),
        ("difftrans", bsdf("difftrans", &rgb("transmittance", "0.2,0.5,0.8"))),
        ("roughdiffuse", bsdf("roughdiffuse", &(float("alpha", 0.6) + RHO))),
        (
            "roughdiffuse, fast",
            bsdf(
                "roughdiffuse",
                &(float("alpha", 0.6) + RHO + "<boolean name='use_fast_approx' value='true'/>"),
            ),
        ),
        ("phong", bsdf("phong", &(float("exponent", 20.0) + &shiny))),
        ("ward, balanced", bsdf("ward", &(floats(&[("alpha_u", 0.3), ("alpha_v", 0.5)]) + &shiny))),
        (
            "ward, duer",
            bsdf(
                "ward",
                &(string("variant", "ward-duer")
                    + &float("alpha_u", 0.3)
                    + &float("alpha_v", 0.3)
                    + &rgb("specular_reflectance", "0.1")),
            ),
        ),
        (
            "ward",
            bsdf(
                "ward",
                &(string("variant", "ward") + &float("alpha_u", 0.3) + &float("alpha_v", 0.3) + &shiny),
            ),
        ),
        (
            "blend",
            bsdf("blendbsdf", &(float("weight", 0.25) + &two(&diffuse, &bsdf("roughconductor", &ggx(0.3))))),
        ),
        (
            "blend of mirror and glass, transparent",
            bsdf(
                "blendbsdf",
                &(float("weight", 0.4) + &two(&bsdf("conductor", &gold), &bsdf("dielectric", ""))),
            ),
        ),
        (
            "mixture",
            bsdf(
                "mixturebsdf",
                &(string("weights", "0.3, 0.5")
                    + &two(&plastic("plastic", ""), &plastic("roughplastic", &ggx(0.3)))),
            ),
        ),
        (
            "twosided blend",
            bsdf(
                "twosided",
                &bsdf("blendbsdf", &(float("weight", 0.5) + &two(&diffuse, &plastic("plastic", "")))),
            ),
        ),
        ("coating", bsdf("coating", &(rgb("sigma_a", "0.1,0.2,0.3") + &bsdf("roughconductor", &ggx(0.3))))),
        ("coating of plastic", bsdf("coating", &plastic("plastic", ""))),
        ("coating of a blend of coats", bsdf("coating", &coats)),
        ("roughcoating", bsdf("roughcoating", &(ggx(0.3) + &plastic("roughplastic", &ggx(0.5))))),
        ("tilted diffuse", tilted("0.6,0.55,0.9", &diffuse)),
        ("tilted plastic", tilted("0.6,0.55,0.9", &bsdf("twosided", &plastic("roughplastic", &ggx(0.3))))),
        (
            "tilted the other way",
            bsdf(
                "twosided",
                &tilted(
                    "0.3,0.55,0.8",
                    &bsdf("blendbsdf", &(float("weight", 0.5) + &two(&diffuse, &bsdf("conductor", "")))),
                ),
            ),
        ),
        (
            "twosided roughplastic in a mask",
            bsdf("mask", &(float("opacity", 0.7) + &bsdf("twosided", &plastic("roughplastic", &ggx(0.3))))),
        ),
    ]
    .map(|(name, bsdf)| (name, material(&bsdf)))
    .into_iter()
    .chain(of_pbrt())
    .collect()
}

/// pbrt's own models: another masking, roughness by its square root, coats.
fn of_pbrt() -> Vec<(&'static str, Stage)> {
    let colour = "\"rgb reflectance\" [0.2 0.5 0.8]";
    let mix = format!(
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" {colour}\n\
         MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"float roughness\" 0.2\n\
         Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.3"
    );
    let of = |kind: &str, rest: &str| format!("Material \"{kind}\" {rest}");
    [
        ("pbrt diffuse", of("diffuse", colour)),
        ("pbrt conductor", of("conductor", "\"float uroughness\" 0.1 \"float vroughness\" 0.3")),
        ("pbrt dielectric, transparent", of("dielectric", "\"float roughness\" 0.2")),
        ("pbrt thindielectric", of("thindielectric", "")),
        (
            "pbrt diffusetransmission, transparent",
            of(
                "diffusetransmission",
                "\"rgb reflectance\" [0.2 0.5 0.1] \"rgb transmittance\" [0.3 0.4 0.5]",
            ),
        ),
        ("pbrt coateddiffuse", of("coateddiffuse", &format!("{colour} \"float roughness\" 0.2"))),
        (
            "pbrt coatedconductor",
            of("coatedconductor", "\"float interface.roughness\" 0.1 \"float conductor.roughness\" 0.2"),
        ),
        ("pbrt mix", mix),
    ]
    .into_iter()
    .chain(version3::EXAMPLES.iter().map(|(name, material)| (*name, (*material).to_owned())))
    .map(|(name, material)| (name, of_pbrt_material(&material)))
    .collect()
}

fn of_pbrt_material(material: &str) -> Stage {
    let shape = "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \
                 \"point3 P\" [-1 -1 0  1 -1 0  1 1 0  -1 1 0] \"point2 uv\" [0 0 1 0 1 1 0 1]";
    pbrt_scene(&format!("{material}\n{shape}"), vec![("table.bsdf", version3::TABLE.to_vec())])
}

/// Degrees from the normal and around it.
fn direction(theta: f32, phi: f32) -> Vec3 {
    let (t, p) = (theta.to_radians(), phi.to_radians());
    Vec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos())
}

const VIEWS: [(f32, f32); 5] = [(0.5, 10.0), (30.0, 0.0), (60.0, 200.0), (85.0, 90.0), (140.0, 0.0)];
