//! Annotations of a GitHub workflow: commands that the runner reads from the output of a step.

use super::check::exceeded;
use super::report::Report;
use std::fmt::Write;
use std::path::Path;

/// One line for each picture that does not hold, that could not be compared, or that has no reference. The files are
/// named relative to `root`, the folder of the repository: the reference, which is in the repository, where there is
/// one. GitHub shows the first ten errors and the first ten warnings of a step.
pub fn annotations(report: &Report, root: Option<&Path>) -> String {
    let mut out = String::new();
    let mut say = |level: &str, file: &str, name: &str, message: &str| {
        let (file, title) = (property(&relative(file, root)), property(name));
        let _ = writeln!(out, "::{level} file={file},title={title}::{}", data(message));
    };
    for c in report.comparisons.iter().filter(|c| !report.passes(c)) {
        say(
            "error",
            &c.reference,
            &c.name,
            &format!("{} against {}: {}", c.image, c.reference, exceeded(&c.checks)),
        );
    }
    for failure in &report.failures {
        say("error", &failure.reference, &failure.name, &failure.error);
    }
    for extra in &report.unmatched {
        say("warning", &extra.image, &extra.name, &format!("no reference for {}", extra.image));
    }
    out
}

/// The path within the repository, with `/`; as it is where it lies outside.
fn relative(file: &str, root: Option<&Path>) -> String {
    let inside = || {
        let absolute = std::path::absolute(file).ok()?;
        Some(absolute.strip_prefix(root?).ok()?.to_string_lossy().into_owned())
    };
    let path = inside().unwrap_or_else(|| file.trim_start_matches("./").to_owned());
    if cfg!(windows) { path.replace('\\', "/") } else { path }
}

fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::report::{Extra, Failure};

    #[test]
    fn commands_are_one_line_each_and_escaped() {
        let failure = Failure {
            name: "50 %, a:b".to_owned(),
            image: "i.exr".to_owned(),
            reference: "/repo/refs/50 %, a:b.exr".to_owned(),
            error: "first line\r\nsecond: 100 %::set".to_owned(),
            missing: false,
            seconds: 0.0,
        };
        let extra = Extra { name: "new".to_owned(), image: "./out/new.exr".to_owned() };
        let report = Report { failures: vec![failure], unmatched: vec![extra], ..Report::default() };
        let root = if cfg!(windows) { None } else { Some(Path::new("/repo")) };
        assert_eq!(
            annotations(&report, root),
            "::error file=refs/50 %25%2C a%3Ab.exr,title=50 %25%2C a%3Ab::first line%0D%0Asecond: 100 %25::set\n\
             ::warning file=out/new.exr,title=new::no reference for ./out/new.exr\n"
        );
    }
}
