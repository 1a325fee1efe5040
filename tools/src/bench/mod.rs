//! Error against time: renders are measured as processes, judged by [`crate::metrics`] and
//! [`crate::flip`], and written as tables and pages. The renderer is a program like any other.

mod analysis;
mod args;
mod config;
mod error;
mod machine;
mod page;
mod pbrt;
mod plot;
mod process;
mod python;
mod record;
mod renderers;
mod run;
mod statistics;
mod study;
mod table;
mod thumbnail;

pub use args::BenchArgs;
pub use error::BenchError;

use std::io::Write;
use std::path::Path;

/// Exit status of a run that could not do its work.
const FAILED: u8 = 1;

/// Runs the benchmark or the studies that the arguments ask for with the given `caustica` program.
/// Progress, tables and errors go to `out`; the value is the exit status of the process.
pub fn run(args: &BenchArgs, caustica: &Path, out: &mut dyn Write) -> u8 {
    let result = match &args.study {
        Some(name) => study::run(name, args, caustica, out),
        None => args.clone().resolve().and_then(|args| run::run(&args, caustica, out)),
    };
    match result {
        Ok(()) => 0,
        Err(e) => {
            // With a closed output there is nobody to tell.
            let _closed = writeln!(out, "error: {e}");
            FAILED
        }
    }
}
