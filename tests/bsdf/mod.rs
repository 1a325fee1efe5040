//! Laws that every BSDF obeys, and numbers printed by Mitsuba 3.9.1. Materials come through scene files,
//! so the defaults of the format are part of what is checked.

mod albedo;
mod golden;
mod laws;
mod specular;

use caustica::bsdf::{Closure, Point};
use caustica::math::{Vec2, Vec3};
use caustica::scene::Scene;

use crate::support::{camera, scene};

const RHO: &str = "<rgb name='reflectance' value='0.2,0.5,0.8'/>";

fn material(bsdf: &str) -> Scene {
    scene(&format!("{}<shape type='rectangle'>{bsdf}</shape>", camera("0,0,3", "0,0,0", 40.0, 4)))
}

fn closure(scene: &Scene, wi: Vec3) -> Closure<'_> {
    // Off the middle, where textures of the examples vary.
    let point = Point { textures: &scene.textures, uv: Vec2::new(0.3, 0.6), tangents: [Vec2::X, Vec2::Y] };
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
fn examples() -> Vec<(&'static str, Scene)> {
    let diffuse = bsdf("diffuse", RHO);
    let gold = string("material", "Au");
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
        (
            "twosided roughplastic in a mask",
            bsdf("mask", &(float("opacity", 0.7) + &bsdf("twosided", &plastic("roughplastic", &ggx(0.3))))),
        ),
    ]
    .map(|(name, bsdf)| (name, material(&bsdf)))
    .into()
}

/// Degrees from the normal and around it.
fn direction(theta: f32, phi: f32) -> Vec3 {
    let (t, p) = (theta.to_radians(), phi.to_radians());
    Vec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos())
}

const VIEWS: [(f32, f32); 5] = [(0.5, 10.0), (30.0, 0.0), (60.0, 200.0), (85.0, 90.0), (140.0, 0.0)];
