use super::Profile;

/// Gaussian cut at 4σ, lowered so that it ends at zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// σ in pixels.
    pub stddev: f64,
}

impl Profile for Gaussian {
    fn radius(&self) -> f64 {
        4.0 * self.stddev
    }

    fn weight(&self, x: f64) -> f64 {
        let g = |x: f64| (-x * x / (2.0 * self.stddev * self.stddev)).exp();
        (g(x) - g(self.radius())).max(0.0)
    }
}

/// pbrt's Gaussian: cut at `radius` and lowered so that it ends at zero there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truncated {
    /// σ in pixels.
    pub sigma: f64,
    /// Half of the support in pixels.
    pub radius: f64,
}

impl Profile for Truncated {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn weight(&self, x: f64) -> f64 {
        let g = |x: f64| (-x * x / (2.0 * self.sigma * self.sigma)).exp();
        (g(x) - g(self.radius)).max(0.0)
    }
}
