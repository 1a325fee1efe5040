//! Mixes of two materials.

use super::color::{Use, linear};
use super::params::Params;
use super::policy::Fault;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{Bsdf, BsdfKind, ColorInput, ColorSlot, FloatInput, Id};

pub(super) fn mix(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    if r.policy.is_three() && !p.has("materials") {
        // It weighs the first, and may do so by colour.
        let weight = r.mix_weight(p);
        let mut part = |name| {
            let (name, span) = p.optional_string(name).unwrap_or_else(|| (String::new(), p.span));
            r.mixed(p, &name, span)
        };
        let [second, first] = ["namedmaterial1", "namedmaterial2"].map(&mut part);
        return Some(BsdfKind::Blend { weight, first: first?, second: second? });
    }
    let weight = r.float_input(p, "amount", 0.5);
    let Some((names, span)) = p.string_list("materials") else {
        if !p.has("materials") {
            p.problems.push(Diagnostic::error("mix needs the parameter \"string materials\"", Some(p.span)));
        }
        return None;
    };
    let [first, second] = &names[..] else {
        p.complain("materials", format!("`materials` expects 2 names, got {}", names.len()));
        return None;
    };
    let first = r.mixed(p, first, span)?;
    let second = r.mixed(p, second, span)?;
    Some(BsdfKind::Blend { weight, first, second })
}

impl Reader<'_> {
    /// A part of a mix; it must be defined before.
    fn mixed(&mut self, p: &mut Params, name: &str, span: Span) -> Option<Id<Bsdf>> {
        if let Some(named) = self.names.materials.get(name).filter(|named| named.defined.is_some()) {
            return Some(named.id);
        }
        if !self.incomplete {
            let known = self.names.materials.iter().filter(|(_, named)| named.defined.is_some());
            let problem =
                Diagnostic::error(format!("no material called `{name}` is defined above"), Some(span));
            let problem = problem.suggest(name, known.map(|(name, _)| name.as_str()));
            p.problems.push(self.policy.judge(Fault::Mistake, problem, "diffuse gray 0.5 is used"));
        }
        Some(self.default_material(p.origin()))
    }

    /// The weight of the first material of a mix of pbrt-v3.
    fn mix_weight(&mut self, p: &mut Params) -> FloatInput {
        let rgb = match self.optional_color_input(p, "amount", Use::Unbounded) {
            None => return FloatInput::Value(0.5),
            Some(ColorInput::Texture(id)) => return FloatInput::Texture(id),
            Some(ColorInput::Color(color)) => linear(&color, ColorSlot::Reflectance).unwrap_or([0.5; 3]),
        };
        let mean = rgb.iter().sum::<f64>() / 3.0;
        if rgb.iter().any(|c| (c - mean).abs() > 1e-3) {
            p.warn("amount", format!("a mix cannot be coloured: the mean of `amount`, {mean:.4}, is used"));
        }
        FloatInput::Value(mean.clamp(0.0, 1.0))
    }
}
