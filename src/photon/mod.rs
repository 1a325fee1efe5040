//! Photons: tracing them from the lamps, storing, finding and weighing them.

mod boundary;
pub mod estimate;
pub mod owner;
pub mod radius;
mod scan;
pub mod store;
pub mod trace;

pub use boundary::Boundary;
pub use estimate::{Estimator, Gather};
pub use owner::{LightPath, Owner};
pub use store::{Photon, PhotonMap, Query};
