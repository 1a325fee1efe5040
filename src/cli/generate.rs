//! `caustica completions` and `caustica man`: what shells and `man` want to know of the command line.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Arg, ArgAction, Args, Command, ValueHint};
use clap_complete::Shell;
use clap_mangen::Man;

/// Arguments of `caustica completions`.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// Shell
    shell: Shell,
}

/// Arguments of `caustica man`.
#[derive(Args, Debug)]
pub struct ManArgs {
    /// Folder to write into, such as /usr/local/share/man/man1; it is made if it is not there
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Prints the completions of a shell.
///
/// # Errors
/// When stdout cannot be written.
pub fn completions(args: &CompletionsArgs, mut command: Command) -> Result<u8, String> {
    command = without_files(command);
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut command, "caustica", &mut text);
    match io::stdout().lock().write_all(&text) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("cannot write to stdout: {error}"))
        }
        _ => Ok(0),
    }
}

/// Without the names of files as values of options that take something else, which shells offer where nothing is said.
fn without_files(command: Command) -> Command {
    let hinted = |arg: Arg| {
        let takes_value = matches!(arg.get_action(), ArgAction::Set | ArgAction::Append);
        let said = arg.get_value_hint() != ValueHint::Unknown || !arg.get_possible_values().is_empty();
        if takes_value && !said { arg.value_hint(ValueHint::Other) } else { arg }
    };
    command.mut_args(hinted).mut_subcommands(without_files)
}

/// Writes a page for the program and one for each command.
///
/// # Errors
/// When the folder or a page cannot be written.
pub fn man(args: &ManArgs, command: Command) -> Result<u8, String> {
    let failed = |error| format!("cannot write man pages into `{}`: {error}", args.folder.display());
    std::fs::create_dir_all(&args.folder).map_err(failed)?;
    // The command `help` has nothing to say that the pages do not.
    let mut command = command.disable_help_subcommand(true).long_version(None::<&str>);
    command.build();
    for command in std::iter::once(&command).chain(command.get_subcommands()) {
        // The list of all options follows: the synopsis need not name them without their values.
        let usage = command.clone().render_usage().to_string();
        let usage = usage.trim_start_matches("Usage:").trim().to_owned();
        let page = Man::new(command.clone().override_usage(usage))
            .source(concat!("caustica ", env!("CARGO_PKG_VERSION")));
        page.manual("Caustica Manual").generate_to(&args.folder).map_err(failed)?;
    }
    Ok(0)
}
