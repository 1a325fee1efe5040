use std::f64::consts::PI;

/// Sinc windowed by a wider sinc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanczos {
    pub lobes: u32,
}

impl Lanczos {
    pub fn weight(&self, x: f64) -> f64 {
        let sinc = |x: f64| if x.abs() < 1e-9 { 1.0 } else { (PI * x).sin() / (PI * x) };
        if x.abs() < f64::from(self.lobes) { sinc(x) * sinc(x / f64::from(self.lobes)) } else { 0.0 }
    }
}
