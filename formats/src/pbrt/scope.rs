//! WorldBegin, and scopes of the graphics state.

use std::rc::Rc;

use super::reader::Reader;
use super::state::{Graphics, Saved, Scope};
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
        // Names of pbrt-v4 are the same everywhere.
        let names = self.policy.is_three().then(|| Rc::clone(&self.names));
        self.saved.push(Saved { scope, graphics: self.state.clone(), names, span });
    }

    pub fn close(&mut self, scope: Scope, span: Span) {
        let (end, begin) = match scope {
            Scope::Attribute => ("AttributeEnd", "AttributeBegin"),
            Scope::Transform => ("TransformEnd", "TransformBegin"),
            Scope::Object => ("ObjectEnd", "ObjectBegin"),
        };
        match self.saved.pop() {
            Some(saved) if saved.scope == Scope::Transform && scope == Scope::Transform => {
                let Graphics { ctm, inverse, active, .. } = saved.graphics;
                (self.state.ctm, self.state.inverse, self.state.active) = (ctm, inverse, active);
            }
            Some(saved) if saved.scope == scope => self.restore(saved),
            Some(saved) => {
                let problem = Diagnostic::error(format!("{end} does not match the open block"), Some(span));
                self.problems.push(problem.label(saved.span, "this is still open"));
                self.restore(saved);
            }
            None if scope == Scope::Object => self.error(format!("{end} without {begin}"), span),
            None => self.warn(format!("{end} without {begin}: it is ignored"), span),
        }
    }

    fn restore(&mut self, saved: Saved) {
        self.state = saved.graphics;
        if let Some(names) = saved.names {
            self.names = names;
        }
    }

    /// Reports what is still open at the end of the scene.
    pub fn close_all(&mut self) {
        while let Some(saved) = self.saved.pop() {
            let (begin, end) = match saved.scope {
                Scope::Attribute => ("AttributeBegin", "AttributeEnd"),
                Scope::Transform => ("TransformBegin", "TransformEnd"),
                Scope::Object => ("ObjectBegin", "ObjectEnd"),
            };
            let text = format!("{begin} has no {end}");
            // Nothing follows that the end would change.
            match saved.scope {
                Scope::Object => self.error(text, saved.span),
                _ => self.warn(format!("{text}: it ends with the scene"), saved.span),
            }
        }
    }
}
