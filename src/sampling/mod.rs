//! Random and low-discrepancy numbers that depend only on (seed, pass, index, dimension), and the
//! distributions sampled with them.

mod bins;
mod density;
mod distribution;
mod guide;
mod hash;
mod sampler;
mod sobol;
pub mod warp;

pub use bins::{AXES, Bins, Found, Grown};
pub use density::Density;
pub use distribution::Discrete;
pub use guide::Guide;
pub use hash::{CounterRng, mix};
pub use sampler::Sampler;
