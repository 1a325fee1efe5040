//! Photons: tracing them from the lamps, storing, finding and weighing them.

pub mod aim;
mod boundary;
mod clearance;
pub mod estimate;
mod find;
pub mod irradiance;
mod job;
mod media;
pub mod radius;
mod scan;
mod sort;
pub mod store;
mod stored;
mod surfaces;
pub mod trace;
pub mod volume;

pub use boundary::{Boundary, Surroundings};
pub use clearance::Clearance;
pub use estimate::{Estimator, Gather, GatherPoint};
pub use store::{PhotonMap, Query};
pub use stored::{Photon, Stored};

use crate::transport::{PathClass, Smallness};
