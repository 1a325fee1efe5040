//! `caustica merge`: parts of a render become its picture.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::picture::PictureArgs;
use super::report;
use super::scene::whole;
use crate::session::{Merged, Parts, files_of_parts, listed_passes};

/// Arguments of `merge`.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// Checkpoints of `render --pass-range`; a folder stands for all its .ckpt files
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    picture: PictureArgs,
    /// Passes that the whole render has [default: as many as the parts say]
    #[arg(long, value_name = "N", value_parser = whole, allow_negative_numbers = true)]
    passes: Option<u32>,
    /// Merge what is there; the header of the EXR names what is missing
    #[arg(long)]
    allow_missing: bool,
    /// Also write all parts as one checkpoint, which can be merged again or resumed
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Print only errors
    #[arg(short, long)]
    quiet: bool,
}

/// Merges parts into files.
///
/// # Errors
/// When a part cannot be read, parts are of different renders, passes are there twice or missing, or a file cannot be
/// written.
pub fn run(args: &MergeArgs) -> Result<u8, Failure> {
    let layers = args.picture.layers()?;
    let files = files_of_parts(&args.parts)?;
    let parts = Parts::read(&files)?;
    parts.check(args.passes, args.allow_missing, layers.as_ref())?;
    let output = args.picture.output(parts.info());
    let others: Vec<&Path> = args.checkpoint.as_deref().into_iter().collect();
    output.check_merged(layers.as_ref().is_some_and(|layers| !layers.is_empty()), &files, &others)?;
    let _locks = output.lock(&others)?;
    let mut merged = parts.merge(args.passes, args.allow_missing, &mut |_| {})?;
    if let Some(layers) = layers {
        merged.set_layers(layers)?;
    }
    output.write(&merged.picture())?;
    if let Some(file) = &args.checkpoint {
        merged.save(file)?;
    }
    if !args.quiet {
        report::line(&summary(&merged, files.len()));
        for file in output.files.iter().map(PathBuf::as_path).chain(others) {
            report::line(&format!("wrote {}", file.display()));
        }
    }
    Ok(0)
}

fn summary(merged: &Merged, parts: usize) -> String {
    let plural = if parts == 1 { "" } else { "s" };
    let mut rows = vec![format!("passes          {} from {parts} part{plural}", merged.passes())];
    if !merged.missing().is_empty() {
        rows.push(format!("missing         {}", listed_passes(merged.missing())));
    }
    let error = merged.relative_error();
    if error.is_finite() {
        rows.push(format!("standard error  {:.3} % of the mean", 100.0 * error));
    }
    rows.join("\n")
}
