//! `caustica bench` with any `caustica` program: the judge can be built without the renderer.

use caustica_tools::bench::{self, BenchArgs};
use clap::Parser;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Parser)]
#[command(name = "caustica-bench", version, about = "Measure error against time")]
struct Cli {
    /// Program whose `render` is measured
    #[arg(long, value_name = "PATH", default_value = "caustica")]
    caustica: PathBuf,
    #[command(flatten)]
    args: BenchArgs,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    bench::run(&cli.args, &cli.caustica, &Default::default(), &mut std::io::stdout().lock()).into()
}
