use std::f64::consts::PI;

use super::Profile;

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-9 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Sinc windowed by a wider sinc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanczos {
    /// Zeros of the window on each side, and radius in pixels.
    pub lobes: u32,
}

impl Profile for Lanczos {
    fn radius(&self) -> f64 {
        f64::from(self.lobes)
    }

    fn weight(&self, x: f64) -> f64 {
        if x.abs() < f64::from(self.lobes) { sinc(x) * sinc(x / f64::from(self.lobes)) } else { 0.0 }
    }
}

/// pbrt's: the window has its zero at `tau`, the support ends at `radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinc {
    /// Where the window has its zero, in pixels.
    pub tau: f64,
    /// Half of the support in pixels.
    pub radius: f64,
}

impl Profile for Sinc {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn weight(&self, x: f64) -> f64 {
        if x.abs() > self.radius { 0.0 } else { sinc(x) * sinc(x / self.tau) }
    }
}
