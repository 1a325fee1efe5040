//! Coats: pbrt's against the random walk between the two surfaces that they stand for (`LayeredBxDF`), and what lies
//! below a coat.

use caustica::bsdf::Transport;
use caustica::math::{Vec2, Vec3};
use caustica::sampling::CounterRng;
use caustica::scene::Scene;

use super::{bsdf, closure, direction, float, ggx, material, rgb};
use crate::support::{SIGMAS, Stage, camera, pbrt_scene, render, scene_with};

const THICKNESS: f32 = 0.01;
const MAX_DEPTH: u32 = 10;

fn sphere(material: &str) -> Stage {
    pbrt_scene(&format!("LightSource \"infinite\"\nMaterial {material}\nShape \"sphere\""), vec![])
}

/// A sampled direction and its weight.
fn meet(surface: &Scene, wi: Vec3, rng: &mut CounterRng) -> Option<(Vec3, f32)> {
    let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
    let sample = closure(surface, wi).sample(wi, lobe, u, Transport::Radiance, 0.0)?;
    Some((sample.wo, sample.weight.lanes()[0]))
}

/// Weight of one walk: light that enters along `wi` meets base and coat in turn.
fn walk(coat: &Scene, base: &Scene, wi: Vec3, rng: &mut CounterRng) -> f32 {
    let Some((mut w, mut weight)) = meet(coat, wi, rng) else { return 0.0 };
    for depth in 0..MAX_DEPTH {
        if w.z > 0.0 && depth.is_multiple_of(2) {
            return weight;
        }
        weight *= (-THICKNESS / w.z.abs()).exp();
        let surface = if depth.is_multiple_of(2) { base } else { coat };
        let Some((out, passed)) = meet(surface, -w, rng) else { return 0.0 };
        (w, weight) = (out, weight * passed);
    }
    if w.z > 0.0 { weight } else { 0.0 }
}

/// Mean of 400 000 numbers and its standard error.
fn mean(number: impl Fn(&mut CounterRng) -> f32) -> (f64, f64) {
    let n = 400_000;
    let mut rng = CounterRng::new(31, 0);
    let (mut sum, mut square) = (0.0f64, 0.0f64);
    for _ in 0..n {
        let x = f64::from(number(&mut rng));
        (sum, square) = (sum + x, square + x * x);
    }
    let mean = sum / f64::from(n);
    (mean, ((square / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt())
}

/// Asserts that the albedo along some directions is that of the walk, up to `bias` of it and the noise of both.
fn assert_walked(what: &str, ours: &Scene, coat: &Scene, base: &Scene, bias: f64) {
    for theta in [20.0, 75.0] {
        let wi = direction(theta, 0.0);
        let (walked, walk_error) = mean(|rng| walk(coat, base, wi, rng));
        let (closed, closed_error) = mean(|rng| meet(ours, wi, rng).map_or(0.0, |(_, weight)| weight));
        let bound = bias * walked + SIGMAS * walk_error.hypot(closed_error);
        println!("{what}, {theta}°: {closed:.4} against {walked:.4} ± {bound:.4}");
        assert!((closed - walked).abs() < bound, "{what} at {theta}");
    }
}

/// The closed form is that of the walk below a smooth coat, up to the fit for diffuse light inside (F̄ to 3·10⁻⁴, which
/// counts double at an albedo of 0.9). A rough one is taken to let light out at the angles of a smooth one: measured
/// up to 0.6 % of the albedo.
#[test]
fn coateddiffuse_reflects_what_the_walk_does() {
    for (roughness, bias) in [(0.0, 0.001), (0.1, 0.005), (0.3, 0.006)] {
        let interface = format!("\"float roughness\" {roughness} \"bool remaproughness\" false");
        let coat = sphere(&format!("\"dielectric\" \"float eta\" 1.5 {interface}"));
        for albedo in [0.2, 0.9] {
            let reflectance = format!("\"rgb reflectance\" [{albedo} {albedo} {albedo}]");
            let base = sphere(&format!("\"diffuse\" {reflectance}"));
            let ours = sphere(&format!("\"coateddiffuse\" {reflectance} {interface}"));
            assert_walked(&format!("α {roughness}, ρ {albedo}"), &ours, &coat, &base, bias);
        }
    }
}

/// Exact where all is smooth. Over a rough metal the light that the coat throws back leaves in the directions of the
/// light that it did not: measured up to 1.7 %. A rough coat bends light here as a smooth one does: measured up to 7.5 %.
#[test]
fn coatedconductor_reflects_what_the_walk_does() {
    for (own, below, bias) in [(0.0, 0.0, 0.0), (0.0, 0.2, 0.02), (0.1, 0.2, 0.08)] {
        let interface = format!("\"float interface.roughness\" {own} \"float conductor.roughness\" {below}");
        let rough = |alpha: f64| format!("\"float roughness\" {alpha} \"bool remaproughness\" false");
        let coat = sphere(&format!("\"dielectric\" \"float eta\" 1.5 {}", rough(own)));
        let metal = |scale: f64| format!("[{} {} {}]", 0.2 / scale, 0.9 / scale, 1.1 / scale);
        let k = |scale: f64| format!("[{} {} {}]", 3.9 / scale, 2.4 / scale, 2.2 / scale);
        let base = sphere(&format!(
            "\"conductor\" \"rgb eta\" {} \"rgb k\" {} {}",
            metal(1.5),
            k(1.5),
            rough(below)
        ));
        let ours = sphere(&format!(
            "\"coatedconductor\" \"rgb conductor.eta\" {} \"rgb conductor.k\" {} {interface} \"bool remaproughness\" false",
            metal(1.0),
            k(1.0)
        ));
        assert_walked(&format!("coat {own}, metal {below}"), &ours, &coat, &base, bias);
    }
}

/// Halves of a blend have no order: the mean weight of samples under a coat is the same whichever comes first, up to the
/// noise of both. There are eleven lobes here, five under each inner coat; with a list of eight, those that were left
/// out took 4 to 6 % of the light with them.
#[test]
fn halves_below_a_coat_may_be_swapped() {
    let blend = |first: &str, second: &str| bsdf("blendbsdf", &(float("weight", 0.5) + first + second));
    let rough =
        |alpha: f64, color: &str| bsdf("roughplastic", &(ggx(alpha) + &rgb("diffuse_reflectance", color)));
    let coat = |alpha: f64, below: &str| bsdf("roughcoating", &(ggx(alpha) + below));
    let first = coat(0.3, &blend(&rough(0.2, "0.8"), &rough(0.4, "0.6")));
    let second = coat(0.5, &blend(&rough(0.3, "0.4"), &rough(0.6, "0.1")));
    let [a, b] = [blend(&first, &second), blend(&second, &first)].map(|below| material(&coat(0.4, &below)));
    for theta in [20.0, 75.0] {
        let wi = direction(theta, 0.0);
        let [(one, e), (other, f)] =
            [&a, &b].map(|stage| mean(|rng| meet(stage, wi, rng).map_or(0.0, |(_, weight)| weight)));
        println!("{theta}°: {one:.5} ± {e:.5} and {other:.5} ± {f:.5}");
        assert!((one - other).abs() < SIGMAS * e.hypot(f), "{theta}: {one} and {other}");
        // Half of the least that was lost would be seen.
        assert!(SIGMAS * e.hypot(f) < 0.02 * one, "{theta}: noise {e} and {f}");
    }
}

/// Under a lamp that fills the sky with radiance 1 a coat without a step of the index changes nothing: the mesh shows its
/// own colours, at the middle of the square the mean of two corners. Wherever a nested material names an attribute,
/// the mesh must bring it.
#[test]
fn attributes_of_the_mesh_are_seen_below_a_coat() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property float r\nproperty float g\nproperty float b\nelement face 2\n\
        property list uchar int vertex_indices\nend_header\n\
        -9 -9 0 0.2 0.4 0.6\n9 -9 0 0.2 0.4 0.6\n9 9 0 0.2 0.4 0.6\n-9 9 0 0.2 0.4 0.6\n3 0 1 2\n3 0 2 3\n";
    let attribute = "<texture type='mesh_attribute' name='reflectance'><string name='name' value='vertex_color'/></texture>";
    let diffuse = bsdf("diffuse", attribute);
    let weight = attribute.replace("'reflectance'", "'weight'");
    let opacity = attribute.replace("'reflectance'", "'opacity'");
    let white = bsdf("diffuse", &rgb("reflectance", "1"));
    let black = bsdf("diffuse", &rgb("reflectance", "0"));
    let clear = float("int_ior", 1.0) + &float("ext_ior", 1.0);
    let coat = |below: &str| bsdf("coating", &(clear.clone() + below));
    // Scalars are the luminance of the colour.
    let gray = 0.2126 * 0.2 + 0.7152 * 0.4 + 0.0722 * 0.6;
    let rows = [
        ("a coat", coat(&diffuse), [0.2, 0.4, 0.6]),
        ("two coats", coat(&coat(&diffuse)), [0.2, 0.4, 0.6]),
        ("two sides", coat(&bsdf("twosided", &diffuse)), [0.2, 0.4, 0.6]),
        ("the weight of a blend", coat(&bsdf("blendbsdf", &(weight + &black + &white))), [gray; 3]),
        ("a half", coat(&bsdf("blendbsdf", &(float("weight", 0.5) + &diffuse + &black))), [0.1, 0.2, 0.3]),
        ("a mask, no coat", bsdf("mask", &(opacity + &black)), [1.0 - gray; 3]),
        ("plastic, no coat", plastic_with(attribute), [0.2, 0.4, 0.6]),
    ];
    for (what, bsdf, expected) in rows {
        let body = format!(
            "{}<emitter type='constant'/><shape type='ply'><string name='filename' value='square.ply'/>{bsdf}</shape>",
            camera("0,0,3", "0,0,0", 10.0, 1)
        );
        let picture = render(&scene_with(&body, &[("square.ply", ply)]), &[("integrator", "path")], 256);
        for (channel, value) in expected.into_iter().enumerate() {
            let got = picture.beauty(channel).mean;
            // Every path that is not absorbed at once brings exactly the reflectance; rounding, and where a random
            // choice decides (mask, blend) 4.5 sigmas of 256 draws, which stratification makes much smaller.
            assert!((got - value).abs() < 0.02, "{what}, channel {channel}: {got} instead of {value}");
        }
    }
}

/// With an index of 1 there is no coat, and plastic is its diffuse base.
fn plastic_with(attribute: &str) -> String {
    let diffuse = attribute.replace("'reflectance'", "'diffuse_reflectance'");
    bsdf("plastic", &(float("int_ior", 1.0) + &float("ext_ior", 1.0) + &diffuse))
}
