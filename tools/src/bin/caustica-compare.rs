//! `caustica compare` on its own.

use caustica_tools::compare::{CompareArgs, run};
use clap::Parser;
use std::process::ExitCode;

/// Compares two images or two folders of images.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(flatten)]
    args: CompareArgs,
}

fn main() -> ExitCode {
    run(&Cli::parse().args, &mut std::io::stdout().lock()).into()
}
