//! Directives of the current transform.

use super::directive::{Directive, Value};
use super::reader::{Reader, text};
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::Transform;

impl Reader<'_> {
    pub fn transform(&mut self, d: &Directive) {
        let Value::Numbers(v) = &d.arguments[0].value else { return };
        if v.iter().any(|x| !x.is_finite()) {
            return self.error(format!("{} holds a number that is too large", d.name), d.span);
        }
        // Files list matrices by columns.
        let matrix = || Transform(std::array::from_fn(|row| std::array::from_fn(|c| v[c * 4 + row])));
        let (m, inverse) = match d.name.as_str() {
            "Translate" => {
                let by = [v[0], v[1], v[2]];
                (Transform::translate(by), Some(Transform::translate(by.map(|x| -x))))
            }
            "Scale" => {
                let by = [v[0], v[1], v[2]];
                let back = by.iter().all(|x| *x != 0.0).then(|| Transform::scale(by.map(|x| 1.0 / x)));
                (Transform::scale(by), back)
            }
            "Rotate" => match Transform::rotate([v[1], v[2], v[3]], v[0]) {
                Some(m) => (m, Transform::rotate([v[1], v[2], v[3]], -v[0])),
                None => return self.error("the axis of Rotate is zero", d.span),
            },
            "LookAt" => match look_at(v) {
                Some((to_camera, to_world)) => (to_camera, Some(to_world)),
                None => {
                    let text =
                        "LookAt has no direction: eye and target are the same, or `up` is parallel to it";
                    return self.error(text, d.span);
                }
            },
            "Transform" => return self.state.set(&[matrix(); 2]),
            _ => {
                let m = matrix();
                (m, m.inverse())
            }
        };
        self.state.concat(&m, inverse);
    }

    pub fn restore_system(&mut self, d: &Directive) {
        let name = text(d, 0);
        match self.systems.get(name) {
            // Only the active transforms, as every other transform directive.
            Some(ctm) => self.state.set(ctm),
            None => {
                let text = format!("no coordinate system named `{name}`; the transform is unchanged");
                let problem = Diagnostic::warning(text, Some(d.arguments[0].span));
                self.problems.push(problem.suggest(name, self.systems.keys().map(String::as_str)));
            }
        }
    }

    pub fn activate(&mut self, d: &Directive) {
        let Value::Word(word) = &d.arguments[0].value else { return };
        self.state.active = match word.as_str() {
            "All" => [true, true],
            "StartTime" => [true, false],
            "EndTime" => [false, true],
            _ => {
                let text = format!("ActiveTransform takes All, StartTime or EndTime, not `{word}`");
                return self.error(text, d.arguments[0].span);
            }
        };
    }

    /// Motion is not rendered: the first transform is used.
    pub fn report_moving(&mut self, what: &str, span: Span) {
        if self.state.moves() && !self.warned_moving {
            self.warned_moving = true;
            let text = format!("{what} moves: the scene is rendered as it is at the start time");
            self.warn(text, span);
        }
    }
}

/// World → camera, and back. The same columns as Mitsuba's, but +X is on the right of the picture.
fn look_at(v: &[f64]) -> Option<(Transform, Transform)> {
    let to_world = Transform::look_at([v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]])?;
    Some((to_world.inverse()?, to_world))
}
