use super::*;
use crate::emitter::tests::sunny;
use crate::sampling::CounterRng;

/// A midpoint sum over 2048² directions of equal solid angle finds the integral of 1 over the density, and of
/// radiance: 700 of them lie on the sun's disc, 90 of them at its edge, which leaves 7·10⁻³ of its light open.
#[test]
fn the_density_integrates_to_one_and_radiance_to_the_power() {
    for light in [sunny(false, 0.3), sunny(true, 1.2), sunny(false, 0.8)] {
        let (rows, columns) = (2048, 2048);
        let (mut density, mut total) = (0.0f64, [0.0f64; 3]);
        for i in 0..rows * columns {
            let z = 1.0 - 2.0 * ((i / columns) as f32 + 0.5) / rows as f32;
            let (sin, cos) = (TAU * ((i % columns) as f32 + 0.5) / columns as f32).sin_cos();
            let sine = (1.0 - z * z).sqrt();
            let (radiance, pdf) = light.background(light.axes.to_world(Vec3::new(sine * cos, sine * sin, z)));
            let solid = 4.0 * std::f64::consts::PI / (rows * columns) as f64;
            density += f64::from(pdf) * solid;
            (0..3).for_each(|c| total[c] += f64::from(radiance.lanes()[c]) * solid);
        }
        assert!((density - 1.0).abs() < 7e-3, "{density}");
        for (sum, expected) in total.into_iter().zip(light.total.lanes()) {
            assert!((sum / f64::from(expected) - 1.0).abs() < 7e-3, "{total:?} {}", light.total);
        }
    }
}

/// Pearson's test of 2·10⁵ directions against the integral of the density over 32 × 64 cells of equal solid angle,
/// and the disc as a cell of its own: χ² minus its mean in standard deviations, with a chance of 10⁻⁴ to pass 3.9 (it
/// is nearly normal with 2000 degrees of freedom).
#[test]
fn directions_follow_their_density() {
    for light in [sunny(false, 0.3), sunny(true, 1.2), sunny(false, 1.5)] {
        let (rows, columns, fine) = (32, 64, 24);
        let disc = light.disc.expect("the sun shines");
        let in_disc = |l: Vec3| (l - disc.frame.n).length_squared() <= 2.0 * disc.one_minus_cos;
        let cell = |l: Vec3| {
            let y = ((1.0 - l.z) * 0.5 * rows as f32) as usize;
            let turn = (l.y.atan2(l.x) / TAU).rem_euclid(1.0);
            y.min(rows - 1) * columns + ((turn * columns as f32) as usize).min(columns - 1)
        };
        let n = 200_000;
        let mut expected = vec![0.0f64; rows * columns + 1];
        let solid = 4.0 * std::f64::consts::PI / (rows * columns * fine * fine) as f64;
        for i in 0..rows * fine * columns * fine {
            let (y, x) = (i / (columns * fine), i % (columns * fine));
            let z = 1.0 - 2.0 * (y as f32 + 0.5) / (rows * fine) as f32;
            let sine = (1.0 - z * z).sqrt();
            let (sin, cos) = (TAU * (x as f32 + 0.5) / (columns * fine) as f32).sin_cos();
            let local = Vec3::new(sine * cos, sine * sin, z);
            let density = f64::from(light.look_up(local).1) * solid * f64::from(n);
            if !in_disc(local) {
                expected[y / fine * columns + x / fine] += density;
            }
        }
        let sky = f64::from(light.look_up(disc.frame.n).1 - light.sun_share * disc.density);
        expected[rows * columns] =
            f64::from(n) * (f64::from(light.sun_share) + sky * f64::from(1.0 / disc.density));
        let mut seen = vec![0u32; rows * columns + 1];
        let mut rng = CounterRng::new(11, 0);
        for _ in 0..n {
            let Some(local) = light.draw(Vec2::from(rng.next_2d())) else { continue };
            seen[if in_disc(local) { rows * columns } else { cell(local) }] += 1;
        }
        let (mut chi, mut cells, mut rest) = (0.0, 0.0, (0.0, 0.0));
        for (e, s) in expected.iter().zip(&seen) {
            if *e < 5.0 {
                rest = (rest.0 + e, rest.1 + f64::from(*s));
            } else {
                chi += (f64::from(*s) - e).powi(2) / e;
                cells += 1.0;
            }
        }
        assert!((rest.0 - rest.1).abs() <= 4.0 * rest.0.sqrt() + 2.0, "{rest:?}");
        let sigmas = (chi - (cells - 1.0)) / (2.0 * (cells - 1.0)).sqrt();
        assert!(sigmas < 3.9, "{chi} of {cells} cells: {sigmas}");
    }
}

/// Without a sun, or without a sky, all directions are drawn from the other; without both, none.
#[test]
fn a_part_that_is_dark_is_never_drawn() {
    #[derive(Debug)]
    struct Dark;
    impl Dome for Dark {
        fn sky(&self, _: Vec3) -> Color {
            Color::ZERO
        }
        fn sun(&self, _: Vec3) -> Color {
            Color::ONE
        }
    }
    let axes = Frame::from_normal(Vec3::Y);
    let disc = SunDisc { direction: Vec3::Z, half_angle: 0.1, irradiance: Color::ONE };
    let sun = SunSky::new(Arc::new(Dark), axes, Some(disc), false);
    assert_eq!(sun.sun_share, 1.0);
    let night = SunSky::new(Arc::new(Dark), axes, None, false);
    let mut rng = CounterRng::new(3, 0);
    for _ in 0..1000 {
        let u = Vec2::from(rng.next_2d());
        let (d, value, pdf) = sun.sample(u).expect("the sun shines");
        assert!(d.y > 0.99 && value.is_finite() && pdf > 0.0);
        assert!(night.sample(u).is_none());
    }
}
