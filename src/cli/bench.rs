//! `caustica bench`: error against time, each render a process of this program or of another renderer.

use std::sync::atomic::Ordering;

use caustica_tools::bench;

use super::interrupt::Interrupt;

/// Prints progress and tables; the exit status is 0, 1 where the work could not be done, 2 where the arguments are
/// wrong, or that of the signal which ended the work.
///
/// # Errors
/// When this program's own file cannot be found.
pub fn run(args: &bench::BenchArgs, interrupt: &Interrupt) -> Result<u8, String> {
    let program = std::env::current_exe().map_err(|e| format!("cannot find this program's file: {e}"))?;
    interrupt.watch();
    let status = bench::run(args, &program, interrupt.flag(), &mut std::io::stdout().lock());
    Ok(if interrupt.flag().load(Ordering::Acquire) { interrupt.status() } else { status })
}
