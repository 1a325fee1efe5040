//! Photons in media: what is found along a segment against brute force, and the estimators against closed forms.

use std::f64::consts::PI;

use caustica::math::kernel::{Epanechnikov, Kernel};
use caustica::math::{Color, Vec3};
use caustica::photon::volume::{
    Beam, BeamMap, Crossing, Found, Near, Passage, PointMap, Segment, VolumeGather, VolumePhoton,
};
use caustica::sampling::CounterRng;
use proptest::prelude::*;

fn photon(p: Vec3) -> VolumePhoton {
    VolumePhoton { p, flux: Color::ONE, wi: Vec3::Z, medium: 0, depth: 1 }
}

fn beam(o: Vec3, d: Vec3, length: f32) -> Beam {
    Beam { o, d, length, flux: Color::ONE, medium: 0, depth: 1 }
}

/// Photons near a segment as the definition has them, in the arithmetic of the map, so that sets compare exactly.
fn near(map: &PointMap, indices: &[u32], segment: &Segment, radius: f32) -> Vec<Near> {
    let [dx, dy, dz] = segment.d.to_array();
    let of = |&index: &u32| {
        let [x, y, z] = (map.place(index) - segment.o).to_array();
        let t = x * dx + y * dy + z * dz;
        let [x, y, z] = [x - t * dx, y - t * dy, z - t * dz];
        let d2 = x * x + y * y + z * z;
        (d2 < radius * radius && (0.0..segment.length).contains(&t)).then_some(Near { index, d2, t })
    };
    indices.iter().filter_map(of).collect()
}

fn check_points(photons: &[VolumePhoton], segment: &Segment, radius: f32) {
    let map = PointMap::build(photons, radius);
    assert_eq!(map.len(), photons.len());
    // The map has packets of eight, the last of which may have empty lanes, at infinity.
    let all: Vec<u32> = (0..photons.len().next_multiple_of(8) as u32).collect();
    let stored: Vec<u32> = all.into_iter().filter(|&i| map.place(i).is_finite()).collect();
    assert_eq!(stored.len(), photons.len());
    let mut found = Vec::new();
    map.along(segment, &mut found);
    found.sort_by_key(|n| n.index);
    assert_eq!(found, near(&map, &stored, segment, radius));
}

/// Multiples of 1/4 make coincident photons, and segments that begin or end at one, common.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![(-8i32..=8).prop_map(|i| i as f32 * 0.25), -2.0f32..2.0]
}

fn point() -> impl Strategy<Value = Vec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
}

fn direction() -> impl Strategy<Value = Vec3> {
    prop_oneof![
        Just(Vec3::X),
        Just(-Vec3::Y),
        Just(Vec3::Z),
        point().prop_filter_map("zero", |p| p.try_normalize())
    ]
}

fn length() -> impl Strategy<Value = f32> {
    prop_oneof![1 => Just(0.0f32), 2 => Just(1.0), 4 => 0.0f32..6.0]
}

fn radius() -> impl Strategy<Value = f32> {
    prop_oneof![0.01f32..3.0, Just(1e-6), Just(0.25)]
}

/// ∫K along each beam by the midpoint rule.
fn by_parts(beam: &Beam, segment: &Segment, radius: f64) -> f64 {
    const PARTS: u32 = 20_000;
    let (length, r2) = (f64::from(beam.length), radius * radius);
    let v = |v: Vec3| v.as_dvec3();
    let mut sum = 0.0;
    for k in 0..PARTS {
        let s = length * (f64::from(k) + 0.5) / f64::from(PARTS);
        let w = v(beam.o) + v(beam.d) * s - v(segment.o);
        let t = w.dot(v(segment.d));
        let d2 = (w - v(segment.d) * t).length_squared();
        if d2 < r2 && (0.0..f64::from(segment.length)).contains(&t) {
            sum += 2.0 / (PI * r2) * (1.0 - d2 / r2);
        }
    }
    sum * length / f64::from(PARTS)
}

/// What a map says of each beam: the sum of weights over its pieces.
fn weights(beams: &[Beam], segment: &Segment, radius: f32) -> Vec<f64> {
    let map = BeamMap::build(beams, radius);
    let mut found: Vec<Crossing> = Vec::new();
    map.along(segment, &mut found);
    let mut sums = vec![0.0; beams.len()];
    for crossing in found {
        assert!(crossing.weight.is_finite() && crossing.weight >= 0.0, "{crossing:?}");
        assert!((0.0..=segment.length).contains(&crossing.t), "{crossing:?}");
        sums[crossing.beam as usize] += f64::from(crossing.weight);
    }
    sums
}

/// The midpoint rule errs by no more than two of its parts at the ends, where the kernel is no larger than at its middle
/// (a beam may enter through the end of a segment, where the kernel jumps); single precision adds 1e-4 of that.
fn check_beams(beams: &[Beam], segment: &Segment, radius: f32) {
    for (found, beam) in weights(beams, segment, radius).iter().zip(beams) {
        let r = f64::from(radius);
        let expected = by_parts(beam, segment, r);
        let most = 2.0 / (PI * r * r) * f64::from(beam.length);
        let bound = most * (2.0 / 20_000.0 + 1e-4) + 1e-4 * expected;
        assert!(
            (found - expected).abs() <= bound,
            "{found} of {expected} ± {bound}: {beam:?} {segment:?} {r}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn photons_found_agree_with_brute_force(
        places in prop::collection::vec(point(), 0..1200),
        (o, d, length, radius) in (point(), direction(), length(), radius()),
        scale in prop_oneof![Just(1.0f32), Just(1e-4), Just(1e4)],
    ) {
        let photons: Vec<VolumePhoton> = places.into_iter().map(|p| photon(p * scale)).collect();
        let segment = Segment::new(o * scale, d, length * scale);
        check_points(&photons, &segment, radius * scale);
    }

    #[test]
    fn beams_found_agree_with_brute_force(
        beams in prop::collection::vec((point(), direction(), length()), 0..40),
        (o, d, length, radius) in (point(), direction(), length(), 0.01f32..2.0),
    ) {
        let beams: Vec<Beam> = beams.into_iter().map(|(o, d, length)| beam(o, d, length)).collect();
        check_beams(&beams, &Segment::new(o, d, length), radius);
    }
}

/// A beam whose closest approach is at distance `d0` under an angle θ has the weight
/// (1/sin θ)·8/(3π·r)·(1 − d0²/r²)^(3/2): a kernel of one dimension. Parallel ones have K(d0) times their common length.
#[test]
fn weights_of_beams_have_their_closed_forms() {
    let segment = Segment::new(Vec3::ZERO, Vec3::X, 10.0);
    let r = 0.125f32;
    for d0 in [0.0f32, 0.05, 0.1, 0.1249] {
        let u2 = 1.0 - f64::from(d0 / r).powi(2);
        for degrees in [90.0f32, 40.0, 5.0, 2.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let d = Vec3::new(cos, sin, 0.0);
            let crossing = beam(Vec3::new(5.0, 0.0, d0) - d * 4.0, d, 8.0);
            let expected = 8.0 / (3.0 * PI * f64::from(r * sin)) * u2.powf(1.5);
            let found = weights(&[crossing], &segment, r)[0];
            // At the very edge, 1 − d0²/r² has lost four digits of seven.
            let bound = if d0 < 0.12 { 1e-4 } else { 1e-2 };
            assert!((found / expected - 1.0).abs() < bound, "{d0} {degrees}: {found} of {expected}");
        }
        // 3 of its length are beside the segment.
        for (o, d) in [(7.0, Vec3::X), (3.0, -Vec3::X)] {
            let expected = 2.0 / (PI * f64::from(r * r)) * u2 * 3.0;
            let found = weights(&[beam(Vec3::new(o, d0, 0.0), d, 8.0)], &segment, r)[0];
            assert!((found / expected - 1.0).abs() < 1e-3, "{d0}: {found} of {expected}");
        }
    }
}

#[test]
fn nothing_is_found_where_nothing_is() {
    let segment = Segment::new(Vec3::ZERO, Vec3::X, 1.0);
    check_points(&[], &segment, 0.1);
    check_beams(&[], &segment, 0.1);
    // All in one place, on a segment of no length, and beams of no length.
    let none = Segment::new(segment.o, segment.d, 0.0);
    for segment in [segment, none] {
        check_points(&[photon(Vec3::ZERO); 100], &segment, 0.1);
        check_beams(&[beam(Vec3::ZERO, Vec3::X, 0.0); 100], &segment, 0.1);
        check_beams(&[beam(Vec3::ZERO, Vec3::X, 1.0); 100], &segment, 0.1);
    }
    // The least radius that a schedule comes to.
    let found = weights(&[beam(Vec3::new(0.5, -1.0, 0.0), Vec3::Y, 2.0)], &segment, 1e-18);
    assert!((found[0] * 1e-18 / (8.0 / (3.0 * PI)) - 1.0).abs() < 1e-4, "{found:?}");
}

/// A medium that scatters evenly, and takes of the light by the way.
#[derive(Debug)]
struct Hazy;

impl Passage for Hazy {
    fn transmittance(&self, t: f32) -> Color {
        Color::splat((-t).exp())
    }
    fn phase(&self, _: Vec3, _: Vec3) -> f32 {
        1.0
    }
    fn scattering(&self, _: Vec3, _: Vec3) -> Color {
        Color::ONE
    }
}

/// A slab with photons, or beams along it, spread evenly, and none outside: what a segment through it finds is
/// density·(1 − e^−ℓ), at any slant and with any radius, because the planes of the slab are those of the segment. What
/// is left of the slab behind those planes finds nothing, although it is within the radius.
#[test]
fn flat_boundaries_take_no_light_and_let_none_through() {
    let (width, count, radius) = (10.0f32, 400_000, 0.3f32);
    let mut rng = CounterRng::new(21, 3);
    let mut photons = Vec::new();
    let mut beams = Vec::new();
    for _ in 0..count {
        let [x, y, z, turn] = std::array::from_fn(|_| rng.next_f32());
        let p = Vec3::new((x - 0.5) * width, (y - 0.5) * width, z);
        photons.push(photon(p));
        let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
        beams.push(beam(p, Vec3::new(cos, sin, 0.0), 0.1));
    }
    let (points, lines) = (PointMap::build(&photons, radius), BeamMap::build(&beams, radius));
    let density = f64::from(count) / f64::from(width * width);
    // The mean over nine segments side by side.
    let found = |segment: &Segment| {
        let mut scratch = Found::default();
        let mut sums = [0.0; 2];
        for i in -4..=4 {
            let mut segment = *segment;
            segment.o += Vec3::Y * (0.6 * i as f32);
            let segment = &segment;
            let at = VolumeGather { segment, medium: 0, max_photon_depth: 9, passage: &Hazy };
            let light = [points.radiance(&at, &mut scratch), lines.radiance(&at, &mut scratch) / 0.1];
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += f64::from(light.lanes()[0]) / 9.0);
        }
        sums
    };
    for degrees in [0.0f32, 40.0, 65.0, 78.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (d, middle) = (Vec3::new(sin, 0.0, cos), Vec3::new(0.0, 0.0, 0.5));
        let length = 1.0 / cos;
        let across = Segment::new(middle - d * (0.5 * length), d, length);
        let exact = density * (1.0 - f64::from(-length).exp());
        let slab = across.begins_at(-Vec3::Z).ends_at(Vec3::Z);
        for light in found(&slab) {
            // The relative variance of one is 4/(3π·r²) over density·ℓ/2 at most: 4.5 sigma of nine.
            assert!((light / exact - 1.0).abs() < 0.07, "{degrees}: {light} of {exact}");
        }
        let behind = Segment::new(across.at(length), d, 3.0).begins_at(Vec3::Z);
        let before = Segment::new(across.at(-3.0), d, 3.0).ends_at(Vec3::Z);
        for outside in [behind, before] {
            assert!(found(&outside).iter().all(|light| *light < 1e-3 * exact), "{degrees}");
        }
    }
}

/// A medium that scatters evenly and takes nothing.
#[derive(Debug)]
struct Even;

impl Passage for Even {
    fn transmittance(&self, _: f32) -> Color {
        Color::ONE
    }
    fn phase(&self, _: Vec3, _: Vec3) -> f32 {
        (0.25 / PI) as f32
    }
    fn scattering(&self, _: Vec3, _: Vec3) -> Color {
        Color::splat(0.7)
    }
}

fn gather(segment: &Segment) -> VolumeGather<'_, Even> {
    VolumeGather { segment, medium: 0, max_photon_depth: 9, passage: &Even }
}

/// Segments through the middle of a cube of side 2.
fn segments(rng: &mut CounterRng) -> Vec<Segment> {
    (0..400)
        .map(|_| {
            let mut float = || rng.next_f32() * 2.0 - 1.0;
            let d = Vec3::new(float(), float(), float()).normalize_or(Vec3::X);
            Segment::new(Vec3::new(float(), float(), float()) * 0.2, d, 0.3)
        })
        .collect()
}

/// N photons of flux 1 in a volume V scatter N/(4π·V) a length. Of a Poisson pattern, an estimate over the length ℓ has
/// the relative variance ∫K²·V/(N·ℓ), with ∫K² = 4/(3π·r²). Segments that share photons agree too well or too badly:
/// 400·πr²·ℓ of them lie in the middle 0.5 of the cube, so that they count as a tenth of their number at least.
#[test]
fn a_uniform_density_of_photons_gives_its_radiance() {
    let mut rng = CounterRng::new(11, 0);
    let n = 200_000;
    let photons: Vec<VolumePhoton> = (0..n)
        .map(|_| {
            let mut float = || rng.next_f32() * 2.0 - 1.0;
            photon(Vec3::new(float(), float(), float()))
        })
        .collect();
    let radius = 0.04f32;
    let map = PointMap::build(&photons, radius);
    let mut found = Found::default();
    let segments = segments(&mut rng);
    let density = f64::from(n) / 8.0;
    let mean = segments.iter().map(|s| map.radiance(&gather(s), &mut found).lanes()[0]).sum::<f32>() / 400.0;
    let expected = density * 0.3 / (4.0 * PI);
    let one = (4.0 / (3.0 * PI * f64::from(radius * radius)) / (density * 0.3)).sqrt();
    let sigma = one / 40.0f64.sqrt();
    let error = f64::from(mean) / expected - 1.0;
    println!("{:+.3} % (sigma {:.3} %)", 100.0 * error, 100.0 * sigma);
    assert!(error.abs() < 4.5 * sigma, "{error} with sigma {sigma}");
    assert_eq!(found.lookups, 400);
}

/// Random chords of a ball of radius R, of even density in place and direction: n of them with flux 1 are the fluence
/// n/(π·R²) everywhere. Both the number of crossings of a segment and their weights are random, so that the variance of
/// an estimate is the mean of Σw², which is measured.
#[test]
fn an_isotropic_field_of_beams_gives_its_radiance() {
    let mut rng = CounterRng::new(12, 0);
    let (n, big, radius) = (20_000, 1.0f32, 0.05f32);
    let beams: Vec<Beam> = (0..n)
        .map(|_| {
            let (z, phi) = (rng.next_f32() * 2.0 - 1.0, rng.next_f32() * std::f32::consts::TAU);
            let ring = (1.0 - z * z).sqrt();
            let d = Vec3::new(ring * phi.cos(), ring * phi.sin(), z);
            let frame = caustica::math::Frame::from_normal(d);
            let (rho, phi) = (big * rng.next_f32().sqrt(), rng.next_f32() * std::f32::consts::TAU);
            let across = frame.to_world(Vec3::new(rho * phi.cos(), rho * phi.sin(), 0.0));
            let half = (big * big - rho * rho).max(0.0).sqrt();
            beam(across - d * half, d, 2.0 * half)
        })
        .collect();
    let map = BeamMap::build(&beams, radius);
    let segments = segments(&mut rng);
    let (mut found, mut crossings) = (Found::default(), Vec::new());
    let (mut mean, mut square) = (0.0f64, 0.0f64);
    for s in &segments {
        mean += f64::from(map.radiance(&gather(s), &mut found).lanes()[0]) / 400.0;
        map.along(s, &mut crossings);
        let mut of_beam = std::collections::HashMap::new();
        crossings.iter().for_each(|c| *of_beam.entry(c.beam).or_insert(0.0) += f64::from(c.weight));
        square += of_beam.values().map(|w| (w * 0.7 / (4.0 * PI)).powi(2)).sum::<f64>() / 400.0;
    }
    let expected = 0.7 / (4.0 * PI) * f64::from(n) / PI * 0.3;
    // As with photons, segments count as a tenth of their number.
    let sigma = (square / 40.0).sqrt() / expected;
    let error = mean / expected - 1.0;
    println!("{:+.3} % (sigma {:.3} %)", 100.0 * error, 100.0 * sigma);
    assert!(error.abs() < 4.5 * sigma, "{error} with sigma {sigma}");
}

/// Photons of another medium, and those whose path would be too long, are no light here.
#[test]
fn only_photons_of_the_medium_and_within_the_depth_count() {
    let segment = Segment::new(Vec3::ZERO, Vec3::X, 2.0);
    let at = gather(&segment);
    let kinds = [(0, 1), (1, 1), (0, 10)];
    let points = kinds.map(|(medium, depth)| VolumePhoton { medium, depth, ..photon(Vec3::X) });
    let beams = kinds.map(|(medium, depth)| Beam { medium, depth, ..beam(Vec3::X - Vec3::Y, Vec3::Y, 2.0) });
    let (points, beams) = (PointMap::build(&points, 0.1), BeamMap::build(&beams, 0.1));
    let mut found = Found::default();
    let one = 0.25 / PI * f64::from(1.0f32 / (0.1f32 * 0.1)) / Epanechnikov::mass();
    let sum = f64::from(points.radiance(&at, &mut found).lanes()[0]);
    assert!((sum / one - 1.0).abs() < 1e-5, "{sum} of {one}");
    let one = 0.7 * 0.25 / PI * 8.0 / (3.0 * PI * 0.1);
    let sum = f64::from(beams.radiance(&at, &mut found).lanes()[0]);
    assert!((sum / one - 1.0).abs() < 1e-4, "{sum} of {one}");
}

/// Ten thousand photons and beams, whose trees several threads build: the same bits on one and on four.
#[test]
fn maps_do_not_depend_on_threads() {
    let mut rng = CounterRng::new(13, 0);
    let mut place = || {
        let mut float = || rng.next_f32() * 2.0 - 1.0;
        Vec3::new(float(), float(), float())
    };
    let photons: Vec<VolumePhoton> = (0..10_000).map(|_| photon(place())).collect();
    let beams: Vec<Beam> = (0..10_000).map(|_| beam(place(), place().normalize_or(Vec3::X), 0.5)).collect();
    let segment = Segment::new(Vec3::splat(-1.0), Vec3::ONE.normalize(), 3.0);
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let (mut points, mut crossings) = (Vec::new(), Vec::new());
            PointMap::build(&photons, 0.05).along(&segment, &mut points);
            BeamMap::build(&beams, 0.05).along(&segment, &mut crossings);
            (points, crossings)
        })
    };
    let (one, four) = (on(1), on(4));
    assert!(one.0.len() > 20 && one.1.len() > 20, "{} {}", one.0.len(), one.1.len());
    assert_eq!(one, four);
}
