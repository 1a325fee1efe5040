//! Error against time of whole renderers. Every render is a process of its own, judged by the crate's metrics
//! and written to tables and pages. caustica is measured like any other renderer.

mod analysis;
mod args;
mod config;
mod error;
mod files;
mod judge;
mod machine;
mod markdown;
mod noise;
mod page;
mod plan;
mod plot;
mod process;
mod reach;
mod record;
mod renderers;
mod run;
mod statistics;
mod study;
mod table;
mod thumbnail;

use renderers::Programs;

pub use args::BenchArgs;

use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Runs the benchmark or the studies that the arguments ask for, with `caustica` as the program to measure.
/// Progress, tables and errors go to `out`. Once `stop` is true, the render that is running is stopped and nothing else
/// is begun. Returns the exit status of the process: 0, 1 after an error, or 2 if
/// the arguments are wrong.
pub fn run(args: &BenchArgs, caustica: &Path, stop: &Arc<AtomicBool>, out: &mut dyn Write) -> u8 {
    let result = match &args.study {
        Some(name) => study::run(name, args, Programs::new(args, caustica, stop), out),
        None => args.clone().resolve().and_then(|args| {
            let programs = Programs::new(&args, caustica, stop);
            run::run(&args, programs, out)
        }),
    };
    match result {
        Ok(()) => 0,
        Err(e) => {
            // If the output is closed, nobody can be told.
            let _closed = writeln!(out, "error: {e}");
            e.status()
        }
    }
}
