//! Radiance of the sun and the sky: the models of Hošek and Wilkie with their published numbers ("An analytic model for
//! full spectral sky-dome radiance", 2012; "Adding a solar-radiance function to the Hošek–Wilkie skylight model",
//! 2013), in the units of Mitsuba. Pure functions of directions: who shows them is a matter of others.

mod data;
mod daylight;
mod days;
mod picture;
mod place;
mod preetham;

use crate::ir::Transform;

pub use daylight::{Daylight, Sun, sun_direction};
pub use picture::{Picture, picture};

/// The local space of Mitsuba 0.6 (+Y is up, −Z north, +X east), seen from that of a [`SunSky`]: local → old local.
pub const FROM_OLD: Transform =
    Transform([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);

#[cfg(test)]
mod tests;
