//! The files and the text that a run leaves.

use super::args::CompareArgs;
use super::error::CompareError;
use super::github;
use super::junit::{self, Suite};
use super::page::Page;
use super::report::{Failure, Report, Status};
use super::table::{shown, write_rows, write_table, write_updates};
use caustica_formats::image::atomic_write;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Writes the files that the arguments ask for. What cannot be written becomes a failure of the report.
pub fn write_files(args: &CompareArgs, page: Option<&Page>, report: &mut Report, took: Duration) {
    let write = |path: &Path, text: &str, report: &mut Report| {
        if let Err(source) = atomic_write(path, text.as_bytes()) {
            let error = CompareError::Io { path: path.to_path_buf(), source };
            report.failures.push(Failure::new("", &args.image, &args.reference, &error));
            report.status = Status::CouldNotCompare.code();
        }
    };
    if let (Some(page), Some(path)) = (page, &args.html) {
        write(path, &page.render(report), report);
    }
    if let Some(Some(path)) = &args.json {
        write(path, &to_json(report), report);
    }
    if let Some(path) = &args.junit {
        let mut table = Vec::new();
        write_text(args, report, &mut table).expect("writing to memory cannot fail");
        let suite = Suite {
            name: &args.reference.to_string_lossy(),
            output: &String::from_utf8_lossy(&table),
            began: SystemTime::now() - took,
            seconds: took.as_secs_f64(),
        };
        write(path, &junit::render(report, &suite), report);
    }
}

/// Prints the table or the JSON, and annotations: those beside JSON go to stderr, which GitHub reads as well.
pub fn print(args: &CompareArgs, report: &Report, out: &mut dyn Write) -> io::Result<()> {
    let json = args.json == Some(None);
    if json {
        writeln!(out, "{}", to_json(report))?;
    } else {
        write_text(args, report, out)?;
    }
    if args.github {
        let text = github::annotations(report, repository().as_deref());
        if json { io::stderr().write_all(text.as_bytes())? } else { out.write_all(text.as_bytes())? }
    }
    Ok(())
}

/// Where the runner has put the repository, or the current folder.
fn repository() -> Option<PathBuf> {
    let given = std::env::var_os("GITHUB_WORKSPACE").filter(|folder| !folder.is_empty());
    given.map(PathBuf::from).or_else(|| std::env::current_dir().ok())
}

fn to_json(report: &Report) -> String {
    serde_json::to_string_pretty(report).expect("a report holds only numbers and strings")
}

fn write_text(args: &CompareArgs, report: &Report, out: &mut dyn Write) -> io::Result<()> {
    if args.is_folders() {
        write_rows(&report.comparisons, out)?;
    } else {
        report.comparisons.iter().try_for_each(|c| write_table(c, out))?;
    }
    for failure in &report.failures {
        writeln!(out, "could not compare: {}", shown(&failure.error))?;
    }
    for extra in &report.unmatched {
        writeln!(out, "no reference for {}", shown(&extra.image))?;
    }
    write_updates(&report.updates, out)
}
