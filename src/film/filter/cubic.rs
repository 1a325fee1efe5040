use super::Profile;

/// The family of Mitchell and Netravali 1988; Catmull–Rom is B = 0, C = ½.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// B of the family.
    pub b: f64,
    /// C of the family.
    pub c: f64,
}

impl Profile for Cubic {
    fn radius(&self) -> f64 {
        2.0
    }

    fn weight(&self, x: f64) -> f64 {
        let (b, c, x) = (self.b, self.c, x.abs());
        if x < 1.0 {
            ((12.0 - 9.0 * b - 6.0 * c) * x * x * x + (-18.0 + 12.0 * b + 6.0 * c) * x * x + (6.0 - 2.0 * b))
                / 6.0
        } else if x < 2.0 {
            ((-b - 6.0 * c) * x * x * x
                + (6.0 * b + 30.0 * c) * x * x
                + (-12.0 * b - 48.0 * c) * x
                + (8.0 * b + 24.0 * c))
                / 6.0
        } else {
            0.0
        }
    }
}

/// pbrt's: the two units of the cubic on each side stretched to `radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretched {
    /// The filter at its own size.
    pub cubic: Cubic,
    /// Half of the support in pixels.
    pub radius: f64,
}

impl Profile for Stretched {
    fn radius(&self) -> f64 {
        self.radius
    }

    fn weight(&self, x: f64) -> f64 {
        self.cubic.weight(2.0 * x / self.radius)
    }
}
