//! Our pictures against references made by Mitsuba 3: one trial for each manifest `reference/*.toml`
//! and integrator. `CAUSTICA_REFERENCE=long` renders 4 times as many samples under tighter limits.
//!
//! A failed trial leaves the picture, the reference, a FLIP map and an HTML page of the comparison in
//! `target/reference-failures/NAME/`.

mod reference_suite;

use libtest_mimic::Arguments;
use reference_suite::{Profile, trials};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    match trials(root, Profile::from_environment()) {
        Ok(trials) => libtest_mimic::run(&arguments, trials).exit_code(),
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}
