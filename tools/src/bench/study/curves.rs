//! Weight curves of the kernels from their definitions, without the renderer.

use super::catalogue::KERNELS;
use crate::bench::plot::{Plot, Series};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI};

/// Profile at distance u in [0, 1], up to scale; `None` for an unknown kernel.
fn profile(kernel: &str, u: f64) -> Option<f64> {
    let v = 1.0 - u * u;
    Some(match kernel {
        "constant" => 1.0,
        "cone" => 1.0 - u,
        "epanechnikov" => v,
        "biweight" => v * v,
        "triweight" => v * v * v,
        "tricube" => (1.0 - u * u * u).powi(3),
        // σ is a third of the radius.
        "gaussian" => (-(3.0 * u).powi(2) / 2.0).exp(),
        "logistic" => 1.0 / ((6.0 * u).exp() + 2.0 + (-6.0 * u).exp()),
        // Scaled so that its first zero, 3π/4 · √2, is the radius.
        "silverman" => {
            let x = 0.75 * PI / FRAC_1_SQRT_2 * u;
            (-x * FRAC_1_SQRT_2).exp() * (x * FRAC_1_SQRT_2 + FRAC_PI_4).sin()
        }
        _ => return None,
    })
}

/// Mass over the unit disc, by the midpoint rule.
fn mass(kernel: &str) -> f64 {
    const STEPS: u32 = 2000;
    let at = |i| (f64::from(i) + 0.5) / f64::from(STEPS);
    (0..STEPS).filter_map(|i| Some(profile(kernel, at(i))? * 2.0 * PI * at(i) / f64::from(STEPS))).sum()
}

/// All kernels, normalised to unit mass over the disc.
pub fn plot() -> Plot {
    let series = KERNELS.iter().map(|kernel| {
        let m = mass(kernel);
        let us = (0..=50).map(|i| f64::from(i) / 50.0);
        let line = us.filter_map(|u| Some((u, profile(kernel, u)? / m))).collect();
        Series { name: (*kernel).to_owned(), line, smooth: true, ..Series::default() }
    });
    Plot {
        title: "Kernels of equal mass over the disc".to_owned(),
        x: "distance u = r / radius".to_owned(),
        y: "weight · radius²".to_owned(),
        log: [false, false],
        series: series.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masses_by_hand() {
        let close = |kernel: &str, m: f64| assert!((mass(kernel) - m).abs() < 1e-4, "{kernel}");
        close("constant", PI);
        close("cone", PI / 3.0);
        close("epanechnikov", PI / 2.0);
        close("biweight", PI / 3.0);
        close("triweight", PI / 4.0);
    }

    #[test]
    fn every_kernel_has_a_curve() {
        assert!(plot().series.iter().all(|s| s.line.len() == 51));
    }
}
