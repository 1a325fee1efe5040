//! Tables of type names: one row per name, with its reader or its status.

use super::params::Params;
use crate::diagnostic::{Diagnostic, nearest};
use crate::support::{Concept, Support};

/// A row of a concept's table.
pub(super) struct Plugin<F> {
    pub name: &'static str,
    pub status: Status<F>,
    /// What is rendered instead of it, or nothing when it is rendered itself.
    pub instead: &'static str,
}

#[derive(Clone, Copy)]
pub(super) enum Status<F> {
    Read(F),
    /// Part of pbrt-v4, or of v3 without a successor; not rendered by us.
    Unsupported,
}

pub(super) const fn read<F: Copy>(name: &'static str, reader: F) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader), instead: "" }
}

/// Read, and rendered as `instead`.
pub(super) const fn approximated<F: Copy>(name: &'static str, reader: F, instead: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader), instead }
}

pub(super) const fn unsupported<F: Copy>(name: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Unsupported, instead: "" }
}

pub(super) fn find<F: Copy>(table: &[Plugin<F>], name: &str) -> Option<Status<F>> {
    table.iter().find(|row| row.name == name).map(|row| row.status)
}

/// The error for a name that pbrt-v4 does not have.
pub(super) fn unknown<F>(table: &[Plugin<F>], params: &Params) -> Diagnostic {
    let text = format!("unknown {} type `{}`", params.class, params.kind);
    let problem = Diagnostic::error(text, Some(params.span));
    match nearest(&params.kind, table.iter().map(|row| row.name)) {
        Some(known) => problem.help(format!("did you mean `{known}`?")),
        None => {
            let readable = table.iter().filter(|row| matches!(row.status, Status::Read(_)));
            let names: Vec<&str> = readable.map(|row| row.name).collect();
            problem.help(format!("known: {}", names.join(", ")))
        }
    }
}

/// What the table says, for people.
pub(super) fn concept<F>(name: &'static str, table: &[Plugin<F>]) -> Concept {
    let support = |row: &Plugin<F>| match (&row.status, row.instead) {
        (Status::Read(_), "") => Support::Full,
        (Status::Read(_), instead) => Support::Approximated(instead),
        _ => Support::Refused,
    };
    let plugins = table.iter().filter(|row| !row.name.is_empty());
    Concept { name, plugins: plugins.map(|row| (row.name, support(row))).collect() }
}
