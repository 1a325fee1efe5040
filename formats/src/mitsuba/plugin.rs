//! Plugin tables: one row per name, with its reader or its status.

use super::object::Object;
use crate::diagnostic::{Diagnostic, nearest};

/// A row of a concept's table.
pub(super) struct Plugin<F> {
    pub name: &'static str,
    pub status: Status<F>,
}

#[derive(Clone, Copy)]
pub(super) enum Status<F> {
    Read(F),
    /// Part of some Mitsuba, not rendered by us. What would do instead, or nothing.
    Unsupported(&'static str),
}

pub(super) const fn read<F: Copy>(name: &'static str, reader: F) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader) }
}

pub(super) const fn unsupported<F: Copy>(name: &'static str) -> Plugin<F> {
    unsupported_but(name, "")
}

/// With advice to the author.
pub(super) const fn unsupported_but<F: Copy>(name: &'static str, advice: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Unsupported(advice) }
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
