//! Media where numbers or boundaries are at their limits.

use std::fmt::Write;

use caustica::film::Layer;

use super::{Method, PATH, agree, record, sound};
use crate::media::{container, dense_fog, eye, fog, vol};
use crate::support::{
    Estimate, Stage, area, box_camera, diffuse, rectangle, render, scene, scene_with_bytes, sphere, walls,
};

const SKY: &str = "<emitter type='constant'><rgb name='radiance' value='1,1,1'/></emitter>";
const MAPS: Method =
    ("photon map", &[("photons", "4000"), ("caustic_photons", "4000"), ("volume_photons", "20000")]);
const METHODS: [Method; 2] = [PATH, MAPS];

fn stage(parts: &[&str]) -> Stage {
    scene(&parts.concat())
}

/// Optical depths of a box from one millionth to a thousand, without absorption under an even sky: all of it is 1.
/// Without any of it the picture of 10⁻⁶ is that of an empty sky; the noise of the others is below the bound over 4.5.
#[test]
fn fog_of_any_density_is_invisible_under_an_even_sky() {
    for (depth, bound) in [(1e-6, 1e-4), (1e-3, 2e-3), (1.0, 0.02), (30.0, 0.08)] {
        let box_of_fog = container("", &dense_fog("interior", depth / 2.0, "1,1,1", ""));
        let stage = stage(&[&eye("0,0,-4", 20.0, 8, ""), SKY, &box_of_fog]);
        for (name, settings) in METHODS {
            let passes = if name == "path" { 512 } else { 64 };
            let picture = render(&stage, settings, passes);
            let case = format!("lossless fog of optical depth {depth:e}, {name}");
            agree(&case, "1, as the sky", picture.beauty(1), Estimate::exact(1.0), bound);
        }
    }
}

/// The light that a thick layer sends straight back under an even sky is 1 − √(1 − ϖ)·H(1), with Chandrasekhar's H of
/// even scattering: 1/H(μ) = √(1 − ϖ) + ϖ/2·∫μ'·H(μ')/(μ + μ') dμ'.
fn sent_back(albedo: f64) -> f64 {
    let n = 400;
    let mu: Vec<f64> = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).collect();
    let root = (1.0 - albedo).sqrt();
    let next = |h: &[f64], m: f64| {
        let sum: f64 = mu.iter().zip(h).map(|(&x, h)| x * h / (m + x)).sum();
        1.0 / (root + 0.5 * albedo * sum / f64::from(n))
    };
    let mut h = vec![1.0; mu.len()];
    for _ in 0..100 {
        h = mu.iter().map(|&m| next(&h, m)).collect();
    }
    1.0 - root * next(&h, 1.0)
}

/// A thousand and a million mean free paths; one of the latter is no longer than what rays are lifted off surfaces by.
#[test]
fn a_thick_medium_sends_back_what_chandrasekhar_says() {
    for depth in [1e3, 1e6] {
        let wall = container("", &dense_fog("interior", depth / 2.0, "0.5,0.5,0.5", ""));
        let stage = stage(&[&eye("0,0,-4", 0.1, 4, ""), SKY, &wall]);
        let picture = render(&stage, PATH.1, 4096);
        let case = format!("albedo 0.5, optical depth {depth:e}, path");
        let exact = Estimate::exact(sent_back(0.5));
        agree(&case, "1 − √(1 − ϖ)·H(1)", picture.beauty(1), exact, 0.012);
        sound(&format!("{case}, all pixels"), &picture);
        sound(&format!("albedo 0.5, optical depth {depth:e}, photon map"), &render(&stage, MAPS.1, 8));
    }
}

/// Cells that are empty, negative, far too dense and of optical depth ln 2: a quarter of the picture each.
#[test]
fn cells_that_mean_nothing_are_counted_and_replaced() {
    let cells = [0.0, -1.0, 1e30, std::f32::consts::LN_2 / 2.0];
    let medium = "<medium type='heterogeneous' name='interior'>
        <volume type='gridvolume' name='sigma_t'><string name='filename' value='a.vol'/>
        <string name='filter_type' value='nearest'/><boolean name='raw' value='true'/>
        <transform name='to_world'><scale value='2'/><translate value='-1,-1,-1'/></transform></volume>
        <float name='albedo' value='0'/></medium>";
    let view = format!(
        "<sensor type='orthographic'><transform name='to_world'>
         <lookat origin='0,0,-4' target='0,0,0' up='0,1,0'/></transform>{}</sensor>",
        crate::support::film(32, 8)
    );
    let bytes = vol([4, 1, 1], 1, |[x, _, _]| vec![cells[x]]);
    let stage = scene_with_bytes(&[&view, SKY, &container("", medium)].concat(), vec![("a.vol", bytes)]);
    let warned = stage.0.warnings().contains("2 numbers of a volume are negative or above");
    assert!(warned, "{}", stage.0.warnings());
    // The cell of 10³⁰ is cut to an optical depth of 10⁴, and the bound of the whole grid with it: so many small steps
    // have no noise, but 1 − 10⁻⁴ is rounded.
    let picture = render(&stage, PATH.1, 64);
    let exact = Estimate::exact(0.625);
    agree("empty, negative and huge cells, path", "(1 + 1 + 0 + 1/2)/4", picture.beauty(1), exact, 0.001);
}

/// Two boxes of different fog in the same place: one of the two is found at every border, the same for all rays.
#[test]
fn coincident_boundaries_are_one_of_the_two() {
    let [thin, thick] = [0.1, 0.6]
        .map(|sigma| container("", &fog("interior", &format!("{sigma},{sigma},{sigma}"), "0,0,0", "")));
    let stage = stage(&[&eye("0,0,-4", 0.1, 4, ""), SKY, &thin, &thick]);
    for (name, settings) in METHODS {
        let picture = render(&stage, settings, 16);
        let mean = picture.beauty(1).mean;
        let exact = [0.1f64, 0.6].map(|sigma| (-2.0 * sigma).exp());
        let error = exact.map(|e| (mean / e - 1.0).abs());
        let least = error[0].min(error[1]);
        let case = format!("two boxes of fog in one place, {name}");
        record(&case, "e^−0.2 or e^−1.2", &format!("{mean:.5}"), "1e-3");
        assert!(least < 1e-3, "{case}: {mean}");
    }
}

/// A ball of glass with fog inside that touches other fog outside. Kernels reach over the border of the ball.
#[test]
fn glass_with_fog_inside_touches_fog_outside() {
    let glass = "<bsdf type='dielectric'><float name='int_ior' value='1.5'/>
                 <float name='ext_ior' value='1'/></bsdf>";
    let outer = |name| fog(name, "0.3,0.2,0.4", "1,1,1", "");
    let inner = fog("interior", "1,0.6,0.8", "1,1,1", "");
    let ball = sphere("0,0,0", 0.8, &format!("{glass}{inner}{}", outer("exterior")));
    let stage = stage(&[
        &eye("0,0,-5", 40.0, 8, ""),
        SKY,
        &container("<scale value='2'/>", &outer("interior")),
        &ball,
    ]);
    for (name, settings) in METHODS {
        let passes = if name == "path" { 512 } else { 128 };
        let picture = render(&stage, settings, passes);
        let case = format!("fog in glass in fog, even sky, {name}");
        agree(&case, "1, as the sky", picture.beauty(1), Estimate::exact(1.0), 0.03);
    }
}

/// A lamp in the very plane in which the fog below it ends: as one just below that plane.
#[test]
fn a_lamp_on_the_border_of_fog_shines_into_it() {
    let with = |y: f64| {
        let fog = container("<scale value='0.999'/>", &fog("interior", "0.5,0.5,0.5", "0.8,0.8,0.8", ""));
        let turned = format!("<rotate x='1' angle='90'/><translate y='{y}'/>");
        let lamp = rectangle(0.3, &turned, &area("10,10,10"));
        stage(&[&box_camera(16), &walls("0.5"), &fog, &lamp])
    };
    // Without the lamp itself, whose edge is noise.
    let light = |y: f64, settings, passes| {
        render(&with(y), settings, passes).estimate(&[Layer::Direct, Layer::Indirect, Layer::Medium], 1)
    };
    let below = light(0.998, PATH.1, 1024);
    for (name, settings) in METHODS {
        let passes = if name == "path" { 1024 } else { 48 };
        let case = format!("lamp in the plane where fog ends, {name}");
        agree(&case, "as 0.001 below", light(0.999, settings, passes), below, 0.03);
    }
}

/// Boundaries along every ray, between them fog and vacuum by turns: half of the way is fog. Rays start off each sheet
/// by 2⁻¹⁹ of its size, which is a fifth of the way to the next of 10⁵; of that way in fog an eighth is left out, which
/// makes the light brighter by 1.3 % at most. After 2²⁰ sheets a ray counts as lost.
#[test]
fn a_hundred_thousand_boundaries_are_passed() {
    for n in [10_000, 100_000] {
        let mut mesh = String::new();
        for i in 0..n {
            let z = (f64::from(i) + 0.5) / f64::from(n) - 0.5;
            let corners = if i % 2 == 0 { "-1 -2 -3" } else { "-3 -2 -1" };
            let _ = writeln!(mesh, "v -1 -1 {z:.9}\nv 1 -1 {z:.9}\nv 0 1 {z:.9}\nf {corners}");
        }
        let fog = fog("interior", "1,0.5,0.2", "0,0,0", "");
        let stack = format!(
            "<shape type='obj'><string name='filename' value='a.obj'/><bsdf type='null'/>{fog}</shape>"
        );
        let body = [&eye("0,0,-1", 0.1, 1, ""), SKY, &stack].concat();
        let picture = render(&scene_with_bytes(&body, vec![("a.obj", mesh.into_bytes())]), PATH.1, 2);
        for (channel, sigma) in [1.0f64, 0.5, 0.2].into_iter().enumerate() {
            let case = format!("{n} boundaries along a ray, extinction {sigma}");
            let exact = Estimate::exact((-0.5 * sigma).exp());
            agree(&case, "e^−σ/2", picture.beauty(channel), exact, 0.02);
        }
    }
}

/// A ball of fog under a lamp, from a ten-thousandth to ten thousand times its size: the same random numbers give the
/// same picture, but for rays that rounding moves across an edge.
#[test]
fn scaled_fog_looks_the_same() {
    let with = |size: f64| {
        let scaled = |x: f64| format!("{:e}", x * size);
        let fog = dense_fog("interior", 3.0 / size, "0.9,0.8,0.7", "");
        let ball = format!(
            "<shape type='sphere'><float name='radius' value='{}'/><bsdf type='null'/>{fog}</shape>",
            scaled(1.0)
        );
        let lamp = rectangle(
            1.0,
            &format!("<rotate x='1' angle='90'/><scale value='{size:e}'/><translate y='{}'/>", scaled(2.0)),
            &area("5,5,5"),
        );
        let clips =
            format!("near_clip' value='{}'/><float name='far_clip' value='{}", scaled(0.01), scaled(100.0));
        let view = eye(&format!("0,0,{}", scaled(-4.0)), 40.0, 12, "")
            .replace("name='fov'", &format!("name='{clips}'/><float name='fov'"));
        stage(&[&view, &lamp, &ball])
    };
    for (name, settings) in METHODS {
        let plain = render(&with(1.0), settings, 32);
        for size in [1e-4, 1e4] {
            let case = format!("ball of fog of size {size:e}, {name}");
            super::same(&case, "as at size 1", &render(&with(size), settings, 32), &plain, 0.005);
        }
    }
}

/// Mean free paths of a box of fog, over a floor under a sky, from a thousandth of its size to a thousand of them:
/// photons and paths agree. In the densest, kernels are ten mean free paths wide; with a third of one, noise was 4 %.
#[test]
fn mean_free_paths_from_a_thousandth_to_a_thousand_agree() {
    let ground = rectangle(3.0, "<rotate x='1' angle='-90'/><translate y='-0.6'/>", &diffuse("0.5"));
    for (sigma, bound) in [(1e-3, 0.002), (0.1, 0.002), (1.0, 0.01), (10.0, 0.03), (1e3, 0.04)] {
        let fog = container("<scale value='0.5'/>", &dense_fog("interior", sigma, "0.8,0.8,0.8", ""));
        let stage = stage(&[&eye("0,0.3,-4", 20.0, 12, ""), SKY, &ground, &fog]);
        let path = render(&stage, PATH.1, 1024);
        // Thin fog has the narrow bounds; in the densest, few camera rays find a photon.
        let passes =
            [(1.0, 128), (1e2, 64)].into_iter().find(|(most, _)| sigma < *most).map_or(2048, |(_, n)| n);
        let maps = render(&stage, MAPS.1, passes);
        let case = format!("box of fog, mean free path {:e} of it, photon map", 1.0 / sigma);
        agree(&case, "as path", maps.beauty(1), path.beauty(1), bound);
    }
}
