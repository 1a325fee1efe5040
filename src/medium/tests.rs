//! Laws of media: light is extinguished by the integral of the extinction, and flights tell of the same light.

use std::sync::Arc;

use super::phase::Isotropic;
use super::*;
use crate::math::{Affine, gauss_legendre};
use crate::sampling::CounterRng;

fn gray(x: f32) -> Color {
    Color::splat(x)
}

fn homogeneous(sigma_t: Color, sigma_s: Color, emission: Color) -> Medium {
    Homogeneous::new(Coefficients { sigma_t, sigma_s, emission }, Isotropic.into()).into()
}

/// A bumpy box from 0 to 2, as an extinction of one lane or of three.
fn grid(channels: u32) -> Volume {
    let mut rng = CounterRng::new(21, 0);
    let size = [20, 11, 9];
    let data = (0..size.iter().product::<u32>() * channels).map(|_| rng.next_f32().powi(6) * 6.0).collect();
    let reading = Reading {
        to_local: Affine::from_scale(glam::Vec3::splat(0.5)),
        nodes: Nodes::Centers,
        beyond: Beyond::Clamp,
        clipped: true,
        smooth: true,
    };
    Volume::Grid(Arc::new(Grid { size, channels, values: Values::Dense(data), reading }), Color::ONE)
}

fn heterogeneous(extinction: Volume, albedo: f32, radiance: Option<Color>) -> Medium {
    let albedo = Scattering::Albedo(Volume::Constant(gray(albedo)));
    let radiance = radiance.map(Volume::Constant);
    Medium::Heterogeneous(Box::new(Heterogeneous::new(extinction, albedo, radiance, Isotropic.into())))
}

fn every_kind() -> Vec<(&'static str, Medium)> {
    let colored = Color::from_lanes([0.2, 1.0, 3.0]);
    vec![
        ("gray", homogeneous(gray(1.5), gray(1.0), Color::ZERO)),
        ("coloured", homogeneous(colored, colored * 0.9, gray(0.5))),
        ("clear in a lane", homogeneous(Color::from_lanes([0.0, 1.0, 2.0]), gray(0.0), gray(0.2))),
        ("absorbing", homogeneous(colored, Color::ZERO, Color::ZERO)),
        ("grid", heterogeneous(grid(1), 0.7, Some(gray(0.4)))),
        ("coloured grid", heterogeneous(grid(3), 0.7, None)),
        ("grid of an absorber", heterogeneous(grid(3), 0.0, Some(gray(2.0)))),
        ("constant by volumes", heterogeneous(Volume::Constant(colored), 0.6, Some(gray(0.3)))),
    ]
}

fn rays() -> [Ray; 3] {
    [
        Ray { o: Vec3::new(-0.3, 0.5, 0.9), d: Vec3::new(2.0, 0.3, 0.1), tmax: 1.3 },
        Ray { o: Vec3::new(1.1, 1.2, 0.2), d: Vec3::new(-0.1, 0.1, 0.7), tmax: 2.0 },
        Ray { o: Vec3::new(0.3, 0.0, 1.7), d: Vec3::new(0.0, 0.001, 0.0), tmax: 900.0 },
    ]
}

/// ∫ of σt along the ray, and of what is emitted and arrives at its origin, by Gauss's rule between steps.
fn quadrature(medium: &Medium, ray: &Ray) -> ([f64; 3], [f64; 3]) {
    let (steps, nodes) = (2000, gauss_legendre(3));
    let (unit, mut depth, mut emitted) = (ray.d.length(), [0.0f64; 3], [0.0f64; 3]);
    let step = f64::from(ray.tmax * unit) / f64::from(steps);
    for i in 0..steps {
        for (x, weight) in &nodes {
            let t = ((f64::from(i) + x) / f64::from(steps)) as f32 * ray.tmax;
            let c = medium.at(ray.at(t), ray.d / unit);
            for lane in 0..3 {
                let left = (-depth[lane] - x * step * f64::from(c.sigma_t.lanes()[lane])).exp();
                emitted[lane] += weight * step * left * f64::from(c.emission.lanes()[lane]);
            }
        }
        for (x, weight) in &nodes {
            let t = ((f64::from(i) + x) / f64::from(steps)) as f32 * ray.tmax;
            let c = medium.at(ray.at(t), ray.d / unit);
            depth.iter_mut().zip(c.sigma_t.lanes()).for_each(|(d, s)| *d += weight * step * f64::from(s));
        }
    }
    (depth, emitted)
}

/// A mean with its standard error.
#[derive(Clone, Copy, Default)]
struct Tally {
    n: f64,
    sum: f64,
    square: f64,
}

impl Tally {
    fn add(&mut self, x: f32) {
        let x = f64::from(x);
        self.n += 1.0;
        self.sum += x;
        self.square += x * x;
    }

    /// Within 4.5 sigma, and 2e-4 for what the quadrature and f32 round.
    #[track_caller]
    fn is(&self, what: &str, exact: f64) {
        let mean = self.sum / self.n;
        let sigma = ((self.square / self.n - mean * mean).max(0.0) / self.n).sqrt();
        assert!(
            (mean - exact).abs() <= 4.5 * sigma + 2e-4 * exact.max(0.1),
            "{what}: {mean} ± {sigma}, exactly {exact}"
        );
        assert!(sigma <= 0.03 * exact.max(0.1), "{what}: {mean} is too noisy: {sigma}");
    }
}

/// e^−∫σt, whatever the medium is made of.
#[test]
fn light_passes_by_beers_law() {
    for (name, medium) in every_kind() {
        for (i, ray) in rays().iter().enumerate() {
            let (depth, _) = quadrature(&medium, ray);
            let mut tallies = [Tally::default(); 3];
            for k in 0..20_000 {
                let passage = medium.pass(ray, &mut Sampler::new(31, k));
                tallies.iter_mut().zip(passage.left.lanes()).for_each(|(t, x)| t.add(x));
            }
            for lane in 0..3 {
                tallies[lane].is(&format!("{name}, ray {i}, lane {lane}"), (-depth[lane]).exp());
            }
        }
    }
}

/// What passes a flight's end, what collides, and what is emitted on the way: in the mean, for a path whose lanes have
/// different densities from before, it is what the coefficients say.
#[test]
fn flights_carry_the_light_of_all_lanes() {
    let before = Carried {
        weight: Color::from_lanes([0.5, 2.0, 1.0]),
        share: Color::from_lanes([0.3, 0.9, 1.8]),
        reach: 1.0,
    };
    for (name, medium) in every_kind() {
        for (i, ray) in rays().iter().enumerate() {
            let (depth, emission) = quadrature(&medium, ray);
            let mut tallies = [[Tally::default(); 3]; 3];
            for k in 0..40_000 {
                let (mut carried, mut emitted) = (before, Color::ZERO);
                let hit = medium.fly(ray, &mut carried, &mut emitted, &mut Sampler::new(37, k));
                assert!((carried.share.sum_of_lanes() - 3.0).abs() < 1e-3 || !carried.alive(), "{name}");
                let through = if hit.is_none() { carried.weight } else { Color::ZERO };
                // Collisions are counted by what they lack of the albedo: σs/σt is known here.
                let all = carried.weight;
                for (tally, found) in tallies.iter_mut().zip([through, emitted, all - through]) {
                    for (lane, tally) in tally.iter_mut().enumerate() {
                        tally.add(found.lanes()[lane] / before.weight.lanes()[lane]);
                    }
                }
            }
            for lane in 0..3 {
                let left = (-depth[lane]).exp();
                let what = format!("{name}, ray {i}, lane {lane}");
                tallies[0][lane].is(&format!("{what}, through"), left);
                tallies[1][lane].is(&format!("{what}, emitted"), emission[lane]);
                let c = medium.mean();
                let albedo =
                    f64::from(c.sigma_s.lanes()[lane]) / f64::from(c.sigma_t.lanes()[lane].max(1e-9));
                tallies[2][lane].is(&format!("{what}, scattered"), albedo * (1.0 - left));
            }
        }
    }
}

/// A path may come to a place by a flight or be connected to it: both must know the same probability.
#[test]
fn passing_has_the_probability_that_flights_have() {
    for (name, medium) in every_kind() {
        for ray in rays() {
            let mut tally = Tally::default();
            let mut exact = 0.0;
            let n = 20_000;
            for k in 0..n {
                let mut carried = Carried::new(Color::ONE);
                let hit = medium.fly(&ray, &mut carried, &mut Color::default(), &mut Sampler::new(41, k));
                tally.add(if hit.is_none() { 1.0 } else { 0.0 });
                let density = medium.pass(&ray, &mut Sampler::new(43, k)).density;
                exact += f64::from(Carried::new(Color::ONE).probability(density)) / f64::from(n);
            }
            let mean = tally.sum / tally.n;
            // Both are estimates: a share of 20 000, whose sigma is at most 0.0036, and a mean of less noise.
            assert!((mean - exact).abs() < 4.5 * 0.0036 * 1.5, "{name}: {mean} and {exact}");
        }
    }
}

/// Optical depths of 1e-6 and 1e6, a ray without an end, lanes that nothing extinguishes: numbers stay numbers, and
/// flights end.
#[test]
fn extremes_stay_finite() {
    for sigma in [0.0, 1e-6, 1e6, 1e30] {
        for tmax in [1e-20, 1.0, f32::INFINITY] {
            let lanes = Color::from_lanes([sigma, 0.0, sigma * 0.5]);
            let volume = heterogeneous(Volume::Constant(lanes), 1.0, Some(Color::ONE));
            for medium in
                [homogeneous(lanes, lanes, Color::ONE), homogeneous(lanes, Color::ZERO, Color::ONE), volume]
            {
                let ray = Ray { o: Vec3::ZERO, d: Vec3::X, tmax };
                for k in 0..100 {
                    let (mut carried, mut emitted) = (Carried::new(Color::ONE), Color::ZERO);
                    let passage = medium.pass(&ray, &mut Sampler::new(47, k));
                    assert!(passage.left.is_finite() && passage.density.is_finite());
                    medium.fly(&ray, &mut carried, &mut emitted, &mut Sampler::new(53, k));
                    let good = carried.weight.is_finite() && carried.share.is_finite() && emitted.is_finite();
                    assert!(good, "{sigma} {tmax}: {carried:?} {emitted}");
                }
            }
        }
    }
}
