//! Density kernels. Knows only floats.
//!
//! A kernel weighs a photon by its distance u ∈ [0, 1] in units of the search radius. All are radial on
//! the unit disc and have unit mass there: ∫₀¹ k(u)·2πu du = 1, so k/r² is a density per area.
//! To add one: a `kernel!` and its name in the table below.

use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

use crate::math::closed_enum;

macro_rules! kernel {
    ($(#[$doc:meta])* $name:ident, $text:literal, |$u2:ident| $shape:expr, $mass:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;
        impl Kernel for $name {
            fn name() -> &'static str {
                $text
            }
            #[inline(always)]
            fn shape($u2: f32) -> f32 {
                $shape
            }
            fn mass() -> f64 {
                $mass
            }
        }
    };
}

kernel!(
    /// Equal weight.
    Constant, "constant", |_u2| 1.0, PI
);
kernel!(
    /// Falls linearly (Jensen's cone filter with k = 1).
    Cone, "cone", |u2| 1.0 - u2.sqrt(), PI / 3.0
);
kernel!(
    /// 1 − u²: least mean square error of all non-negative kernels at equal radius.
    Epanechnikov, "epanechnikov", |u2| 1.0 - u2, PI / 2.0
);
kernel!(
    /// (1 − u²)², Mitsuba 0.6's "Simpson" kernel.
    Biweight, "biweight", |u2| (1.0 - u2) * (1.0 - u2), PI / 3.0
);
kernel!(
    /// (1 − u²)³.
    Triweight, "triweight", |u2| (1.0 - u2) * (1.0 - u2) * (1.0 - u2), PI / 4.0
);
kernel!(
    /// (1 − u³)³.
    Tricube, "tricube", |u2| { let v = 1.0 - u2 * u2.sqrt(); v * v * v }, PI * 81.0 / 220.0
);
kernel!(
    /// Gaussian with σ = ⅓ of the radius, cut at 3σ.
    Gaussian, "gaussian", |u2| (-4.5 * u2).exp(), PI * (1.0 - (-4.5f64).exp()) / 4.5
);
kernel!(
    /// Logistic density 1/(eˣ + 2 + e⁻ˣ) with x = 6u.
    Logistic, "logistic", |u2| { let e = (-6.0 * u2.sqrt()).exp(); e / ((1.0 + e) * (1.0 + e)) }, logistic_mass()
);
kernel!(
    /// Silverman's kernel e^(−x/√2)·sin(x/√2 + π/4), scaled so that its first zero is the radius.
    Silverman, "silverman", |u2| {
        let x = SILVERMAN_ZERO * u2.sqrt();
        (-x).exp() * (x + std::f32::consts::FRAC_PI_4).sin().max(0.0)
    }, silverman_mass()
);

/// x/√2 at Silverman's first zero: 3π/4.
const SILVERMAN_ZERO: f32 = 0.75 * std::f32::consts::PI;

/// ∫ u·e^(−cu)/(1+e^(−cu))² du on [0,1] times 2π, by parts: with s = 1/(1+e^(−cu)) the integrand is
/// u·s'/c.
fn logistic_mass() -> f64 {
    let c = 6.0f64;
    let s1 = 1.0 / (1.0 + (-c).exp());
    // ∫ s du = ln(1 + e^{cu})/c.
    let integral_s = ((1.0 + c.exp()).ln() - 2f64.ln()) / c;
    2.0 * PI * (s1 - integral_s) / c
}

/// ∫ u·e^(−zu)·sin(zu + π/4) du on [0,1] times 2π; the antiderivative of e^(−t)·sin(t + π/4) is
/// −e^(−t)·sin(t + π/2)/√2 = −e^(−t)·cos(t)/√2.
fn silverman_mass() -> f64 {
    let z = 0.75 * PI;
    let root2 = 2f64.sqrt();
    // By parts with t = zu: [−t·e^{−t}cos t/√2] + ∫ e^{−t}cos t/√2 dt, and ∫e^{−t}cos t = e^{−t}(sin t − cos t)/2.
    let e = (-z).exp();
    let boundary = -z * e * z.cos() / root2;
    let rest = (e * (z.sin() - z.cos()) + 1.0) / (2.0 * root2);
    2.0 * PI * (boundary + rest) / (z * z)
}

closed_enum! {
    /// A radial profile, up to scale, as a function of u². It never rises with u and is never negative.
    pub trait Kernel: Copy {
        /// What settings call it.
        fn name() -> &'static str;
        /// Profile at squared distance `u2` in [0, 1], in units of the search radius; finite and non-negative there.
        fn shape(u2: f32) -> f32;
        /// ∫₀¹ shape(u²)·2πu du, in closed form; positive.
        fn mass() -> f64;
    }

    /// Kernels by name. [`with_kernel`] chooses the type once, not per photon.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum KernelKind {
        Constant, Cone, Epanechnikov, Biweight, Triweight, Tricube, Gaussian, Logistic, Silverman
    } chosen by with_kernel in kernel
}
pub(crate) use with_kernel;

impl KernelKind {
    /// Weight at squared distance `u2`, with unit mass on the unit disc.
    pub fn weight(self, u2: f32) -> f32 {
        (f64::from(self.shape(u2)) / self.mass()) as f32
    }
}

impl fmt::Display for KernelKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for KernelKind {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        Self::ALL.iter().copied().find(|k| k.name() == s).ok_or_else(|| {
            let names: Vec<_> = Self::ALL.iter().map(|k| k.name()).collect();
            format!("one of {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule in u with 10⁵ cells: its error is below 1e-9 for these profiles, f32 weights add 1e-7.
    #[test]
    fn every_kernel_has_unit_mass_and_never_rises() {
        for &k in KernelKind::ALL {
            let n = 100_000;
            let mut mass = 0.0;
            let mut last = f32::INFINITY;
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let w = k.weight((u * u) as f32);
                assert!(w >= 0.0 && w <= last * (1.0 + 1e-6), "{k} at {u}");
                last = w;
                mass += f64::from(w) * 2.0 * PI * u / f64::from(n);
            }
            assert!((mass - 1.0).abs() < 1e-6, "{k}: {mass}");
        }
    }
}
