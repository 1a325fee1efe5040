//! `caustica bench`: error against time, each render a process of this program or of another renderer.

use caustica_tools::bench;

/// Prints progress and tables; the exit status is 0, or 1 where the work could not be done.
///
/// # Errors
/// When this program's own file cannot be found.
pub fn run(args: &bench::BenchArgs) -> Result<u8, String> {
    let program = std::env::current_exe().map_err(|e| format!("cannot find this program's file: {e}"))?;
    Ok(bench::run(args, &program, &mut std::io::stdout().lock()))
}
