//! The live view of the program from outside: the page's protocol without and with a browser, and tev's protocol.
//!
//! The browser's screenshots are left in `target/live-view/`.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod view;

use std::process::ExitCode;

use libtest_mimic::Arguments;

fn main() -> ExitCode {
    libtest_mimic::run(&Arguments::from_args(), view::trials()).exit_code()
}
