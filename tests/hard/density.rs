//! Bias of density estimation under uniform light: none away from edges, and at edges what theory predicts.

use caustica::math::kernel::KernelKind;
use caustica::math::{Color, Vec3};
use caustica::photon::{Photon, PhotonMap, Query};
use caustica::transport::PathClass;

use super::{agree, record};
use crate::support::{
    Estimate, Picture, Stage, UP, camera, diffuse, outcome, rectangle, render, scene, sphere,
};

/// Photons of flux h² on a lattice of spacing h = 1/16 give a uniform irradiance of 1. The sum of lookups of
/// radius 1.5 at 32 × 32 points of a cell is that of a lattice of spacing h/32 over the disc: by Poisson
/// summation its error falls as (h/(32 r))^1.5 for a kernel that ends in a step (2e-5) and faster for the
/// others; 1e-4 leaves room for f32.
#[test]
fn every_kernel_is_exact_for_uniform_light() {
    let h = 1.0 / 16.0_f32;
    let n = 64;
    let photons: Vec<Photon> = (0..n * n)
        .map(|i| Photon {
            p: Vec3::new((i % n - n / 2) as f32 * h, (i / n - n / 2) as f32 * h, 0.0),
            flux: Color::splat(h * h),
            wi: Vec3::Z,
            n: Vec3::Z,
            class: PathClass::Direct,
            depth: 1,
            smallness: Default::default(),
        })
        .collect();
    let map = PhotonMap::build(&photons, 1.0);
    let radius = 1.5_f32;
    for kernel in KernelKind::ALL {
        let mut sum = 0.0_f64;
        for i in 0..1024 {
            let p = Vec3::new((i % 32) as f32, (i / 32) as f32, 0.0) * (h / 32.0);
            map.within(&Query { p, n: Vec3::Z, radius, lift: 1e-6 }, &mut |_, d2| {
                sum +=
                    f64::from(kernel.weight(d2 / (radius * radius))) * f64::from(h * h / (radius * radius));
            });
        }
        let off = sum / 1024.0 - 1.0;
        record(&format!("uniform light, {kernel} kernel"), "irradiance 1", &format!("{off:+.1e}"), "1e-4");
        assert!(off.abs() < 1e-4, "{kernel}: {off:e}");
    }
}

/// A floor of albedo 1/2 under directional light of irradiance π: its radiance is 1/2 up to the edge.
fn edge(at: &str) -> Stage {
    let light = "<emitter type='directional'><vector name='direction' value='0,-1,0'/>
        <rgb name='irradiance' value='3.14159265'/></emitter>";
    // Half a unit of the floor, from 50 away.
    let fov = 2.0 * (0.25_f64 / 50.0).atan().to_degrees();
    let (x, z) = at.split_once(',').expect("two coordinates");
    let view = camera(&format!("{x},50,{z}"), &format!("{x},0,{z}"), fov, 32);
    scene(&[&view, &*rectangle(1.0, UP, &diffuse("0.5")), light].concat())
}

fn by_photons(scene: &Stage, boundary: &str) -> Picture {
    // The radius hardly shrinks, so that all passes measure the same bias.
    let settings = [
        ("nee", "false"),
        ("photons", "15000"),
        ("radius", "0.5"),
        ("alpha", "0.9999999"),
        ("boundary", boundary),
    ];
    render(scene, &settings, 16)
}

/// A strip along an edge, as wide as the radius. A point at distance t·r from the edge finds the share of the
/// kernel within t of one side; over the strip that is 1 − E|X|/2 for the kernel's marginal X, which for
/// Epanechnikov's is 1 − 8/(15π): 17 % are missing. In a corner both directions lose; the discs of points
/// closer to the corner than the radius reach over it, so the product of both is a bound from below only.
#[test]
fn the_bias_at_edges_is_as_predicted() {
    let strip = 1.0 - 8.0 / (15.0 * std::f64::consts::PI);
    let scene = edge("0.75,0");
    agree(
        "strip along an edge, no boundary correction",
        "1 − 8/(15π) of the light",
        by_photons(&scene, "false").beauty(1),
        Estimate::exact(0.5 * strip),
        0.01,
    );
    let corrected = by_photons(&scene, "true");
    agree("strip along an edge, corrected", "all of it", corrected.beauty(1), Estimate::exact(0.5), 0.01);

    let scene = edge("0.75,0.75");
    let plain = by_photons(&scene, "false").beauty(1);
    record(
        "square in a corner, no boundary correction",
        "less than at an edge",
        &format!("{:.2} % dark", 100.0 * (1.0 - 2.0 * plain.mean)),
        "documented bias",
    );
    assert!(plain.mean < 0.5 * strip - 4.5 * plain.sigma, "{plain:?}");
    let corrected = by_photons(&scene, "true");
    agree("square in a corner, corrected", "all of it", corrected.beauty(1), Estimate::exact(0.5), 0.01);
}

/// A ball alone under the sky: what it scatters meets nothing, so that no light path leaves a photon in either map.
/// As many as were asked for would take forever; the pilots of 2^18 paths find none, and a pass traces no more.
#[test]
fn photons_that_cannot_be_had_are_not_waited_for() {
    let plastic = "<bsdf type='plastic'/>";
    let ball = sphere("0,0,0", 1.0, plastic);
    let sky = "<emitter type='constant'/>";
    let stage = scene(&[&camera("0,2,5", "0,0,0", 40.0, 8), &*ball, sky].concat());
    let settings = [("photons", "stored:1000"), ("caustic_photons", "stored:250000"), ("mode", "classic")];
    let made = outcome(&stage, &settings, 1, &mut |_| {});
    let paths = made.statistics.light_paths;
    assert!(paths <= 2 << 18, "{paths} light paths");
}
