use super::Profile;

/// Constant weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box {
    /// Half of the support in pixels.
    pub radius: f64,
}

impl Profile for Box {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn weight(&self, _x: f64) -> f64 {
        1.0
    }

    fn is_even(&self) -> bool {
        true
    }
}

/// Linear fall to zero at `radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tent {
    /// Half of the support in pixels.
    pub radius: f64,
}

impl Profile for Tent {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn weight(&self, x: f64) -> f64 {
        (1.0 - x.abs() / self.radius).max(0.0)
    }
}
