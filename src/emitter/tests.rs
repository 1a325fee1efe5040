//! Laws of the emitters that no Mitsuba scene can ask for.

use super::*;
use crate::math::DVec3;
use crate::math::Frame;
use crate::sampling::warp;
use crate::shape::{Analytic, Sphere};
use crate::spectrum::rgb;
use crate::texture::Param;

const SCENE: SceneSphere = SceneSphere { center: Vec3::ZERO, radius: 5.0 };

fn picture(side: usize) -> Picture {
    let texel = |i: usize| [(i % 3) as f32, 0.5, if i == 4 { 9.0 } else { 0.1 }];
    Picture::new(side, side, (0..side * side).map(texel).collect())
}

fn axes() -> Frame {
    let f = Frame::from_normal(Vec3::new(0.2, 0.9, -0.4).normalize());
    Frame { s: -f.s, ..f }
}

fn frustum() -> Frustum {
    Frustum { position: Vec3::new(0.3, 0.1, -0.2), axes: axes(), half: Vec2::new(0.8, 0.4) }
}

fn square(n: usize) -> impl Iterator<Item = Vec2> {
    (0..n * n).map(move |i| (Vec2::new((i % n) as f32, (i / n) as f32) + 0.5) / n as f32)
}

/// Mean flux of the samples, over places and directions.
fn emitted(e: &Emitter) -> Color {
    let n = 256;
    let mut sum = [0.0f64; 3];
    for (i, u) in square(n).enumerate() {
        let place = Vec2::new((i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877_7).fract());
        if let Some(s) = e.sample_emission(&Textures::default(), &EmissionBounds::even(SCENE), place, u) {
            (0..3).for_each(|c| sum[c] += f64::from(s.flux.lanes()[c]));
        }
    }
    rgb(sum.map(|s| (s / (n * n) as f64) as f32))
}

fn close(what: &str, a: Color, b: Color, bound: f32) {
    assert!((a - b).abs().max_element() <= bound * b.max_element(), "{what}: {a} against {b}");
}

/// The power is what the samples carry (256² stratified ones, in pictures of a few texels: to a percent),
/// and for a light at a place what it shines through a sphere around it. There 512² directions miss the
/// edges of texels and of the frustum by one in 256.
#[test]
fn photons_and_direct_light_have_the_same_power() {
    let sphere = |inward| {
        let to_object = axes();
        Surface::Analytic(Analytic::Sphere(Sphere { center: DVec3::X, radius: 0.5, to_object, inward }))
    };
    let radiance = Param::Constant(rgb([1.0, 2.0, 3.0]));
    let lamp =
        |inward, sides| Emitter::Area(Area::new(sphere(inward), radiance, sides, 1e-6, &Textures::default()));
    let projector = Projector { frustum: frustum(), irradiance: radiance };
    let projection = |power| Emitter::Projection(Box::new(Projection::new(frustum(), picture(3), power)));
    let gonio = Goniometric::new(Vec3::new(0.0, 0.5, 0.0), axes(), rgb([3.0, 2.0, 1.0]), &picture(4));
    let rows = [
        ("projector", Emitter::Projector(projector), Some(frustum().position)),
        ("projection", projection(None), Some(frustum().position)),
        ("projection of 7 W", projection(Some(7.0)), Some(frustum().position)),
        ("goniometric", Emitter::Goniometric(Box::new(gonio)), Some(Vec3::new(0.0, 0.5, 0.0))),
        ("lamp", lamp(false, Sides::Front), None),
        ("two-sided", lamp(true, Sides::Both), None),
    ];
    for (what, e, place) in rows {
        let power = e.power(&Textures::default(), &SCENE);
        close(what, emitted(&e), power, 0.01);
        if what.ends_with("7 W") {
            assert!((crate::spectrum::luminance(power) - 7.0).abs() < 1e-4);
        }
        let Some(place) = place else { continue };
        let n = 512;
        let mut around = [0.0f64; 3];
        for u in square(n) {
            let p = place + warp::sphere(u) * 2.0;
            if let Some(s) = e.sample_direct(&Textures::default(), p, Vec2::ZERO) {
                (0..3).for_each(|c| around[c] += f64::from(s.value.lanes()[c]) * 4.0);
            }
        }
        let solid = 4.0 * std::f64::consts::PI / (n * n) as f64;
        close(what, rgb(around.map(|a| (a * solid) as f32)), power, 0.02);
    }
}

/// A sphere that shines both ways sends the same light outside as one that faces outwards, and the
/// inside of it sees radiance L all around: ∫L dω = 4πL.
#[test]
fn both_sides_of_a_lamp_are_sampled() {
    let to_object = axes();
    for inward in [false, true] {
        let shape = Analytic::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0, to_object, inward });
        let radiance = Param::gray(2.0);
        let lamp = Area::new(Surface::Analytic(shape), radiance, Sides::Both, 1e-6, &Textures::default());
        for (p, solid) in [
            (Vec3::new(0.2, -0.3, 0.1), 4.0 * std::f32::consts::PI),
            // 1 − cos of the cone of a unit sphere at distance 2 is 1 − √3/2.
            (Vec3::new(2.0, 0.0, 0.0), 2.0 * std::f32::consts::PI * (1.0 - 0.75f32.sqrt())),
        ] {
            let samples = square(64).map(|u| lamp.sample_direct(&Textures::default(), p, u));
            let sum: f32 = samples.map(|s| s.map_or(0.0, |s| s.value.lanes()[0])).sum();
            assert!((sum / 4096.0 / (2.0 * solid) - 1.0).abs() < 0.005, "{inward} {p}: {}", sum / 4096.0);
        }
    }
}

/// A sky brighter at the horizon and towards +X, below it dark unless `below`, with a sun of 3°.
#[derive(Debug)]
struct Plain {
    below: bool,
    sun: Vec3,
}

impl Dome for Plain {
    fn sky(&self, d: Vec3) -> Color {
        if d.z < 0.0 && !self.below {
            return Color::ZERO;
        }
        let glow = 0.2 + (-3.0 * d.z.abs()).exp() + (4.0 * (d.dot(self.sun) - 1.0)).exp();
        rgb([glow, 0.8 * glow, 0.5 + d.x.max(0.0)])
    }

    fn sun(&self, d: Vec3) -> Color {
        if d.z < 0.0 { Color::ZERO } else { rgb([300.0, 250.0, 150.0]) }
    }
}

/// With the sun that many radians above the horizon.
pub(super) fn sunny(below: bool, height: f32) -> SunSky {
    let sun = Vec3::new(-height.cos() * 0.6, height.cos() * 0.8, height.sin());
    let frame = Frame::from_normal(Vec3::new(0.3, -0.5, 0.7).normalize());
    let axes = Frame { s: -frame.s, ..frame };
    let half_angle = 0.026f32;
    let solid = std::f32::consts::TAU * 2.0 * (0.5 * half_angle).sin().powi(2);
    let disc = SunDisc { direction: sun, half_angle, irradiance: rgb([300.0, 250.0, 150.0]) * solid };
    SunSky::new(std::sync::Arc::new(Plain { below, sun }), axes, Some(disc), below)
}

/// Every kind of emitter that is built without a scene.
fn every_kind() -> Vec<(&'static str, Emitter)> {
    let sphere = |inward| {
        let to_object = axes();
        Surface::Analytic(Analytic::Sphere(Sphere { center: DVec3::X, radius: 0.5, to_object, inward }))
    };
    let radiance = Param::Constant(rgb([1.0, 2.0, 3.0]));
    let area = |inward, sides| Area::new(sphere(inward), radiance, sides, 0.0, &Textures::default());
    let triangle = |x: f32| MeshTriangle {
        v: [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 2.0, 0.5]],
        uv: [Vec2::ZERO, Vec2::X, Vec2::Y],
        normal: Vec3::new(0.0, -0.5, 2.0).normalize(),
    };
    let beam = Collimated::new(vec![triangle(0.0), triangle(3.0)], radiance, 0.0);
    let spot = Spot {
        position: Vec3::new(0.1, 0.2, 0.3),
        frame: axes(),
        stretched: None,
        intensity: rgb([1.0, 2.0, 3.0]),
        cutoff: 0.6,
        beam: 0.3,
        falloff: Falloff::Smoothstep,
        texture: None,
    };
    let environment = Environment::new(picture(6), EnvironmentMapping::EqualArea, axes());
    let gonio = Goniometric::new(Vec3::Y, axes(), rgb([3.0, 2.0, 1.0]), &picture(4));
    vec![
        ("area", area(false, Sides::Front).into()),
        ("two-sided area", area(true, Sides::Both).into()),
        ("point", Point { position: Vec3::X, intensity: rgb([1.0, 2.0, 3.0]) }.into()),
        ("spot", spot.into()),
        ("directional", Directional { direction: Vec3::Z, irradiance: rgb([1.0, 2.0, 3.0]) }.into()),
        ("constant", Constant { radiance: rgb([1.0, 2.0, 3.0]) }.into()),
        ("environment", Box::new(environment).into()),
        ("sun and sky", Box::new(sunny(false, 0.3)).into()),
        ("projector", Projector { frustum: frustum(), irradiance: radiance }.into()),
        ("projection", Box::new(Projection::new(frustum(), picture(3), None)).into()),
        ("goniometric", Box::new(gonio).into()),
        ("collimated", Box::new(beam).into()),
    ]
}

/// The integral of 1 over the places and of the cosine over the directions that each kind chooses from: m² and
/// sr, `None` for a delta.
fn measures(e: &Emitter) -> [Option<f32>; 2] {
    use std::f32::consts::PI;
    let disk = Some(SCENE.disk());
    match e {
        Emitter::Area(a) => [Some(a.area()), Some(if a.sides == Sides::Both { 2.0 } else { 1.0 } * PI)],
        Emitter::Point(_) | Emitter::Goniometric(_) => [None, Some(4.0 * PI)],
        Emitter::Spot(s) => [None, Some(2.0 * PI * (1.0 - s.cutoff.cos()))],
        Emitter::Directional(_) => [disk, None],
        Emitter::Constant(_) | Emitter::Environment(_) => [disk, Some(4.0 * PI)],
        Emitter::SunSky(_) => [disk, Some(2.0 * PI)],
        Emitter::Projector(_) | Emitter::Projection(_) => {
            [None, Some(frustum().solid_angle(Vec2::ZERO, Vec2::ONE) as f32)]
        }
        Emitter::Collimated(c) => [Some(c.area()), None],
    }
}

/// Where choices follow a density p that integrates to 1, E(g/p) = ∫g for any g: here 1, and the cosine for
/// directions, which keeps g/p bounded. It varies by the light of a picture's texels, of which the brightest
/// has 30 times as much as the darkest; 2¹⁶ stratified choices know the mean to a percent.
#[test]
fn densities_of_emission_integrate_to_one() {
    for (what, e) in every_kind() {
        let n = 256;
        let mut sums = [0.0f64; 2];
        for (i, u) in square(n).enumerate() {
            let place = Vec2::new((i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877_7).fract());
            let sample = e.sample_emission(&Textures::default(), &EmissionBounds::even(SCENE), place, u);
            let Some(s) = sample else { continue };
            let weighed = [1.0 / s.position.factor(), s.cos / s.direction.factor()];
            for (sum, value) in sums.iter_mut().zip(weighed) {
                *sum += f64::from(value) / (n * n) as f64;
            }
            let deltas = [s.position, s.direction].map(|density| density == Density::Delta);
            assert_eq!(deltas, measures(&e).map(|m| m.is_none()), "{what}");
        }
        for (sum, measure) in sums.into_iter().zip(measures(&e)) {
            let measure = f64::from(measure.unwrap_or(1.0));
            assert!((sum / measure - 1.0).abs() < 0.01, "{what}: {sum} of {measure}");
        }
    }
}

/// Flux = light · cos / (both densities), with the light looked up by another way: from the sample's own
/// place and direction, as a surface lit there finds it. Equal but for rounding; where a picture is looked
/// up again, rounding may find a neighbouring texel at its edges.
#[test]
fn the_flux_of_emission_is_light_over_density() {
    let textures = Textures::default();
    for (what, e) in every_kind() {
        let (mut seen, mut wrong) = (0, 0);
        for (i, u) in square(64).enumerate() {
            let place = Vec2::new((i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877_7).fract());
            let sample = e.sample_emission(&textures, &EmissionBounds::even(SCENE), place, u);
            let Some(s) = sample else { continue };
            let light = match &e {
                Emitter::Area(_) => e.emitted(&textures, &Site::flat(Vec2::ZERO), true),
                Emitter::Constant(_) | Emitter::Environment(_) | Emitter::SunSky(_) => e.background(-s.d).0,
                // Light of one direction, which any place in the beam sees.
                Emitter::Directional(_) => {
                    e.sample_direct(&textures, s.o, u).map_or(Color::ZERO, |d| d.value)
                }
                Emitter::Collimated(_) => rgb([1.0, 2.0, 3.0]),
                // Intensity is irradiance at distance 1.
                _ => e.sample_direct(&textures, s.o + s.d, u).map_or(Color::ZERO, |d| d.value),
            };
            let expected = light * (s.cos / (s.position.factor() * s.direction.factor()));
            seen += 1;
            wrong += usize::from((s.flux - expected).abs().max_element() > 1e-3 * s.flux.max_element());
        }
        assert!(seen > 3000, "{what}: {seen}");
        assert!(wrong <= seen / 100, "{what}: {wrong} of {seen}");
    }
}
