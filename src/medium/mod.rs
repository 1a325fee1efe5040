//! Participating media: fog, smoke, milk. One file per model; [`Participate`] is the contract, [`Medium`] the table.
//! Phase functions are in [`phase`].
//!
//! Coefficients are per unit of length of the scene, in the lanes of a colour. A ray may have a direction of any
//! length; distances along it are in units of that length, as everywhere.

mod carried;
mod cloud;
mod grid;
mod heterogeneous;
mod homogeneous;
mod majorants;
pub mod phase;
mod values;
mod volume;

pub use carried::{Carried, Passage};
pub use cloud::Cloud;
pub use grid::{Beyond, Grid, Nodes, Reading};
pub use heterogeneous::{Heterogeneous, Scattering};
pub use homogeneous::Homogeneous;
pub use majorants::{Majorants, Segment, Segments};
pub use phase::{Phase, PhaseSample};
pub use values::{Bricks, Values};
pub use volume::{Matrices, Ramp, Symmetric, Volume};

use crate::math::{Color, Ray, Vec3, closed_enum};
use crate::sampling::Sampler;

/// Index into the media of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MediumId(pub u32);

/// The media on the two sides of a surface; `None` is vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boundary {
    /// Against the geometric normal.
    pub inside: Option<MediumId>,
    /// On the side that the normal points to.
    pub outside: Option<MediumId>,
}

/// A medium at a place, for a direction of travel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coefficients {
    /// Extinction: what is scattered or absorbed.
    pub sigma_t: Color,
    /// What is scattered.
    pub sigma_s: Color,
    /// Radiance that is emitted per unit of length.
    pub emission: Color,
}

closed_enum! {
    /// What every medium can do. Light is extinguished by e^−∫σt; σs of it goes where the phase function sends it.
    pub trait Participate {
        /// The coefficients at `p` for light that travels along the unit direction `d`.
        fn at(&self, p: Vec3, d: Vec3) -> Coefficients;

        /// An estimate of the light that is left at the end of the ray, exact in homogeneous media, and the density
        /// with which [`Medium::fly`] would pass over the same places.
        fn pass(&self, ray: &Ray, sampler: &mut Sampler) -> Passage;

        /// Flies along the ray. The distance of a collision that scatters, with σs in the weight; or `None` at the
        /// end of the ray. What the medium emits on the way is added to `emitted`, times the weight.
        fn fly(&self, ray: &Ray, carried: &mut Carried, emitted: &mut Color, sampler: &mut Sampler) -> Option<f32>;

        /// Where it scatters to.
        #[inline(always)]
        fn phase(&self) -> &Phase;

        /// Whether it scatters anywhere. One that only absorbs never ends a flight.
        fn scatters(&self) -> bool;

        /// Whether it emits anywhere.
        fn emits(&self) -> bool;

        /// The coefficients, if they are the same everywhere and in all directions.
        #[inline(always)]
        fn uniform(&self) -> Option<Coefficients> {
            None
        }

        /// Mean coefficients over its box, for a phase function that is alike in all directions: for choices, and for
        /// people. Costs nothing.
        fn mean(&self) -> Coefficients;
    }

    /// Every medium.
    #[derive(Clone, Debug)]
    pub enum Medium {
        /// The same everywhere.
        Homogeneous(Homogeneous),
        /// By grids.
        Heterogeneous(Box<Heterogeneous>),
    }
}

#[cfg(test)]
mod tests;
