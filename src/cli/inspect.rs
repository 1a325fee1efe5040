//! `caustica inspect`: the scene as it was read, its statistics, the plan, and what is not rendered.

use clap::Args;

use super::failure::Failure;
use super::report;
use super::scene::SceneArgs;

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Prints what is to be said of the scene to stdout. What is not supported is listed there; other
/// warnings go to stderr.
///
/// # Errors
/// When the scene cannot be opened.
pub fn run(args: &InspectArgs) -> Result<u8, Failure> {
    let session = args.scene.inspect()?;
    let description = session.describe();
    if args.json {
        report::data(&serde_json::to_string_pretty(&description).map_err(|e| e.to_string())?)?;
    } else {
        if !session.other_warnings().is_empty() {
            report::line(session.other_warnings());
        }
        report::data(&description.to_string())?;
    }
    Ok(0)
}
