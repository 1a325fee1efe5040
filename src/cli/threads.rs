//! How many threads the program has.

use clap::Args;

/// More would only wait for each other, and every one takes memory before the first ray.
pub(super) const MAX_THREADS: i64 = 1024;

/// For every subcommand that traces rays in this process.
#[derive(Debug, Args)]
pub struct ThreadArgs {
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS), allow_negative_numbers = true)]
    threads: Option<u32>,
}

impl ThreadArgs {
    /// Sets the number for the whole process, before the first ray.
    ///
    /// # Errors
    /// When the system gives no threads.
    pub fn apply(&self) -> Result<(), String> {
        let Some(n) = self.threads else { return Ok(()) };
        rayon::ThreadPoolBuilder::new().num_threads(n as usize).build_global().map_err(|e| e.to_string())
    }
}
