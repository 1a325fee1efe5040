//! Light that is thrown back and forth between a dielectric coat and what lies below it.

mod diffuse_base;
mod round_trips;

pub use diffuse_base::{DiffuseBase, Walk};
pub use round_trips::RoundTrips;
