//! The `caustica` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    caustica::cli::main()
}
