//! JUnit XML, as continuous integration reads it: one suite, one case for each picture.
//!
//! Valid for the schema of Jenkins (`junit-10.xsd`) and that of Apache Ant's reports. Neither has properties of
//! cases, so the metrics are properties of the suite, named `PICTURE.METRIC`.

use super::check::exceeded;
use super::comparison::Comparison;
use super::report::Report;
use super::table::check_line;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use std::io;
use std::time::{Duration, SystemTime};

/// What the file says besides the report.
#[derive(Debug)]
pub struct Suite<'a> {
    /// Name of the suite: the reference, or the folder of references.
    pub name: &'a str,
    /// What was printed.
    pub output: &'a str,
    /// When the run began.
    pub began: SystemTime,
    /// How long it took.
    pub seconds: f64,
}

/// How a case ends.
enum Verdict {
    Passed,
    /// A threshold does not hold.
    Failure {
        message: String,
        text: String,
    },
    /// The picture could not be compared.
    Error {
        kind: &'static str,
        message: String,
    },
    /// There is nothing to compare with.
    Skipped {
        message: String,
    },
}

struct Case<'a> {
    name: &'a str,
    seconds: f64,
    verdict: Verdict,
}

/// The file.
pub fn render(report: &Report, suite: &Suite<'_>) -> String {
    let mut out = Writer::new_with_indent(Vec::new(), b' ', 2);
    write(&mut out, report, suite).expect("writing to memory cannot fail");
    let mut text = String::from_utf8(out.into_inner()).expect("text was written");
    text.push('\n');
    text
}

type Out = Writer<Vec<u8>>;

fn write(out: &mut Out, report: &Report, suite: &Suite<'_>) -> io::Result<()> {
    let cases = cases(report);
    let count = |is: fn(&Verdict) -> bool| cases.iter().filter(|c| is(&c.verdict)).count().to_string();
    let name = non_empty(suite.name);
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    open(out, "testsuites", &[])?;
    let attributes = [
        ("name", name.as_str()),
        ("package", "caustica.compare"),
        ("id", "0"),
        ("hostname", "localhost"),
        ("timestamp", &timestamp(suite.began)),
        ("tests", &cases.len().to_string()),
        ("failures", &count(|v| matches!(v, Verdict::Failure { .. }))),
        ("errors", &count(|v| matches!(v, Verdict::Error { .. }))),
        ("skipped", &count(|v| matches!(v, Verdict::Skipped { .. }))),
        ("time", &time(suite.seconds)),
    ];
    open(out, "testsuite", &attributes)?;
    open(out, "properties", &[])?;
    for comparison in &report.comparisons {
        for (metric, value) in metrics(comparison) {
            let name = format!("{}.{metric}", comparison.name);
            empty(out, "property", &[("name", &name), ("value", &value)])?;
        }
    }
    close(out, "properties")?;
    cases.iter().try_for_each(|case| write_case(out, case, &name))?;
    element(out, "system-out", &[], suite.output)?;
    element(out, "system-err", &[], "")?;
    close(out, "testsuite")?;
    close(out, "testsuites")
}

fn write_case(out: &mut Out, case: &Case<'_>, suite: &str) -> io::Result<()> {
    let name = non_empty(case.name);
    let attributes = [("classname", suite), ("name", name.as_str()), ("time", &time(case.seconds))];
    if matches!(case.verdict, Verdict::Passed) {
        return empty(out, "testcase", &attributes);
    }
    open(out, "testcase", &attributes)?;
    match &case.verdict {
        Verdict::Passed => {}
        Verdict::Failure { message, text } => {
            element(out, "failure", &[("type", "threshold"), ("message", message)], text)?;
        }
        Verdict::Error { kind, message } => {
            element(out, "error", &[("type", kind), ("message", message)], message)?;
        }
        Verdict::Skipped { message } => empty(out, "skipped", &[("message", message)])?,
    }
    close(out, "testcase")
}

/// All pictures: those compared, those that could not be, and those without a reference.
fn cases(report: &Report) -> Vec<Case<'_>> {
    let compared = report.comparisons.iter().map(|c| {
        let lines = || c.checks.iter().map(check_line).collect::<Vec<_>>().join("\n");
        let failure = || Verdict::Failure { message: exceeded(&c.checks), text: lines() };
        let verdict = if report.passes(c) { Verdict::Passed } else { failure() };
        Case { name: &c.name, seconds: c.seconds, verdict }
    });
    let failed = report.failures.iter().map(|f| {
        let kind = if f.missing { "missing" } else { "not-compared" };
        let verdict = Verdict::Error { kind, message: f.error.clone() };
        Case { name: &f.name, seconds: f.seconds, verdict }
    });
    let extra = report.unmatched.iter().map(|e| {
        let verdict = Verdict::Skipped { message: format!("no reference for {}", e.image) };
        Case { name: &e.name, seconds: 0.0, verdict }
    });
    compared.chain(failed).chain(extra).collect()
}

fn metrics(c: &Comparison) -> Vec<(&'static str, String)> {
    let mut all = vec![
        ("size", format!("{}x{}", c.width, c.height)),
        ("bias", c.bias.absolute_all.to_string()),
        ("relative-bias", c.bias.relative_all.to_string()),
        ("rmse", c.errors.rmse_all.to_string()),
        ("relmse", c.errors.relmse.to_string()),
        ("mape", c.errors.mape.to_string()),
        ("flip", c.flip_ldr.stats.mean.to_string()),
    ];
    all.extend(c.errors.psnr.map(|psnr| ("psnr", psnr.to_string())));
    all.extend(c.flip_hdr.as_ref().map(|hdr| ("hdr-flip", hdr.stats.mean.to_string())));
    all.extend(c.z_test.as_ref().map(|z| ("z-test", z.accepted_share.to_string())));
    all
}

fn open(out: &mut Out, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    out.write_event(Event::Start(start(name, attributes)))
}

fn empty(out: &mut Out, name: &str, attributes: &[(&str, &str)]) -> io::Result<()> {
    out.write_event(Event::Empty(start(name, attributes)))
}

fn close(out: &mut Out, name: &str) -> io::Result<()> {
    out.write_event(Event::End(BytesEnd::new(name)))
}

fn element(out: &mut Out, name: &str, attributes: &[(&str, &str)], text: &str) -> io::Result<()> {
    open(out, name, attributes)?;
    out.write_event(Event::Text(BytesText::new(&sayable(text))))?;
    close(out, name)
}

fn start<'a>(name: &'a str, attributes: &[(&str, &str)]) -> BytesStart<'a> {
    let mut start = BytesStart::new(name);
    for (name, value) in attributes {
        // Readers make blanks of the line ends and tabs of attributes.
        let value = sayable(value).replace(['\n', '\r', '\t'], " ");
        start.push_attribute((*name, value.as_str()));
    }
    start
}

/// XML 1.0 has no way to write control characters other than line ends and tabs, nor U+FFFE and U+FFFF.
fn sayable(text: &str) -> String {
    let allowed = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{FFFD}' | '\u{10000}'..);
    text.chars().map(|c| if allowed(c) { c } else { char::REPLACEMENT_CHARACTER }).collect()
}

/// Names must not be empty.
fn non_empty(name: &str) -> String {
    if name.trim().is_empty() { "compare".to_owned() } else { name.to_owned() }
}

/// Seconds with three digits, as Jenkins's schema demands.
fn time(seconds: f64) -> String {
    format!("{seconds:.3}")
}

/// ISO 8601 in UTC without a zone, as Ant's schema demands.
fn timestamp(at: SystemTime) -> String {
    let seconds = at.duration_since(SystemTime::UNIX_EPOCH).unwrap_or(Duration::ZERO).as_secs();
    let [year, month, day] = date(seconds / 86_400);
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}")
}

/// Year, month and day of the Gregorian calendar, from days since 1 January 1970.
fn date(days: u64) -> [u64; 3] {
    let leap = |year: u64| (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    let (mut year, mut rest) = (1970, days);
    while rest >= 365 + u64::from(leap(year)) {
        rest -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while rest >= lengths[month] {
        rest -= lengths[month];
        month += 1;
    }
    [year, month as u64 + 1, rest + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_of_the_calendar() {
        let at = |seconds| timestamp(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01T00:00:00");
        // The last second of a leap day in a year that 400 divides, and the first one after it.
        assert_eq!(at(951_868_799), "2000-02-29T23:59:59");
        assert_eq!(at(951_868_800), "2000-03-01T00:00:00");
        assert_eq!(at(1_798_761_599), "2026-12-31T23:59:59");
    }

    #[test]
    fn characters_that_xml_cannot_hold_are_replaced() {
        assert_eq!(sayable("a\u{1}b\u{1b}[31m\n\u{FFFF}é😀"), "a\u{FFFD}b\u{FFFD}[31m\n\u{FFFD}é😀");
    }
}
