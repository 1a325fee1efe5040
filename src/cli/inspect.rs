//! `caustica inspect`: the scene as it was read, its statistics, the plan, and what is wrong with it.

use clap::Args;

use super::failure::Failure;
use super::report;
use super::scene::SceneArgs;
use super::threads::ThreadArgs;

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Prints what is to be said of the scene to stdout, and problems to stderr. The exit status is that of `render`: 1
/// where the scene cannot be rendered.
///
/// # Errors
/// When what was asked for is wrong.
pub fn run(args: &InspectArgs) -> Result<u8, Failure> {
    args.threads.apply()?;
    let inspection = args.scene.inspect()?;
    let description = inspection.describe();
    match &inspection.failure {
        Some(failure) => report::error(&failure.to_string()),
        None if args.json || inspection.warnings().is_empty() => {}
        None => report::line(&inspection.warnings()),
    }
    report::data(&if args.json {
        serde_json::to_string_pretty(&description).map_err(|e| e.to_string())?
    } else {
        description.to_string()
    })?;
    Ok(inspection.failure.map_or(0, |failure| Failure::from(failure).status()))
}
