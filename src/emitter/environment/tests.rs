use std::f32::consts::PI;

use super::*;

/// A picture with all texels different, a bright one and a black one.
fn picture(width: usize, height: usize) -> Picture {
    let texel = |i: usize| [(i % 7) as f32 * 0.3, 0.1 * (i % 5) as f32, if i == 11 { 40.0 } else { 0.2 }];
    let mut texels: Vec<[f32; 3]> = (0..width * height).map(texel).collect();
    texels[0] = [0.0; 3];
    Picture::new(width, height, texels)
}

fn turned() -> Frame {
    let f = Frame::from_normal(Vec3::new(0.3, -0.5, 0.7).normalize());
    // Mirrored as well, as pbrt's scenes often are.
    Frame { s: -f.s, ..f }
}

fn cases() -> [Environment; 4] {
    [
        Environment::new(picture(8, 4), Mapping::LatLong, turned()),
        Environment::new(picture(1, 1), Mapping::LatLong, turned()),
        Environment::new(picture(5, 2), Mapping::LatLong, turned()),
        Environment::new(picture(6, 6), Mapping::EqualArea, turned()),
    ]
}

/// Directions measured on Mitsuba 3.9.1: +Z in the middle, +X at a quarter, −X at three, +Y on top.
#[test]
fn directions_lie_on_the_picture_as_in_mitsuba() {
    // Value = column + 10·row: bilinear lookup then tells the place.
    let texels = (0..32).map(|i| [(i % 8) as f32 + 10.0 * (i / 8) as f32; 3]).collect();
    let axes = Frame { s: Vec3::X, t: Vec3::Y, n: Vec3::Z };
    let e = Environment::new(Picture::new(8, 4, texels), Mapping::LatLong, axes);
    // x = 8u − ½, y = 3v.
    for (d, x, y) in [(Vec3::Z, 3.5, 1.5), (Vec3::X, 1.5, 1.5), (-Vec3::X, 5.5, 1.5)] {
        assert!((e.background(d).0.lanes()[0] - (x + 10.0 * y)).abs() < 1e-4, "{d}: {}", e.background(d).0);
    }
    // The left edge is −Z: halfway between columns 7 and 0.
    assert!((e.background(-Vec3::Z).0.lanes()[0] - 18.5).abs() < 1e-4);
    // At the poles the first and last row are met without the others.
    assert!(e.background(Vec3::Y).0.lanes()[0] < 8.0 && e.background(-Vec3::Y).0.lanes()[0] >= 30.0);
}

/// A midpoint sum over 512 × 1024 directions of a piecewise smooth density, which in the worst case
/// jumps at the edges of texels: an error of a row or two, 4·10⁻³.
#[test]
fn densities_integrate_to_one_and_radiance_to_the_power() {
    for (case, e) in cases().into_iter().enumerate() {
        let (rows, columns) = (512, 1024);
        let (mut density, mut light) = (0.0f64, [0.0f64; 3]);
        for i in 0..rows * columns {
            let theta = PI * ((i / columns) as f32 + 0.5) / rows as f32;
            let phi = 2.0 * PI * ((i % columns) as f32 + 0.5) / columns as f32;
            let local = Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            let d = e.axes.to_world(local);
            let solid = f64::from(theta.sin() * (PI / rows as f32) * (2.0 * PI / columns as f32));
            density += f64::from(e.background(d).1) * solid;
            (0..3).for_each(|c| light[c] += f64::from(e.background(d).0.lanes()[c]) * solid);
        }
        let black = e.mean == 0.0;
        assert!(black || (density - 1.0).abs() < 4e-3, "case {case}: {density}");
        for c in 0..3 {
            let expected = f64::from(e.total.lanes()[c]);
            assert!((light[c] - expected).abs() <= 4e-3 * expected, "case {case}: {light:?} {}", e.total);
        }
    }
}

/// Each sample carries the radiance of its direction over the density of its direction, both computed
/// anew from the direction; rounding may put it into a neighbouring texel of an equal-area picture.
#[test]
fn samples_agree_with_density_and_radiance() {
    for (case, e) in cases().into_iter().enumerate() {
        let n = 256;
        let mut wrong = 0;
        let mut total = Color::ZERO;
        for i in 0..n * n {
            let at = |k: i32| (k as f32 + 0.5) / n as f32;
            let Some(s) = e.sample_direct(&Textures::default(), Vec3::ZERO, Vec2::new(at(i % n), at(i / n)))
            else {
                assert_eq!(e.mean, 0.0);
                continue;
            };
            let expected = e.background(s.dir).0 / e.background(s.dir).1;
            let close = (s.pdf / e.background(s.dir).1 - 1.0).abs() < 1e-3
                && (s.value / expected - Color::ONE).abs().max_element() < 2e-3;
            wrong += i32::from(!close && expected.min_element() > 0.0);
            total += s.value / (n * n) as f32;
        }
        assert!(wrong <= n * n / 400, "case {case}: {wrong}");
        // Values vary with colour and with the sine within a row; stratified as they are, their mean is
        // known to a percent (the choice of one of few texels is known to 1/256 of a row's light).
        let off = (total - e.total).abs().max_element();
        assert!(off <= 0.01 * e.total.max_element(), "case {case}: {total} {}", e.total);
    }
}

/// Light starts outside the scene's sphere, towards it, within its shadow.
#[test]
fn photons_start_where_the_scene_can_receive_them() {
    let scene = SceneSphere { center: Vec3::new(1.0, 2.0, 3.0), radius: 2.0 };
    for e in cases().into_iter().filter(|e| e.mean > 0.0) {
        for i in 0..64 {
            let at = |k: i32| (k as f32 + 0.5) / 8.0;
            let u = Vec2::new(at(i % 8), at(i / 8));
            let s = e
                .sample_emission(&Textures::default(), &EmissionBounds::even(scene), u, Vec2::new(u.y, u.x))
                .expect("the picture shines");
            let from = s.o - scene.center;
            assert!((from.dot(s.d) + 2.0).abs() < 1e-4);
            assert!((from + s.d * 2.0).length() <= 2.0001);
        }
    }
}
