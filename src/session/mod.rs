//! The front door: what the command line, tests and benchmarks call.

mod plan;

pub use plan::Plan;
