//! Subcommands. Each is one file or folder that parses arguments, calls the library and prints.

mod bench;
mod compare;
mod convert;
mod failure;
mod generate;
mod inspect;
mod interrupt;
mod merge;
mod picture;
mod render;
mod report;
mod scene;
mod submit;
mod summary;
mod threads;
mod version;
mod view;
mod words;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use failure::Failure;

/// Photon-mapping renderer for Mitsuba and pbrt scenes.
#[derive(Debug, Parser)]
#[command(name = "caustica", version, long_version = version::long(), about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to EXR, PNG, HDR or PFM
    Render(Box<render::RenderArgs>),
    /// Make the picture of a render from its parts
    Merge(Box<merge::MergeArgs>),
    /// Render on many machines: write the jobs for a scheduler
    Submit(Box<submit::SubmitArgs>),
    /// Write a scene in another language, or in the newest version of its own
    Convert(Box<convert::ConvertArgs>),
    /// Show what a scene holds and what rendering it takes
    Inspect(Box<inspect::InspectArgs>),
    /// Compare an image with a reference, or a folder with a folder
    Compare(Box<caustica_tools::compare::CompareArgs>),
    /// Measure error against CPU time, or repeat a study of the parameters
    Bench(Box<caustica_tools::bench::BenchArgs>),
    /// Print the completions of a shell
    Completions(generate::CompletionsArgs),
    /// Write man pages
    Man(generate::ManArgs),
}

/// Exit status of a run that could not do its work.
const FAILED: u8 = 1;

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    // clap prints usage errors itself and exits with 2.
    let matches = Arguments::command().get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let interrupt = match interrupt::Interrupt::begin() {
        Ok(interrupt) => interrupt,
        Err(problem) => {
            report::error(&problem);
            return ExitCode::from(FAILED);
        }
    };
    let result: Result<u8, Failure> = match arguments.command {
        Command::Render(args) => render::run(&args, &interrupt),
        Command::Merge(args) => merge::run(&args),
        Command::Submit(args) => {
            let given = matches.subcommand().map(|(_, matches)| scene::SceneArgs::given(matches));
            submit::run(&args, &given.unwrap_or_default())
        }
        Command::Convert(args) => convert::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Compare(args) => Ok(compare::run(&args)),
        Command::Bench(args) => bench::run(&args, &interrupt).map_err(Into::into),
        Command::Completions(args) => generate::completions(&args, Arguments::command()).map_err(Into::into),
        Command::Man(args) => generate::man(&args, Arguments::command()).map_err(Into::into),
    };
    match result {
        Ok(status) => ExitCode::from(status),
        Err(failure) => {
            report::error(failure.message());
            ExitCode::from(failure.status())
        }
    }
}
