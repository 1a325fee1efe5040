//! What holds for every model.

use std::f32::consts::PI;

use caustica::bsdf::{Event, Range, Sample, Transport};
use caustica::math::{Color, Vec2, Vec3};
use caustica::sampling::{CounterRng, warp};
use caustica::scene::Scene;

use super::{VIEWS, closure, direction, examples};

/// Between the roughness of the examples' narrowest lobes and that of the others, so that some materials
/// have lobes on both sides.
const GLOSSY: f32 = 0.25;

const ROWS: usize = 10;
const COLUMNS: usize = 16;
const CELLS: usize = ROWS * COLUMNS;

/// Frequencies of 200 000 sampled directions in 10 × 16 cells of (cosθ, φ), for glossy and for rough lobes
/// apart, against the integral of the density (midpoint rule, 32 × 16 points a cell). Other events share one
/// cell, whose probability is what the densities leave. By Wilson and Hilferty the cube root of χ²/k is
/// normal; 4.5 sigma in some 150 tests of fixed seed. The masking function of Beckmann surfaces is a fit
/// good to 0.35 %: it adds n·0.0035² = 2.5 to χ² at most, a tenth of a sigma or two.
#[test]
fn samples_follow_the_density() {
    for (name, scene) in examples() {
        samples_of_one_follow(name, &scene, Transport::Importance);
        // Their frames depend on the viewer, who is at the other end of light.
        if name.starts_with("tilted") {
            samples_of_one_follow(name, &scene, Transport::Radiance);
        }
    }
}

fn samples_of_one_follow(name: &str, scene: &Scene, mode: Transport) {
    let n = 200_000;
    for (theta, phi) in VIEWS {
        let wi = direction(theta, phi);
        let c = closure(scene, wi);
        let mut counts = vec![0u32; 2 * CELLS + 1];
        let mut rng = CounterRng::new(17, 0);
        for _ in 0..n {
            let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
            let sample = c.sample(wi, lobe, u, mode, GLOSSY);
            let cell = match sample.filter(|s| matches!(s.event, Event::Smooth | Event::Glossy)) {
                Some(s) => {
                    let phi = s.wo.y.atan2(s.wo.x) / (2.0 * PI) + 0.5;
                    let row = ((s.wo.z * 0.5 + 0.5) * ROWS as f32) as usize;
                    let column = ((phi * COLUMNS as f32) as usize).min(COLUMNS - 1);
                    let first = if s.event == Event::Glossy { CELLS } else { 0 };
                    first + row.min(ROWS - 1) * COLUMNS + column
                }
                None => 2 * CELLS,
            };
            counts[cell] += 1;
        }
        let mut expected = vec![0.0f64; 2 * CELLS];
        // Wide refraction from a grazing direction ends inside cells, where the midpoint rule is coarse.
        // Densities that jump need a finer rule.
        let fine = if name.starts_with("pbrt dielectric") || name.contains("fourier") { 64 } else { 16 };
        let ranges = [Range::rough(GLOSSY), Range::glossy(GLOSSY)];
        for (at, e) in expected.iter_mut().enumerate() {
            let (range, cell) = (ranges[at / CELLS], at % CELLS);
            if !c.has_smooth(wi, range) && !name.starts_with("tilted") {
                continue;
            }
            // In the angle rather than its cosine: lobes near the normal are narrow in the cosine.
            let edge = |row: usize| (row as f32 / ROWS as f32 * 2.0 - 1.0).acos();
            let (first, last) = (edge(cell / COLUMNS), edge(cell / COLUMNS + 1));
            for i in 0..2 * fine * fine {
                let theta = first + (last - first) * ((i / fine) as f32 + 0.5) / (2 * fine) as f32;
                let column = (cell % COLUMNS) as f32 + ((i % fine) as f32 + 0.5) / fine as f32;
                let phi = (column / COLUMNS as f32 - 0.5) * 2.0 * PI;
                let w = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                *e += f64::from(c.pdf(wi, w, mode, range) * theta.sin() * (first - last));
            }
            *e *= 2.0 * std::f64::consts::PI / (2 * COLUMNS * fine * fine) as f64;
        }
        expected.push(1.0 - expected.iter().sum::<f64>());
        let (mut square, mut cells) = (0.0, 0);
        for (&count, &probability) in counts.iter().zip(&expected) {
            let e = probability * f64::from(n);
            if e > 20.0 {
                square += (f64::from(count) - e).powi(2) / e;
                cells += 1;
            } else {
                // What should hardly happen may happen as often as the rest cell is uncertain (1e-4 of
                // all, the error of the midpoint rule), and as chance allows.
                let most = e.max(0.0) + 5.0 * e.max(0.0).sqrt() + 22.0;
                assert!(f64::from(count) <= most, "{name} at {theta}: {count}, expected {e}");
            }
        }
        let k = f64::from(cells - 1);
        if k > 0.0 {
            let z = ((square / k).cbrt() - 1.0 + 2.0 / (9.0 * k)) / (2.0 / (9.0 * k)).sqrt();
            assert!(z < 4.5, "{name} at {theta}: χ² {square:.1} of {k} cells, {z:.2} sigma");
        }
    }
}

/// Models whose stated albedo is exact; that of others is an estimate for choosing among lobes.
const EXACT: [&str; 10] = [
    "diffuse",
    "plastic",
    "plastic, nonlinear",
    "plastic, dim",
    "twosided",
    "twosided plastic",
    "mask",
    "masked plastic",
    "dielectric",
    "null",
];

/// Photons never gain power: the mean weight of samples (with noise of 10⁵ weights below 0.3 % of 1) is
/// at most 1, and it is the albedo that the closure states for its lobes where that is exact. Elsewhere
/// what is scattered must at least be known to be: a lobe of albedo 0 would never be followed.
#[test]
fn no_surface_returns_more_than_it_received() {
    for (name, scene) in examples() {
        for (theta, phi) in VIEWS {
            let wi = direction(theta, phi);
            let c = closure(&scene, wi);
            let mut rng = CounterRng::new(19, 0);
            let n = 100_000;
            let (mut sum, mut square) = ([0.0f64; 3], [0.0f64; 3]);
            for _ in 0..n {
                let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
                let sample = c.sample(wi, lobe, u, Transport::Importance, 0.0);
                let weight = sample.map_or(Color::ZERO, |s| s.weight);
                for i in 0..3 {
                    let w = f64::from(weight.lanes()[i]);
                    sum[i] += w;
                    square[i] += w * w;
                }
            }
            let through = c.transparency();
            let deltas: Color = c.deltas(wi, Transport::Importance).iter().map(|l| l.weight).sum();
            let stated = c.smooth_albedo(wi, Range::ALL) + deltas * (1.0 - through) + Color::splat(through);
            for i in 0..3 {
                let mean = sum[i] / f64::from(n);
                let sigma = ((square[i] / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
                // 2e-3: Beckmann's masking is a fit that may exceed the true one by 0.35 %; the table of
                // rough plastic is interpolated.
                // Photons on a tilted facet bring the facet's cosine instead of the surface's.
                let bound = if name.starts_with("tilted") { 2.0 } else { 1.0 + 2e-3 };
                assert!(mean <= bound + 4.5 * sigma, "{name} at {theta}: {mean}");
                let stated = f64::from(stated.lanes()[i]);
                if EXACT.contains(&name) {
                    // 1e-3: the internal reflectance of plastic is a fit, and it enters the stated albedo.
                    let error = (mean - stated).abs();
                    assert!(error < 4.5 * sigma + 1e-3, "{name} at {theta}: {mean} against {stated}");
                } else {
                    assert!(stated >= 0.3 * mean, "{name} at {theta}: {mean} against {stated}");
                }
            }
        }
    }
}

/// Nothing that `eval` scatters is left out by `sample`, whichever end the path comes from: the mean weight
/// of smooth samples is ∫ f·|cosθo| dωo, here by the mean over 10⁵ even directions. 4.5 standard errors of
/// the two means together, over all materials, views and ends; Beckmann's masking is a fit good to 0.35 %.
#[test]
fn all_that_is_scattered_can_be_drawn_from_both_ends() {
    let n = 100_000;
    let mean = |weights: &mut dyn FnMut() -> f32| {
        let (mut sum, mut square) = (0.0f64, 0.0f64);
        for _ in 0..n {
            let w = f64::from(weights());
            (sum, square) = (sum + w, square + w * w);
        }
        let mean = sum / f64::from(n);
        (mean, (square / f64::from(n) - mean * mean).max(0.0) / f64::from(n))
    };
    for (name, scene) in examples() {
        for ((theta, phi), mode) in VIEWS.into_iter().flat_map(|v| MODES.map(|mode| (v, mode))) {
            let wi = direction(theta, phi);
            let c = closure(&scene, wi);
            let mut rng = CounterRng::new(29, 0);
            let (drawn, drawn_variance) = mean(&mut || {
                let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
                let smooth = |s: &Sample| matches!(s.event, Event::Smooth | Event::Glossy);
                c.sample(wi, lobe, u, mode, 0.0).filter(smooth).map_or(0.0, |s| s.weight.lanes()[1])
            });
            let (held, held_variance) = mean(&mut || {
                let wo = warp::sphere(Vec2::from(rng.next_2d()));
                c.eval(wi, wo, mode, Range::ALL).lanes()[1] * wo.z.abs() * 4.0 * PI
            });
            let sigma = (drawn_variance + held_variance).sqrt();
            let off = (drawn - held).abs();
            assert!(
                off <= 4.5 * sigma + 0.0035 * held,
                "{name} at {theta}, {mode:?}: {drawn} of {held} ± {sigma}"
            );
        }
    }
}

const MODES: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// What photons are scattered by is what cameras see: f for importance from wi to wo is f for radiance
/// from wo to wi (Helmholtz, up to the η² of refraction). A sample's weight is f·cos/density. To f32
/// rounding (1e-7), which the half vector of refraction amplifies where grazing directions nearly cancel
/// in it: 3e-3 of the value, 2e-6 at least.
#[test]
fn photons_and_cameras_see_the_same_surface() {
    for (name, scene) in examples() {
        let mut rng = CounterRng::new(23, 0);
        for _ in 0..2000 {
            let mut w = || {
                let [u, v] = rng.next_2d();
                direction((1.0 - 2.0 * u).acos().to_degrees(), v * 360.0)
            };
            let (wi, wo) = (w(), w());
            let (a, b) = (closure(&scene, wi), closure(&scene, wo));
            let f = a.eval(wi, wo, Transport::Importance, Range::ALL);
            let g = b.eval(wo, wi, Transport::Radiance, Range::ALL);
            let near = (f - g).abs().max_element() <= 3e-3 * f.max_element() + 2e-6;
            assert!(near, "{name}: {f} and {g} for {wi} and {wo}");
            let apart = a.eval(wi, wo, Transport::Importance, Range::rough(GLOSSY))
                + a.eval(wi, wo, Transport::Importance, Range::glossy(GLOSSY));
            assert!((f - apart).abs().max_element() <= 1e-6 * f.max_element(), "{name}: {f} and {apart}");
            let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
            let Some(s) = a.sample(wi, lobe, u, Transport::Radiance, GLOSSY) else { continue };
            if s.weight == Color::ZERO {
                continue;
            }
            let range = match s.event {
                Event::Smooth => Range::rough(GLOSSY),
                Event::Glossy => Range::glossy(GLOSSY),
                Event::Delta | Event::Null => continue,
            };
            let pdf = a.pdf(wi, s.wo, Transport::Radiance, range);
            let weight = a.eval(wi, s.wo, Transport::Radiance, range) * s.wo.z.abs() / pdf;
            assert!((pdf / s.pdf - 1.0).abs() < 1e-3, "{name}: densities {pdf} and {}", s.pdf);
            // Grazing directions lose digits in z.
            let near = (weight - s.weight).abs().max_element() <= 2e-3 * s.weight.max_element();
            assert!(near, "{name}: {weight} and {}", s.weight);
            // Light that goes to the other side crosses the boundary.
            assert!(s.wo.z * wi.z > 0.0 || s.eta != 1.0 || name.contains("trans"), "{name}: {}", s.wo);
        }
    }
}
