//! What becomes of things that are unknown or not supported: the one place that decides between warning and error.
//!
//! What does not change the light is a warning. What changes it is an error, and with `--lenient` a warning
//! that names what is rendered instead.

use super::object::{Class, Object};
use crate::diagnostic::{Diagnostic, Span};

#[derive(Clone, Copy, Debug)]
pub(super) struct Policy {
    pub lenient: bool,
}

/// Whether objects of this class decide about the light; the others say how it is computed and stored.
pub(super) fn changes_light(class: Class) -> bool {
    !matches!(class, Class::Film | Class::Integrator | Class::Rfilter | Class::Sampler)
}

impl Policy {
    /// About an object whose plugin is not read: `what` says why, `instead` what happens then.
    pub fn plugin(self, object: &Object, what: &str, instead: &str) -> Diagnostic {
        let harmless = !changes_light(object.class) || !object.used;
        let instead = if object.used { instead } else { "nothing uses it" };
        self.judge_unless(harmless, what, instead, object.span)
    }

    /// A warning about something harmless, and otherwise as [`Self::judge`].
    pub fn judge_unless(self, harmless: bool, what: &str, instead: &str, span: Span) -> Diagnostic {
        if harmless {
            return Diagnostic::warning(format!("{what}: {instead}"), Some(span));
        }
        self.judge(what, instead, span)
    }

    /// About a parameter, or with `nested` an object, that `object` does not take.
    pub fn parameter(self, object: &Object, nested: bool, what: &str, span: Span) -> Diagnostic {
        // Mitsuba 0.6 warns of parameters that nobody asks for; a nested object it refuses.
        let harmless = !changes_light(object.class) || (object.camel_case && !nested);
        if !harmless && !self.lenient {
            return Diagnostic::error(what, Some(span));
        }
        let ignored = if nested { ": it is ignored" } else { " is ignored" };
        let problem = Diagnostic::warning(format!("{what}{ignored}"), Some(span));
        if harmless { problem } else { problem.unsupported() }
    }

    /// About something that changes the light.
    pub fn judge(self, what: &str, instead: &str, span: Span) -> Diagnostic {
        let problem = if self.lenient {
            Diagnostic::warning(format!("{what}: {instead}"), Some(span))
        } else {
            Diagnostic::error(what, Some(span)).help(format!("with --lenient {instead}"))
        };
        problem.unsupported()
    }
}
