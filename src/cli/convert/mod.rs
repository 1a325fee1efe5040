//! `caustica convert`: a scene in the language that the name of the output asks for.

mod args;
mod check;
mod outside;
mod sizes;

use caustica_formats::confined::Confined;
use caustica_formats::image::atomic_write;
use caustica_formats::{Loss, Read, ReadOptions, WriteError, Written, ir, read_scene, write_scene};

use super::failure::Failure;
use super::report;
use crate::session::{self, Error, Options, check_place};

pub use args::ConvertArgs;

/// Converts a scene. The exit status is 0, or with `--check` 1 where the pictures differ.
///
/// # Errors
/// When the scene cannot be read, or the result cannot be written.
pub fn run(args: &ConvertArgs) -> Result<u8, Failure> {
    let options =
        ReadOptions { defines: args.define.clone(), lenient: args.lenient, search: args.allow_path.clone() };
    let files = Confined::new(&args.input, &args.allow_path);
    let mut read = read_scene(&files, &args.input, &options).map_err(Error::from)?;
    // What is not fit for rendering is not converted either: `inspect`, `render` and `convert` agree.
    let rendering =
        Options { spectrum_rule: args.spectral_to_rgb.rule(), lenient: args.lenient, ..Options::default() };
    session::check(&read, &files, &args.input, &rendering)?;
    warn(&read);
    if let Some(rule) = args.spectral_to_rgb.rule() {
        read.scene.spectrum_rule = rule;
    }
    let mut written = write_scene(&read, &files, &args.output).map_err(|e| match e {
        WriteError::UnknownLanguage { .. } => Failure::Usage(e.to_string()),
        e => Failure::Work(e.to_string()),
    })?;
    if let Some(path) = &args.report {
        written.spare_inputs(path).map_err(|e| e.to_string())?;
    }
    check_place(&args.output)?;
    written.save(&files, args.force).map_err(|e| e.to_string())?;
    sizes::measure(&read, &files, &mut written);
    for loss in &written.losses {
        report::line(&describe(loss));
    }
    if let Some(path) = &args.report {
        let text = serde_json::to_string_pretty(&written.losses).map_err(|e| e.to_string())?;
        atomic_write(path, text.as_bytes()).map_err(|e| format!("cannot write `{}`: {e}", path.display()))?;
    }
    report::line(&summary(&written, &read.scene));
    let ours = if args.check { check::run(args)? } else { 0 };
    let theirs = args.check_with.map_or(Ok(0), |renderer| outside::run(args, renderer))?;
    Ok(ours.max(theirs))
}

fn warn(read: &Read) {
    if !read.warnings.is_empty() {
        report::line(read.sources.render(&read.warnings).trim_end());
    }
}

fn describe(loss: &Loss) -> String {
    let place = loss.place.as_ref().map_or(String::new(), |place| format!("{place}: "));
    let size = loss.size.map_or(String::new(), |size| format!("\n  size: {} % of its light", percent(size)));
    format!("lost: {place}{}\n  instead: {}{size}", loss.what, loss.instead)
}

/// A part as a signed percentage; what rounds to nothing has no sign.
fn percent(part: f64) -> String {
    let rounded = (100.0 * part).round();
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded:+.0}") }
}

fn summary(written: &Written, scene: &ir::Scene) -> String {
    let plural = |n: usize, one: &str, many: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{n} {many}"),
    };
    format!(
        "{}: {}, {} beside it, {}",
        written.path.display(),
        plural(scene.shapes.len(), "shape", "shapes"),
        plural(written.assets.len(), "file", "files"),
        plural(written.losses.len(), "loss", "losses"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_has_no_sign() {
        assert_eq!([-0.004, 0.0, 0.004, -0.006, 0.126].map(percent), ["0", "0", "0", "-1", "+13"]);
    }
}
