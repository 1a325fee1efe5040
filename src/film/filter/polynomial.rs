/// Constant weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box {
    pub radius: f64,
}

/// Linear fall to zero at `radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tent {
    pub radius: f64,
}

impl Tent {
    pub fn weight(&self, x: f64) -> f64 {
        (1.0 - x.abs() / self.radius).max(0.0)
    }
}
