//! White furnace: what a surface reflects of uniform light.

use caustica::bsdf::Transport;
use caustica::math::{Color, Vec2};
use caustica::sampling::CounterRng;

use super::{NONLINEAR, bsdf, closure, direction, float, ggx, material, rgb};

/// Mitsuba's table is a mean of 20 000 sample weights for radiance. Ours are 200 000; the spread of both is
/// that of our weights, and the table is rounded to 1e-4.
#[test]
fn directional_albedo_matches_mitsuba() {
    let gray = |kind: &str, rho: &str, rest: &str| bsdf(kind, &(rgb("diffuse_reflectance", rho) + rest));
    for (bsdf, steep, slanted) in [
        (gray("plastic", "0.5", ""), 0.5195, 0.5437),
        (gray("plastic", "0.9", ""), 0.9042, 0.9089),
        (gray("plastic", "0.9", NONLINEAR), 0.7949, 0.8054),
        (gray("roughplastic", "0.5", ""), 0.5030, 0.5285),
        (gray("roughplastic", "0.9", &ggx(0.3)), 0.6286, 0.6122),
        (bsdf("roughdielectric", &float("alpha", 0.1)), 0.4638, 0.4928),
        (bsdf("roughdielectric", &ggx(0.4)), 0.4511, 0.4344),
        (bsdf("roughconductor", &float("alpha", 0.3)), 0.9997, 0.9242),
        (bsdf("roughconductor", &ggx(0.5)), 0.6853, 0.6846),
        (bsdf("dielectric", ""), 0.4638, 0.4924),
    ] {
        let scene = material(&bsdf);
        for (theta, expected) in [(0.5, steep), (60.0, slanted)] {
            let wi = direction(theta, 0.0);
            let c = closure(&scene, wi);
            let mut rng = CounterRng::new(29, 0);
            let n = 200_000;
            let (mut sum, mut square) = (0.0f64, 0.0f64);
            for _ in 0..n {
                let (lobe, u) = (rng.next_f32(), Vec2::from(rng.next_2d()));
                let sample = c.sample(wi, lobe, u, Transport::Radiance, 0.0);
                let weight = f64::from(sample.map_or(Color::ZERO, |s| s.weight).lanes()[0]);
                sum += weight;
                square += weight * weight;
            }
            let mean = sum / f64::from(n);
            let spread = (square / f64::from(n) - mean * mean).max(0.0).sqrt();
            let bound = 4.5 * spread * (1.0f64 / 20_000.0 + 1.0 / f64::from(n)).sqrt() + 1e-4;
            println!("{theta}°: {mean:.4} against {expected} ± {bound:.4}");
            assert!((mean - expected).abs() < bound, "{bsdf} at {theta}: {mean} against {expected}");
        }
    }
}
