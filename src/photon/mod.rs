//! Photons: tracing them from the lamps, storing, finding and weighing them.

pub mod aim;
mod boundary;
pub mod estimate;
mod find;
pub mod irradiance;
mod job;
mod media;
pub mod radius;
mod scan;
pub mod store;
mod surfaces;
pub mod trace;
pub mod volume;

pub use boundary::Boundary;
pub use estimate::{Estimator, Gather, GatherPoint};
pub use store::{Photon, PhotonMap, Query};

use crate::transport::PathClass;
