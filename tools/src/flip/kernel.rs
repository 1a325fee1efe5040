//! The one-dimensional kernels whose products are FLIP's filters.

use std::f64::consts::PI;

/// A filter of length `2·radius + 1`. `half[i]` is the weight at the offsets ±i; `odd` filters have the
/// opposite sign on the negative side.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub half: Vec<f32>,
    pub odd: bool,
}

impl Kernel {
    fn even(half: impl IntoIterator<Item = f64>) -> Self {
        Self { half: half.into_iter().map(|v| v as f32).collect(), odd: false }
    }

    pub fn radius(&self) -> usize {
        self.half.len() - 1
    }
}

/// All kernels for a number of pixels per degree.
///
/// Contrast sensitivity (2020, table 1): per opponent channel a sum of Gaussians `a √(π/b) exp(−π² x²/b)`, x
/// in degrees; achromatic and red-green have one, blue-yellow two. A sum of two isotropic Gaussians is not
/// separable, but each one is: both are applied and weighted by their mass in the normalised two-dimensional
/// filter.
///
/// Features (2020, §4.2): first and second derivative of a Gaussian whose width makes the ring of
/// the edge detector `w` = 0.082 degrees; positive and negative weights normalised to ±1.
#[derive(Clone, Debug)]
pub struct Kernels {
    pub achromatic: Kernel,
    pub red_green: Kernel,
    pub blue_yellow: [Kernel; 2],
    pub blue_yellow_weight: [f32; 2],
    pub gauss: Kernel,
    pub edge: Kernel,
    pub point: Kernel,
}

/// Width of the edge detector in degrees (`w`).
const FEATURE_WIDTH: f64 = 0.082;
/// `b` of each Gaussian, and `a` of the two of blue-yellow.
const B_ACHROMATIC: f64 = 0.0047;
const B_RED_GREEN: f64 = 0.0053;
const B_BLUE_YELLOW: [f64; 2] = [0.04, 0.025];
const A_BLUE_YELLOW: [f64; 2] = [34.1, 13.5];

impl Kernels {
    pub fn new(ppd: f64) -> Self {
        // The widest Gaussian of all channels decides the radius of all (2020, §4.1.1).
        let radius = (3.0 * (B_BLUE_YELLOW[0] / (2.0 * PI * PI)).sqrt() * ppd).ceil() as usize;
        let blue_yellow = B_BLUE_YELLOW.map(|b| sensitivity(b, ppd, radius));
        let mass: [f64; 2] = std::array::from_fn(|i| {
            A_BLUE_YELLOW[i] * (PI / B_BLUE_YELLOW[i]).sqrt() * blue_yellow[i].1.powi(2)
        });
        let deviation = 0.5 * FEATURE_WIDTH * ppd;
        let reach = (3.0 * deviation).ceil() as usize;
        let g = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        Self {
            achromatic: sensitivity(B_ACHROMATIC, ppd, radius).0,
            red_green: sensitivity(B_RED_GREEN, ppd, radius).0,
            blue_yellow_weight: mass.map(|m| (m / (mass[0] + mass[1])) as f32),
            blue_yellow: blue_yellow.map(|k| k.0),
            gauss: normalised_gauss(&g, reach),
            edge: edge(&g, reach),
            point: point(&g, deviation, reach),
        }
    }

    /// Pixels that the widest filter reaches beyond its centre.
    pub fn reach(&self) -> usize {
        let widest = self.blue_yellow[0].radius().max(self.blue_yellow[1].radius());
        widest.max(self.achromatic.radius()).max(self.red_green.radius()).max(self.gauss.radius())
    }
}

/// A Gaussian of the contrast sensitivity, normalised to mass 1 in one dimension, and its mass before.
fn sensitivity(b: f64, ppd: f64, radius: usize) -> (Kernel, f64) {
    let g = |i: usize| (-(PI * i as f64 / ppd).powi(2) / b).exp();
    let mass = 2.0 * (1..=radius).map(g).sum::<f64>() + 1.0;
    // Weights below 1e-8 vanish in f32, so narrow Gaussians are cut short of the common radius.
    let used = (0..=radius).rev().find(|&i| g(i) > 1e-8).unwrap_or(0);
    (Kernel::even((0..=used).map(|i| g(i) / mass)), mass)
}

fn normalised_gauss(g: &impl Fn(f64) -> f64, reach: usize) -> Kernel {
    let mass = 2.0 * (1..=reach).map(|i| g(i as f64)).sum::<f64>() + 1.0;
    Kernel::even((0..=reach).map(|i| g(i as f64) / mass))
}

/// `−x g(x)`, each side with mass ±1. The sign does not matter, because only magnitudes are used.
fn edge(g: &impl Fn(f64) -> f64, reach: usize) -> Kernel {
    let weight = |i: usize| i as f64 * g(i as f64);
    let mass: f64 = (1..=reach).map(weight).sum();
    Kernel { odd: true, ..Kernel::even((0..=reach).map(|i| weight(i) / mass)) }
}

/// `(x²/σ² − 1) g(x)`; the positive and the negative weights have mass 1 each.
fn point(g: &impl Fn(f64) -> f64, deviation: f64, reach: usize) -> Kernel {
    let weight = |i: usize| ((i as f64 / deviation).powi(2) - 1.0) * g(i as f64);
    let (mut positive, mut negative) = (0.0, 0.0);
    for i in 0..=reach {
        let w = weight(i) * if i == 0 { 1.0 } else { 2.0 };
        *(if w > 0.0 { &mut positive } else { &mut negative }) += w.abs();
    }
    Kernel::even((0..=reach).map(|i| {
        let w = weight(i);
        w / if w > 0.0 { positive } else { negative }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flip::DEFAULT_PPD;

    fn mass(k: &Kernel) -> f32 {
        k.half[0] + 2.0 * k.half[1..].iter().sum::<f32>()
    }

    #[test]
    fn masses() {
        for ppd in [20.0, DEFAULT_PPD, 150.0] {
            let k = Kernels::new(ppd);
            for unit in [&k.achromatic, &k.red_green, &k.blue_yellow[0], &k.blue_yellow[1], &k.gauss] {
                assert!((mass(unit) - 1.0).abs() < 1e-5, "{ppd}");
            }
            assert!(mass(&k.point).abs() < 1e-5);
            assert!((k.edge.half.iter().sum::<f32>() - 1.0).abs() < 1e-5);
            assert!((k.blue_yellow_weight.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn radius_at_the_default_distance() {
        let k = Kernels::new(DEFAULT_PPD);
        assert_eq!((k.reach(), k.gauss.radius()), (10, 9));
    }
}
