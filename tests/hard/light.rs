//! Lamps that are tiny, huge, hidden, many, or absent.

use super::{METHODS, PATH, agree, black};
use crate::support::{
    DOWN, Estimate, UP, area, box_camera, camera, diffuse, lamp, rectangle, render, scene, sphere, walls,
};

const FLOOR: &str = "<rotate x='1' angle='-90'/>";

fn floor_view() -> String {
    [camera("0,3,0", "0,0,0", 30.0, 16), rectangle(1.0, FLOOR, &diffuse("0.5"))].concat()
}

/// A lamp of 1e-4 of the scene's size acts as a point with a cosine: with area A and radiance L at height h it
/// gives the radiance ρ/π · L·A·h²/d⁴ at distance d, with an error of the order of 1e-8.
#[test]
fn a_tiny_lamp_acts_as_a_point() {
    let half = 1e-4;
    let body = [floor_view(), rectangle(half, &format!("{DOWN}<translate y='1'/>"), &area("1e8"))].concat();
    // The film shows the square |x|, |z| ≤ 3 tan 15° at uniform scale.
    let edge = 3.0 * 15f64.to_radians().tan();
    let n = 400;
    let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * edge;
    let mean: f64 = (0..n * n).map(|i| (1.0 + at(i % n).powi(2) + at(i / n).powi(2)).powi(-2)).sum::<f64>()
        / f64::from(n * n);
    let truth = 0.5 / std::f64::consts::PI * 1e8 * 4.0 * half * half * mean;
    for (name, settings) in METHODS {
        let picture = render(&scene(&body), settings, 256);
        agree(
            &format!("lamp of 1e-4 of the scene, {name}"),
            "ρ/π·L·A·h²/d⁴",
            picture.beauty(1),
            Estimate::exact(truth),
            0.01,
        );
    }
}

/// Path tracing finds the light only when a path hits the lamp through the glass; photons carry it out.
#[test]
fn light_of_a_lamp_inside_glass_agrees() {
    let glass =
        "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>";
    let body =
        [floor_view(), sphere("0,0.6,0", 0.3, glass), sphere("0,0.6,0", 0.2, &(diffuse("0") + &area("10")))]
            .concat();
    // The picture shows the floor, and in the ball the lamp, which both methods show alike.
    let path = render(&scene(&body), PATH.1, 4096);
    let maps = render(&scene(&body), &[("photons", "8000"), ("caustic_photons", "60000")], 256);
    agree("lamp inside glass, photon map", "as path", maps.beauty(1), path.beauty(1), 0.02);
}

/// All photons of a spot light of 0.05° land in one place; its light equals that of next event estimation.
#[test]
fn a_beam_on_one_spot_keeps_its_light() {
    let beam = "<emitter type='spot'><float name='cutoff_angle' value='0.05'/><float name='beam_width' value='0.04'/>
        <rgb name='intensity' value='1e6'/>
        <transform name='to_world'><lookat origin='0.2,2,0.1' target='0.2,0,0.1' up='0,0,1'/></transform></emitter>";
    let body =
        [camera("0.2,3,0.1", "0.2,0,0.1", 0.2, 16), rectangle(1.0, FLOOR, &diffuse("0.5")), beam.to_owned()]
            .concat();
    let scene = scene(&body);
    let path = render(&scene, PATH.1, 1024);
    let photons = render(&scene, &[("nee", "false"), ("photons", "2000")], 256);
    agree(
        "beam on one spot, direct light from photons",
        "as next event estimation",
        photons.beauty(1),
        path.beauty(1),
        0.02,
    );
}

/// Light is linear over sixty orders of magnitude.
#[test]
fn lamps_of_1e_minus_30_and_1e30_scale_linearly() {
    for (name, settings) in METHODS {
        let with = |radiance: &str| {
            render(&scene(&[box_camera(16), walls("0.7"), lamp(0.3, radiance)].concat()), settings, 32)
        };
        let plain = with("1").beauty(1).mean;
        for power in [-30, 30] {
            let scaled = with(&format!("1e{power}")).beauty(1).mean / 10f64.powi(power);
            // The paths are the same: only f32 rounding differs, by 6e-8 each time.
            agree(
                &format!("lamp of 1e{power}, {name}"),
                "in proportion",
                Estimate::exact(scaled),
                Estimate::exact(plain),
                1e-4,
            );
        }
    }
}

/// Each lamp gives the irradiance I·h/d³; the sum is known, however lamps are chosen for sampling.
#[test]
fn hundreds_of_lamps_over_nine_orders_add_up() {
    let lamps: Vec<([f64; 3], f64)> = (0..300)
        .map(|i| {
            let t = f64::from(i);
            let place =
                [(t * 0.618).fract() * 1.6 - 0.8, 0.8 + (t * 0.414).fract(), (t * 0.732).fract() * 1.6 - 0.8];
            (place, 10f64.powf((t * 0.271).fract() * 9.0 - 6.0))
        })
        .collect();
    let text: String = lamps
        .iter()
        .map(|([x, y, z], i)| {
            format!("<emitter type='point'><point name='position' value='{x},{y},{z}'/><rgb name='intensity' value='{i}'/></emitter>")
        })
        .collect();
    let edge = 3.0 * 15f64.to_radians().tan();
    let n = 100;
    let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * edge;
    let mut truth = 0.0;
    for i in 0..n * n {
        for ([x, y, z], intensity) in &lamps {
            let d2 = (x - at(i % n)).powi(2) + y * y + (z - at(i / n)).powi(2);
            truth += intensity * y / d2.powf(1.5);
        }
    }
    truth *= 0.5 / std::f64::consts::PI / f64::from(n * n);
    let scene = scene(&(floor_view() + &text));
    for (name, settings) in METHODS {
        let picture = render(&scene, settings, 256);
        agree(
            &format!("300 lamps over nine orders, {name}"),
            "Σ ρ/π·I·h/d³",
            picture.beauty(1),
            Estimate::exact(truth),
            0.02,
        );
    }
}

#[test]
fn a_scene_without_lamps_is_black() {
    for (name, settings) in METHODS {
        let picture = render(&scene(&[box_camera(16), walls("0.7")].concat()), settings, 8);
        black(&format!("no lamp, {name}"), &picture);
    }
}

/// A lamp that lights only the ceiling: light reaches the floor after one bounce or more.
#[test]
fn purely_indirect_light_agrees() {
    let body = [
        camera("0,0.45,0", "0,0,0", 80.0, 16),
        rectangle(1.0, FLOOR, &diffuse("0.5")),
        rectangle(0.2, &format!("{UP}<translate y='0.5'/>"), &area("5")),
        rectangle(1.0, &format!("{DOWN}<translate y='1.5'/>"), &diffuse("0.8")),
    ]
    .concat();
    let path = render(&scene(&body), PATH.1, 2048);
    let maps = render(&scene(&body), &[("photons", "16000")], 256);
    agree("indirect light only, photon map against path", "the same", maps.beauty(1), path.beauty(1), 0.02);
}

/// A point lamp in the plane of the floor lights the walls like one 1e-4 above it. The latter would also light the
/// floor around it, so the floor is black.
#[test]
fn a_lamp_in_the_floor_lights_the_walls() {
    let with = |y: &str| {
        let shapes = walls("0.7");
        let (floor, rest) = shapes.split_once("</shape>").expect("the floor comes first");
        let lamp = format!(
            "<emitter type='point'><point name='position' value='0,{y},0'/><rgb name='intensity' value='3'/></emitter>"
        );
        scene(&[&box_camera(24), &floor.replace("0.7", "0"), "</shape>", rest, &lamp].concat())
    };
    for (name, settings) in METHODS {
        let inside = render(&with("-1"), settings, 128);
        let above = render(&with("-0.9999"), settings, 128);
        // A height of 1e-4 changes angles by 1e-4, and the light on the walls by less than 1e-3.
        let case = format!("point lamp in the floor, {name}");
        agree(&case, "as 1e-4 above it", inside.beauty(1), above.beauty(1), 0.01);
    }
}
