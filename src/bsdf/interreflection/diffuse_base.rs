//! What becomes of light between a coat and its diffuse base.

use crate::bsdf::fresnel;
use crate::math::{Color, gauss_legendre};

/// What becomes of light between a coat and the diffuse base below it.
#[derive(Clone, Copy, Debug)]
pub enum DiffuseBase {
    /// It keeps the colour of its first meeting with the base (Mitsuba's `plastic`).
    White,
    /// Every meeting colours it (`nonlinear`).
    Colored,
    /// As pbrt's `LayeredBxDF` walks.
    Walk(Walk),
}

/// An absorbing layer, and an end of the walk.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// A passage at cosθ lets exp(−thickness/cosθ) through, whatever the scene's unit.
    thickness: f32,
    /// Most meetings with the base.
    meetings: i32,
    /// Of diffuse light from the base, below a smooth coat: what leaves, and what comes back to the base, over what
    /// would without absorption.
    leaves: f32,
    returns: f32,
}

impl Walk {
    /// `max_depth` counts the meetings with coat and base, base first.
    pub fn new(thickness: f32, max_depth: u32, eta: f32) -> Self {
        let [mut leaves, mut returns] = [[0.0; 2]; 2];
        // The kink at the critical angle keeps the error at 10⁻⁴.
        for (cos, weight) in gauss_legendre(256) {
            let reflected = f64::from(fresnel::dielectric(cos as f32, 1.0 / eta).reflectance);
            let passes = (-f64::from(thickness) / cos).exp();
            for (k, absorbed) in [1.0, passes].into_iter().enumerate() {
                leaves[k] += weight * cos * (1.0 - reflected) * absorbed;
                returns[k] += weight * cos * reflected * absorbed * absorbed;
            }
        }
        let ratio = |[clear, absorbed]: [f64; 2]| if clear > 0.0 { (absorbed / clear) as f32 } else { 1.0 };
        let meetings = i32::try_from(max_depth.div_ceil(2)).unwrap_or(i32::MAX);
        Self { thickness, meetings, leaves: ratio(leaves), returns: ratio(returns) }
    }
}

impl DiffuseBase {
    /// Reflectance of the base with all its meetings; `internal` is the share of diffuse light that the coat throws
    /// back.
    pub fn base(&self, diffuse: Color, internal: f32) -> Color {
        match self {
            Self::White => diffuse / (1.0 - internal),
            Self::Colored => diffuse / (Color::ONE - diffuse * internal),
            Self::Walk(w) => {
                let again = diffuse * (internal * w.returns);
                let sum =
                    |q: f32| if q < 1.0 { (1.0 - q.powi(w.meetings)) / (1.0 - q) } else { w.meetings as f32 };
                diffuse * again.map(sum)
            }
        }
    }

    /// What a passage between coat and base lets through, for light that is at `cos` outside.
    pub fn passage(&self, cos: f32, eta: f32) -> f32 {
        let Self::Walk(walk) = self else { return 1.0 };
        let inside = (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt();
        (-walk.thickness / inside).exp()
    }

    /// Share of diffuse light from the base that leaves at once.
    pub fn leaves(&self, internal: f32) -> f32 {
        (1.0 - internal) * if let Self::Walk(walk) = self { walk.leaves } else { 1.0 }
    }
}
