//! Plugin tables: one row per name, with its reader or its status.

use super::object::Object;
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
    /// Part of some Mitsuba, not rendered by us. What would do instead, or nothing.
    Unsupported(&'static str),
}

pub(super) const fn read<F: Copy>(name: &'static str, reader: F) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader), instead: "" }
}

/// Read, and rendered as `instead`.
pub(super) const fn approximated<F: Copy>(name: &'static str, reader: F, instead: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader), instead }
}

pub(super) const fn unsupported<F: Copy>(name: &'static str) -> Plugin<F> {
    unsupported_but(name, "")
}

/// With advice to the author.
pub(super) const fn unsupported_but<F: Copy>(name: &'static str, advice: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Unsupported(advice), instead: "" }
}

/// What the table says about an object.
pub(super) enum Found<F> {
    Reader(F),
    Unsupported(&'static str),
    Unknown,
}

pub(super) fn find<F: Copy>(table: &[Plugin<F>], object: &Object) -> Found<F> {
    match table.iter().find(|row| row.name == object.plugin).map(|row| row.status) {
        Some(Status::Read(reader)) => Found::Reader(reader),
        Some(Status::Unsupported(advice)) => Found::Unsupported(advice),
        None => Found::Unknown,
    }
}

/// The error for a name that no version of Mitsuba has.
pub(super) fn unknown<F>(table: &[Plugin<F>], object: &Object) -> Diagnostic {
    let text = format!("unknown {} plugin `{}`", object.class.name(), object.plugin);
    let problem = Diagnostic::error(text, Some(object.span));
    match nearest(&object.plugin, table.iter().map(|row| row.name)) {
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
