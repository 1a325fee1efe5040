//! Phase functions: in which directions a medium scatters. One file per model; [`Scatter`] is the contract, [`Phase`]
//! the table.

mod henyey_greenstein;
mod isotropic;
mod kajiya_kay;
mod microflake;
mod mixture;
mod rayleigh;
mod sggx;
mod tabulated;

pub use henyey_greenstein::HenyeyGreenstein;
pub use isotropic::Isotropic;
pub use kajiya_kay::KajiyaKay;
pub use microflake::Microflake;
pub use mixture::{Blend, Mixture};
pub use rayleigh::Rayleigh;
pub use sggx::Sggx;
pub use tabulated::Tabulated;

use crate::math::{Frame, Vec2, Vec3, closed_enum};

/// A direction drawn from a phase function.
#[derive(Clone, Copy, Debug)]
pub struct PhaseSample {
    /// Unit: where the path goes on.
    pub wo: Vec3,
    /// Value over density.
    pub weight: f32,
    /// Density per solid angle.
    pub pdf: f32,
}

closed_enum! {
    /// Directions are unit vectors in the world that point away from the point `p`: `wi` back to where the path came
    /// from, `wo` to where it goes on. Light that goes straight on has `wo` = −`wi`.
    pub trait Scatter {
        /// Share of the scattered light that goes from `wi` to `wo`, per steradian. Its integral over `wo` is 1; for
        /// [`KajiyaKay`] and [`Mixture`] it may be less, and the rest is absorbed. What photons carry is scattered alike, with `wi` and `wo`
        /// exchanged; where [`Scatter::area`] is 1, both are the same.
        #[inline(always)]
        fn eval(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32;

        /// Density per solid angle with which [`Scatter::sample`] chooses `wo`.
        #[inline(always)]
        fn pdf(&self, p: Vec3, wi: Vec3, wo: Vec3) -> f32 {
            self.eval(p, wi, wo)
        }

        /// A direction for uniform numbers; `pick` chooses among parts. `None` where nothing is scattered.
        #[inline(always)]
        fn sample(&self, p: Vec3, wi: Vec3, pick: f32, u: Vec2) -> Option<PhaseSample>;

        /// What it is called, with its numbers: for people.
        fn describe(&self) -> String;

        /// What a direction of travel ±`w` multiplies the extinction by: 1 but for flakes, whose projected area
        /// differs. `area(wi)·eval(wi, wo)` is symmetric.
        #[inline(always)]
        fn area(&self, _p: Vec3, _w: Vec3) -> f32 {
            1.0
        }

        /// No [`Scatter::area`] is greater.
        fn largest_area(&self) -> f32 {
            1.0
        }

        /// Whether [`Scatter::area`] is anything but 1.
        fn has_area(&self) -> bool {
            false
        }
    }

    /// Every phase function.
    #[derive(Clone, Debug)]
    pub enum Phase {
        /// Alike in all directions.
        Isotropic(Isotropic),
        /// Forwards or backwards by one number.
        HenyeyGreenstein(HenyeyGreenstein),
        /// Particles smaller than the wavelength.
        Rayleigh(Rayleigh),
        /// By a table over the cosine.
        Tabulated(Tabulated),
        /// Several with fixed weights.
        Mixture(Mixture),
        /// Two, with a weight that varies from place to place.
        Blend(Box<Blend>),
        /// Fibres.
        KajiyaKay(Box<KajiyaKay>),
        /// Flakes.
        Sggx(Box<Sggx>),
        /// Flakes of rough fibres.
        Microflake(Box<Microflake>),
    }
}

/// The unit direction at the angle of cosine 1 − `h` from `axis`, turned by `turn` ∈ [0, 1).
#[inline(always)]
fn around(axis: Vec3, h: f32, turn: f32) -> Vec3 {
    let r = (h * (2.0 - h)).max(0.0).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * turn).sin_cos();
    Frame::from_normal(axis).to_world(Vec3::new(r * cos, r * sin, 1.0 - h))
}

#[cfg(test)]
mod tests;
