//! WorldBegin, and scopes of the graphics state.

use super::reader::Reader;
use super::state::{Saved, Scope};
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::Transform;

impl Reader<'_> {
    pub fn world_begin(&mut self, span: Span) {
        if let Some(first) = self.world {
            let problem = Diagnostic::error("a scene may have only one WorldBegin", Some(span));
            self.problems.push(problem.label(first, "the first one"));
            return;
        }
        self.world = Some(span);
        self.state.active = [true; 2];
        self.state.set(&[Transform::IDENTITY; 2]);
        self.systems.insert("world".to_owned(), self.state.ctm);
        self.sensor(span);
        self.integrator();
    }

    /// Begins an object definition, a scope of its own.
    pub fn open_object(&mut self, span: Span) {
        self.open(Scope::Object, span);
    }

    pub fn open(&mut self, scope: Scope, span: Span) {
        self.saved.push(Saved { scope, graphics: self.state.clone(), span });
    }

    pub fn close(&mut self, scope: Scope, span: Span) {
        let (end, begin) = match scope {
            Scope::Attribute => ("AttributeEnd", "AttributeBegin"),
            Scope::Object => ("ObjectEnd", "ObjectBegin"),
        };
        match self.saved.pop() {
            Some(saved) if saved.scope == scope => self.state = saved.graphics,
            Some(saved) => {
                let problem = Diagnostic::error(format!("{end} does not match the open block"), Some(span));
                self.problems.push(problem.label(saved.span, "this is still open"));
                self.state = saved.graphics;
            }
            None => self.error(format!("{end} without {begin}"), span),
        }
    }
}
