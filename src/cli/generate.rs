//! `caustica completions` and `caustica man`: what shells and `man` want to know of the command line.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, Command};
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
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut command, "caustica", &mut text);
    match io::stdout().lock().write_all(&text) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(format!("cannot write to stdout: {error}"))
        }
        _ => Ok(0),
    }
}

/// Writes a page for the program and one for each command.
///
/// # Errors
/// When the folder or a page cannot be written.
pub fn man(args: &ManArgs, command: Command) -> Result<u8, String> {
    let failed = |error| format!("cannot write man pages into `{}`: {error}", args.folder.display());
    std::fs::create_dir_all(&args.folder).map_err(failed)?;
    // The command `help` has nothing to say that the pages do not.
    let mut command = command.disable_help_subcommand(true);
    command.build();
    for command in std::iter::once(&command).chain(command.get_subcommands()) {
        let page = Man::new(command.clone()).source(concat!("caustica ", env!("CARGO_PKG_VERSION")));
        page.manual("Caustica Manual").generate_to(&args.folder).map_err(failed)?;
    }
    Ok(0)
}
