//! Laws of phase functions.

use std::f64::consts::PI;

use super::*;
use crate::math::{Color, gauss_legendre};
use crate::medium::{Matrices, Symmetric, Volume};
use crate::sampling::{CounterRng, warp};

const ROWS: usize = 12;
const COLUMNS: usize = 8;

fn hg(g: f32) -> Phase {
    HenyeyGreenstein::new(g).into()
}

/// Every kind, with its integral (0: it depends on the direction).
fn every_kind() -> Vec<(&'static str, Phase, f64)> {
    let table = Tabulated::new(&[0.5, 0.0, 0.1, 0.1, 3.0]).unwrap();
    let mixture =
        |weights: [f32; 2]| Mixture::new(vec![(weights[0], hg(0.8)), (weights[1], hg(-0.3))]).unwrap();
    let blend = Blend { weight: Volume::Constant(Color::splat(0.3)), parts: [Rayleigh.into(), hg(0.6)] };
    let fibre = Volume::Constant(Color::from_lanes([0.0, 2.0, 1.0]));
    // An ellipsoid of half axes 1, 0.5 and 0.2, turned.
    let fibres = |deviation| Phase::Microflake(Box::new(Microflake::new(deviation, Some(fibre.clone()))));
    let flakes = Sggx::new(Matrices::Constant(Symmetric([0.7, 0.5, 0.09, 0.25, 0.05, -0.1])));
    vec![
        ("isotropic", Isotropic.into(), 1.0),
        ("hg 0", hg(0.0), 1.0),
        ("hg 0.85", hg(0.85), 1.0),
        ("hg -0.7", hg(-0.7), 1.0),
        ("rayleigh", Rayleigh.into(), 1.0),
        ("tabulated", table.into(), 1.0),
        ("mixture", mixture([0.3, 0.5]).into(), 0.8),
        ("mixture above 1", mixture([2.0, 1.0]).into(), 1.0),
        ("blend", Phase::Blend(Box::new(blend)), 1.0),
        ("kajiya-kay", Phase::KajiyaKay(Box::new(KajiyaKay::new(0.3, 0.6, 8.0, Some(fibre.clone())))), 0.0),
        ("sggx", Phase::Sggx(Box::new(flakes)), 1.0),
        ("microflake 0.2", fibres(0.2), 1.0),
        ("microflake 1", fibres(1.0), 1.0),
    ]
}

fn directions() -> impl Iterator<Item = Vec3> {
    let mut rng = CounterRng::new(11, 4);
    (0..4).map(move |_| warp::sphere(rng.next_2d().into()))
}

/// ∫ of `f` over the sphere: Gauss's rule in pieces of the cosine to `axis`, even steps around it.
fn integral(axis: Vec3, f: impl Fn(Vec3) -> f32) -> f64 {
    let (nodes, pieces, turns) = (gauss_legendre(16), 24, 96);
    let mut sum = 0.0;
    for piece in 0..pieces {
        for (x, weight) in &nodes {
            let h = 2.0 * (piece as f64 + x) / pieces as f64;
            for k in 0..turns {
                let w = around(axis, h as f32, (k as f32 + 0.5) / turns as f32);
                sum += weight * f64::from(f(w));
            }
        }
    }
    sum * 4.0 * PI / f64::from(pieces * turns)
}

/// 1 for all that scatter everything. The rule is good to 1e-4 for the narrowest of these lobes.
#[test]
fn a_phase_function_sends_light_somewhere() {
    for (name, phase, sum) in every_kind() {
        for wi in directions() {
            let of_value = integral(wi, |wo| phase.eval(Vec3::ZERO, wi, wo));
            let of_density = integral(wi, |wo| phase.pdf(Vec3::ZERO, wi, wo));
            assert!((of_density - 1.0).abs() < 1e-3, "{name}: density {of_density}");
            if sum > 0.0 {
                assert!((of_value - sum).abs() < 1e-3, "{name}: {of_value}");
            } else {
                assert!(of_value < 0.9 + 1e-3, "{name}: {of_value}");
            }
        }
    }
    // Light across the fibre is scattered in full.
    let fibre = Volume::Constant(Color::from_lanes([0.0, 0.0, 1.0]));
    let phase = KajiyaKay::new(0.3, 0.6, 8.0, Some(fibre));
    let across = integral(Vec3::Z, |wo| phase.eval(Vec3::ZERO, Vec3::X, wo));
    assert!((across - 0.9).abs() < 1e-3, "{across}");
}

/// Light that goes the other way along the same path is scattered as much.
#[test]
fn scattering_is_reciprocal() {
    let mut rng = CounterRng::new(12, 4);
    for (name, phase, _) in every_kind() {
        for _ in 0..200 {
            let [a, b] = std::array::from_fn(|_| warp::sphere(rng.next_2d().into()));
            let there = phase.area(Vec3::ZERO, a) * phase.eval(Vec3::ZERO, a, b);
            let back = phase.area(Vec3::ZERO, b) * phase.eval(Vec3::ZERO, b, a);
            assert!((there - back).abs() <= 1e-3 * there.max(1e-3), "{name}: {there} and {back}");
            assert!(phase.area(Vec3::ZERO, a) <= phase.largest_area() * 1.0001, "{name}");
        }
    }
}

/// Frequencies of 200 000 directions in cells of equal solid angle against the integral of the density; weights are
/// value over density. By Wilson and Hilferty the cube root of χ²/k is normal; 4.5 sigma.
#[test]
fn samples_follow_the_density() {
    let n = 200_000;
    for (name, phase, _) in every_kind() {
        for wi in directions() {
            let mut counts = [0u32; ROWS * COLUMNS];
            let mut rng = CounterRng::new(13, 0);
            for _ in 0..n {
                let sample = phase.sample(Vec3::ZERO, wi, rng.next_f32(), rng.next_2d().into());
                let s = sample.unwrap_or_else(|| panic!("{name}"));
                assert!((s.wo.length() - 1.0).abs() < 1e-4, "{name}");
                let value = phase.eval(Vec3::ZERO, wi, s.wo);
                assert!(
                    (s.weight * s.pdf - value).abs() <= 2e-3 * value,
                    "{name}: {} × {} is not {value}",
                    s.weight,
                    s.pdf
                );
                counts[cell(s.wo)] += 1;
            }
            let expected = expected(&phase, wi);
            let (mut square, mut k) = (0.0, -1.0);
            for (&count, &share) in counts.iter().zip(&expected) {
                let e = share * f64::from(n);
                if e > 20.0 {
                    square += (f64::from(count) - e).powi(2) / e;
                    k += 1.0;
                }
            }
            let z = ((square / k).cbrt() - 1.0 + 2.0 / (9.0 * k)) / (2.0 / (9.0 * k)).sqrt();
            assert!(z < 4.5, "{name}: χ² {square:.1} of {k} cells, {z:.2} sigma");
        }
    }
}

fn cell(w: Vec3) -> usize {
    let phi = w.y.atan2(w.x) / (2.0 * std::f32::consts::PI) + 0.5;
    let row = ((w.z * 0.5 + 0.5) * ROWS as f32) as usize;
    row.min(ROWS - 1) * COLUMNS + ((phi * COLUMNS as f32) as usize).min(COLUMNS - 1)
}

/// Integral of the density over each cell, by the midpoint rule.
fn expected(phase: &Phase, wi: Vec3) -> Vec<f64> {
    let fine = 48;
    let mut shares = vec![0.0; ROWS * COLUMNS];
    let (rows, columns) = (ROWS * fine, COLUMNS * fine);
    for i in 0..rows {
        let z = (i as f32 + 0.5) / rows as f32 * 2.0 - 1.0;
        let r = (1.0 - z * z).sqrt();
        for j in 0..columns {
            let (sin, cos) =
                (((j as f32 + 0.5) / columns as f32 - 0.5) * 2.0 * std::f32::consts::PI).sin_cos();
            let pdf = phase.pdf(Vec3::ZERO, wi, Vec3::new(r * cos, r * sin, z));
            shares[i / fine * COLUMNS + j / fine] += f64::from(pdf) * 4.0 * PI / (rows * columns) as f64;
        }
    }
    shares
}

/// The narrowest lobes that can be asked for keep their integral: what `g` = ±1 is taken for.
#[test]
fn extreme_lobes_stay_finite() {
    for g in [1.0, -1.0, 0.9999, 5.0, f32::EPSILON] {
        let phase = hg(g);
        let mut rng = CounterRng::new(14, 0);
        for _ in 0..1000 {
            let wi = warp::sphere(rng.next_2d().into());
            let s = phase.sample(Vec3::ZERO, wi, 0.5, rng.next_2d().into()).unwrap();
            assert!(s.pdf.is_finite() && s.pdf > 0.0 && s.wo.is_finite(), "{g}");
        }
    }
    assert!(Tabulated::new(&[1.0]).is_none() && Tabulated::new(&[0.0, 0.0]).is_none());
    assert!(Tabulated::new(&[1.0, f64::NAN]).is_none());
    assert!(Mixture::new(vec![(0.0, Isotropic.into())]).is_none());
}
