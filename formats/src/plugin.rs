//! Plugin tables, which both scene languages have: one row per name, with its reader or its status.

use crate::diagnostic::{Diagnostic, Severity, Span};

/// How a plugin of a scene language is supported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// Rendered as the language defines it.
    Full,
    /// Rendered as something else; the text says what.
    Approximated(&'static str),
    /// Known, and reported as an error by name.
    Refused,
}

/// A concept of a language (its shapes, its materials) and the plugins it has for it.
#[derive(Clone, Debug)]
pub struct Concept {
    /// Plural, as in "shapes".
    pub name: &'static str,
    /// Plugin names and their support, in the order of the table.
    pub plugins: Vec<(&'static str, Support)>,
}

/// A row of a concept's table.
pub(crate) struct Plugin<F> {
    pub name: &'static str,
    status: Status<F>,
    /// What is rendered instead of it; empty when it is rendered itself.
    instead: &'static str,
}

#[derive(Clone, Copy)]
pub(crate) enum Status<F> {
    Read(F),
    /// Part of some version of the language, but not rendered. What to use instead, or nothing.
    Unsupported(&'static str),
}

pub(crate) const fn read<F: Copy>(name: &'static str, reader: F) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader), instead: "" }
}

/// Read, and rendered as `instead`.
pub(crate) const fn approximated<F: Copy>(name: &'static str, reader: F, instead: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Read(reader), instead }
}

pub(crate) const fn unsupported<F: Copy>(name: &'static str) -> Plugin<F> {
    unsupported_but(name, "")
}

/// With advice to the author.
pub(crate) const fn unsupported_but<F: Copy>(name: &'static str, advice: &'static str) -> Plugin<F> {
    Plugin { name, status: Status::Unsupported(advice), instead: "" }
}

/// The status of a plugin; `None` when the table does not have it.
pub(crate) fn find<F: Copy>(table: &[Plugin<F>], name: &str) -> Option<Status<F>> {
    table.iter().find(|row| row.name == name).map(|row| row.status)
}

/// What is rendered instead of a plugin of the table; `None` when it is rendered itself or not at all.
pub(crate) fn instead<F>(table: &[Plugin<F>], name: &str) -> Option<&'static str> {
    table.iter().find(|row| row.name == name).map(|row| row.instead).filter(|instead| !instead.is_empty())
}

/// The error for a name that no version of the language has; `what` is the likes of "bsdf plugin".
pub(crate) fn unknown<F>(table: &[Plugin<F>], what: &str, name: &str, span: Span) -> Diagnostic {
    suggest(table, name, Diagnostic::error(format!("unknown {what} `{name}`"), Some(span)))
}

/// With the name of the table that was probably meant; an error without one gets all that can be read.
pub(crate) fn suggest<F>(table: &[Plugin<F>], name: &str, problem: Diagnostic) -> Diagnostic {
    let names = table.iter().map(|row| row.name);
    if problem.severity < Severity::Error {
        return problem.suggest(name, names);
    }
    problem.suggest_or(name, names, || {
        let readable = table.iter().filter(|row| matches!(row.status, Status::Read(_)));
        let names: Vec<&str> = readable.map(|row| row.name).filter(|name| !name.is_empty()).collect();
        format!("known: {}", names.join(", "))
    })
}

/// The table for the documentation.
pub(crate) fn concept<F>(name: &'static str, table: &[Plugin<F>]) -> Concept {
    let support = |row: &Plugin<F>| match (&row.status, row.instead) {
        (Status::Read(_), "") => Support::Full,
        (Status::Read(_), instead) => Support::Approximated(instead),
        (Status::Unsupported(_), _) => Support::Refused,
    };
    let plugins = table.iter().filter(|row| !row.name.is_empty());
    Concept { name, plugins: plugins.map(|row| (row.name, support(row))).collect() }
}
