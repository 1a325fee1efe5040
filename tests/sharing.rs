//! Camera samples that share the indirect light of diffuse surfaces: less noise, the same light, and sharp edges.

use caustica::film::Layer;

use crate::support::{
    Picture, Stage, assert_agree, box_camera, diffuse, lamp, rectangle, render, scene, sphere, walls,
};

const SIDE: usize = 64;

/// A ball stands on the floor of a room, seen directly and in a mirror ball.
fn room() -> Stage {
    let balls = [
        sphere("0.4,-0.7,0.2", 0.3, &diffuse("0.2,0.5,0.7")),
        sphere("-0.45,-0.6,-0.2", 0.4, "<bsdf type='conductor'/>"),
    ];
    scene(&[box_camera(SIDE as u32), walls("0.7"), lamp(0.3, "8"), balls.concat()].concat())
}

fn indirect(picture: &Picture) -> Vec<f64> {
    (0..picture.pixels.len())
        .map(|i| picture.pixels.layer(i, Layer::Indirect, picture.passes).iter().sum::<f64>() / 3.0)
        .collect()
}

/// Mean squared difference, relative to the mean of the picture.
fn error(picture: &[f64], reference: &[f64]) -> f64 {
    let n = reference.len() as f64;
    let mean = reference.iter().sum::<f64>() / n;
    picture.iter().zip(reference).map(|(a, b)| ((a - b) / mean).powi(2)).sum::<f64>() / n
}

/// With one way to gather and few passes, most of the noise is that of the directions in which samples look. Without bias
/// sharing within three pixels (a disc of 28 places, the outer ones of less weight) would leave a tenth of it; the noise of
/// the map, and places that share with few others, leave more.
#[test]
fn sharing_takes_noise_away_and_no_light() {
    let stage = room();
    for indirect_by in ["gather", "trace"] {
        let render = |radius: &str, seed: &str, passes: u32| {
            let changes = [
                ("indirect", indirect_by),
                ("gather_radius", radius),
                ("gather_rays", "1"),
                ("camera_samples", "4"),
                ("photons", "20000"),
                ("caustic_photons", "4000"),
                ("seed", seed),
            ];
            render(&stage, &changes, passes)
        };
        let reference = render("0", "5", 512);
        let (own, shared) = (render("0", "1", 8), render("auto", "1", 8));
        let [own_error, shared_error] = [&own, &shared].map(|p| error(&indirect(p), &indirect(&reference)));
        println!("{indirect_by}: {own_error:.2e} alone, {shared_error:.2e} shared");
        assert!(shared_error < 0.5 * own_error, "{indirect_by}: {shared_error} of {own_error}");
        // After 64 passes noise is about 0.1 % of the mean; the bias of regression over three pixels in the corners of a
        // picture of 64 is a few tenths of a percent.
        let long = render("auto", "2", 64);
        for (layer, bound) in [(Layer::Indirect, 0.006), (Layer::Direct, 0.002), (Layer::Emission, 0.003)] {
            let name = format!("{indirect_by}, {layer:?}");
            let of = |picture: &Picture| picture.estimate(&[layer], 1);
            assert_agree(&name, of(&long), of(&reference), bound);
        }
    }
}

/// On both sides of the edges of a texture and of a ball's outline the light is as without sharing, although within three
/// pixels there is some of eight times as much, or a tenth.
#[test]
fn edges_stay_sharp() {
    let squares = "<bsdf type='diffuse'><texture name='reflectance' type='checkerboard'>\
         <rgb name='color0' value='0.08'/><rgb name='color1' value='0.64'/>\
         <transform name='to_uv'><scale x='8' y='8'/></transform></texture></bsdf>";
    let wall = rectangle(0.9, "<translate z='-0.99'/>", squares);
    let ball = sphere("0,0,-0.3", 0.4, &diffuse("0.05"));
    let stage = scene(&[box_camera(SIDE as u32), walls("0.7"), lamp(0.3, "8"), wall, ball].concat());
    let of = |radius: &str, seed: &str, passes: u32| {
        let changes =
            [("indirect", "gather"), ("gather_radius", radius), ("photons", "20000"), ("seed", seed)];
        indirect(&render(&stage, &changes, passes))
    };
    let (alone, shared) = (of("0", "1", 256), of("auto", "2", 64));
    let beside = |i: usize| {
        let (x, y) = (i % SIDE, i / SIDE);
        let across = [x.checked_sub(1).map(|x| (x, y)), Some((x + 1, y)).filter(|_| x + 1 < SIDE)];
        let along = [y.checked_sub(1).map(|y| (x, y)), Some((x, y + 1)).filter(|_| y + 1 < SIDE)];
        across.into_iter().chain(along).flatten().map(|(x, y)| y * SIDE + x)
    };
    let edges: [(&str, &dyn Fn(f64) -> bool); 2] =
        [("dark", &|ratio| ratio > 3.0), ("bright", &|ratio| ratio < 1.0 / 3.0)];
    for (name, is_edge) in edges {
        // Some see past the room, others the lamp.
        let lit = |&i: &usize| alone[i] > 0.0;
        let pixels =
            (0..alone.len()).filter(lit).filter(|&i| beside(i).any(|j| is_edge(alone[j] / alone[i])));
        let differences: Vec<f64> = pixels.map(|i| shared[i] / alone[i] - 1.0).collect();
        let n = differences.len() as f64;
        let mean = differences.iter().sum::<f64>() / n;
        let spread = (differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / n).sqrt();
        println!("{name}: {n} pixels, {mean:+.4} ± {:.4}, each {spread:.3}", spread / n.sqrt());
        assert!(n > 100.0, "{name}: {n} pixels at edges");
        // Light of the pixels beside would be off by a factor.
        assert!(mean.abs() < 0.01 + 3.0 * spread / n.sqrt(), "{name}: {mean}");
    }
}

/// Where photons are seen directly, nothing is shared.
#[test]
fn density_estimation_shares_nothing() {
    let stage = room();
    let of = |radius: &str| {
        let changes = [("indirect", "density"), ("gather_radius", radius), ("photons", "4000")];
        render(&stage, &changes, 2).pixel_values()
    };
    assert!(of("0") == of("6"));
}
