//! The pass driver: runs passes in order, samples every pixel, knows when to stop.

mod aovs;
mod bands;
mod checkpoint;
mod driver;
mod extra;

pub use checkpoint::{Checkpoint, CheckpointError};
pub use driver::{Budget, Outcome, Progress, Statistics, Stop, Sums, render};
