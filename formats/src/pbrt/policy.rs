//! What stops a scene and what is only said about it, by version: the one place that decides.

use crate::diagnostic::{Diagnostic, Severity, Span};

/// The version a scene was written for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Version {
    /// pbrt-v3 or older.
    Three,
    #[default]
    Four,
}

/// What is wrong with something in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// No light depends on it.
    Harmless,
    /// pbrt-v4 stops at it; older versions say so and go on, and so does the reader, in the same way.
    Mistake,
    /// The light depends on it.
    Light,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Policy {
    pub version: Version,
    pub lenient: bool,
}

impl Policy {
    pub fn is_three(self) -> bool {
        self.version == Version::Three
    }

    pub fn stops(self, fault: Fault) -> bool {
        !self.lenient
            && match fault {
                Fault::Harmless => false,
                Fault::Mistake => !self.is_three(),
                Fault::Light => true,
            }
    }

    /// An error, or a warning that says what happens `instead`.
    pub fn report(self, fault: Fault, text: &str, span: Span, instead: &str) -> Diagnostic {
        self.judge(fault, Diagnostic::error(text, Some(span)), instead)
    }

    /// An error as it is, or as a warning that says what happens `instead`.
    pub fn judge(self, fault: Fault, mut problem: Diagnostic, instead: &str) -> Diagnostic {
        if !self.stops(fault) {
            problem.severity = Severity::Warning;
            problem.message = format!("{}: {instead}", problem.message);
        }
        problem
    }
}

/// How bad it is that the type of an entity of this class is not supported.
pub(super) fn of_type(class: &str) -> Fault {
    if is_harmless(class) { Fault::Harmless } else { Fault::Light }
}

/// How bad it is that the type of an entity of this class is not one of pbrt's. pbrt-v3 says so and goes on with
/// its default material, or without the shape, light or medium.
pub(super) fn of_unknown(class: &str) -> Fault {
    if is_harmless(class) { Fault::Harmless } else { Fault::Mistake }
}

/// How bad it is that a parameter of an entity of this class is not known, or not as it should be.
pub(super) fn of_parameter(class: &str) -> Fault {
    if is_harmless(class) { Fault::Harmless } else { Fault::Mistake }
}

/// Classes of entities that no light depends on.
fn is_harmless(class: &str) -> bool {
    matches!(class, "film" | "sampler" | "integrator" | "accelerator" | "filter")
}
