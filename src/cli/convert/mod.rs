//! `caustica convert`: a scene in the language that the name of the output asks for.

mod args;
mod check;
mod outside;

use super::failure::Failure;
use super::report;
use crate::session::{Conversion, Converted, Loss, Options};

pub use args::ConvertArgs;

/// Converts a scene. The exit status is 0, or with `--check` 1 where the pictures differ.
///
/// # Errors
/// When the scene cannot be read, or the result cannot be written.
pub fn run(args: &ConvertArgs) -> Result<u8, Failure> {
    let options = Options {
        defines: args.define.clone(),
        allow_paths: args.allow_path.clone(),
        spectrum_rule: args.spectral_to_rgb.rule(),
        lenient: args.lenient,
        ..Options::default()
    };
    let conversion = Conversion::read(&args.input, &options)?;
    if !conversion.warnings().is_empty() {
        report::line(conversion.warnings());
    }
    let converted = conversion.write(&args.output, args.force, args.report.as_deref())?;
    for loss in &converted.losses {
        report::line(&describe(loss));
    }
    if let Some(path) = &args.report {
        converted.write_report(path)?;
    }
    report::line(&summary(&converted));
    let ours = if args.check { check::run(args)? } else { 0 };
    let theirs = args.check_with.map_or(Ok(0), |renderer| outside::run(args, renderer))?;
    Ok(ours.max(theirs))
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

fn summary(converted: &Converted) -> String {
    let plural = |n: usize, one: &str, many: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{n} {many}"),
    };
    format!(
        "{}: {}, {} beside it, {}",
        converted.path.display(),
        plural(converted.shapes, "shape", "shapes"),
        plural(converted.files, "file", "files"),
        plural(converted.losses.len(), "loss", "losses"),
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
