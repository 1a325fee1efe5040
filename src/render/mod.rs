//! The pass driver: runs passes in order, samples every pixel, knows when to stop.

mod aovs;
mod bands;
mod checkpoint;
mod driver;
mod effort;
mod extra;
mod noise;
mod sharing;

pub use bands::SHARED_BYTES;
pub use checkpoint::{Checkpoint, CheckpointError, Head};
pub use driver::{Budget, MOST_PASSES, Outcome, Progress, Statistics, Stop, Sums, render};
pub use noise::NOISE_BYTES;
