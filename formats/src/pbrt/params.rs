//! The parameters of one entity: each must be read, and must have the expected type and count.

use super::directive::{Param, ParamType, Values};
use super::policy::{Policy, of_parameter};
use super::space::ColorSpace;
use crate::diagnostic::{Diagnostic, Span, nearest};
use crate::ir::Origin;

use ParamType as T;

/// What becomes of a parameter of the wrong type or count.
const UNUSED: &str = "it counts as not given";

#[derive(Clone, Debug)]
struct Slot {
    param: Param,
    /// Written here, not by an `Attribute` before.
    own: bool,
    read: bool,
}

/// What stands behind `Shape "sphere"` and the like.
#[derive(Clone, Debug)]
pub(super) struct Params {
    /// `shape`, `material`, …
    pub class: &'static str,
    /// `sphere`, `diffuse`, …
    pub kind: String,
    /// Of the kind.
    pub span: Span,
    pub space: ColorSpace,
    pub policy: Policy,
    pub problems: Vec<Diagnostic>,
    slots: Vec<Slot>,
    asked: Vec<&'static str>,
    /// Nothing more is to be said about parameters nobody read.
    ignore_rest: bool,
}

impl Params {
    pub fn new(
        class: &'static str,
        kind: &str,
        span: Span,
        own: Vec<Param>,
        (space, policy): (ColorSpace, Policy),
    ) -> Self {
        let slots = own.into_iter().map(|param| Slot { param, own: true, read: false }).collect();
        Self {
            class,
            kind: kind.to_owned(),
            span,
            space,
            policy,
            problems: Vec::new(),
            slots,
            asked: Vec::new(),
            ignore_rest: false,
        }
    }

    /// Adds defaults that an `Attribute` gave; the entity's own parameters win.
    pub fn inherit(&mut self, params: &[Param]) {
        let inherited = params.iter().map(|p| Slot { param: p.clone(), own: false, read: false });
        self.slots.splice(0..0, inherited);
    }

    /// Puts parameters in place of those of the same names.
    pub fn change(&mut self, params: Vec<Param>) {
        self.slots.retain(|slot| params.iter().all(|p| p.name != slot.param.name));
        self.slots.extend(params.into_iter().map(|param| Slot { param, own: true, read: false }));
    }

    /// Takes out what nobody read and has one of these names.
    pub fn take_unread(&mut self, names: &[&str]) -> Vec<Param> {
        let wanted = |slot: &Slot| slot.own && !slot.read && names.contains(&slot.param.name.as_str());
        let unread = self.slots.extract_if(.., |slot| wanted(slot));
        unread.map(|slot| slot.param).collect()
    }

    pub fn origin(&self) -> Origin {
        Origin(Some(self.span))
    }

    /// `shape "sphere"`, for messages.
    pub fn what(&self) -> String {
        format!("{} `{}`", self.class, self.kind)
    }

    pub fn has(&self, name: &str) -> bool {
        self.slots.iter().any(|slot| slot.param.name == name)
    }

    /// Where `name` is given, or the entity.
    pub fn span_of(&self, name: &str) -> Span {
        let found = self.slots.iter().rev().find(|slot| slot.param.name == name);
        found.map_or(self.span, |slot| slot.param.span)
    }

    /// An error about parameter `name`.
    pub fn complain(&mut self, name: &str, text: impl Into<String>) {
        let span = self.span_of(name);
        self.problems.push(Diagnostic::error(text, Some(span)));
    }

    pub fn warn(&mut self, name: &str, text: impl Into<String>) {
        let span = self.span_of(name);
        self.problems.push(Diagnostic::warning(text, Some(span)));
    }

    /// Nothing depends on these.
    pub fn ignore(&mut self, names: &[&'static str]) {
        for name in names {
            self.mark(name);
        }
    }

    /// [`Self::ignore`], saying what that means where one is given.
    pub fn ignore_with_warning(&mut self, name: &'static str, consequence: &str) {
        self.mark(name);
        if self.has(name) {
            self.warn(name, format!("`{name}` of {} is ignored: {consequence}", self.what()));
        }
    }

    pub fn ignore_rest(&mut self) {
        self.ignore_rest = true;
    }

    fn mark(&mut self, name: &'static str) {
        self.asked.push(name);
        self.slots.iter_mut().filter(|slot| slot.param.name == name).for_each(|slot| slot.read = true);
    }

    /// The type under which `name` is given.
    pub fn type_of(&self, name: &str) -> Option<ParamType> {
        self.slots.iter().rev().find(|slot| slot.param.name == name).map(|slot| slot.param.kind)
    }

    /// Takes `name`, which must have one of `types`. Of several the last one is used.
    pub fn take(&mut self, name: &'static str, types: &[ParamType]) -> Option<Param> {
        self.mark(name);
        // As pbrt, which looks for a name and a type.
        let named = |slot: &Slot| slot.param.name == name;
        let index = self
            .slots
            .iter()
            .rposition(|slot| named(slot) && types.contains(&slot.param.kind))
            .or_else(|| self.slots.iter().rposition(named))?;
        let earlier = self.slots[..index].iter().rfind(|slot| slot.own && slot.param.name == name);
        if let Some(earlier) = earlier {
            let text = format!("`{name}` is given again below; this one is ignored");
            let problem = Diagnostic::warning(text, Some(earlier.param.span));
            self.problems.push(problem.label(self.slots[index].param.span, "this one counts"));
        }
        let slot = &mut self.slots[index];
        let param = Param {
            values: std::mem::replace(&mut slot.param.values, Values::Broken),
            name: String::new(),
            ..slot.param
        };
        if param.values == Values::Broken {
            return None;
        }
        if types.contains(&param.kind) {
            return Some(param);
        }
        let wanted: Vec<&str> = types.iter().map(|kind| kind.keyword()).collect();
        let (what, found) = (self.what(), param.kind.keyword());
        let text = format!("`{name}` of {what} has type {}, not {found}", wanted.join(" or "));
        self.problems.push(self.policy.report(of_parameter(self.class), &text, param.span, UNUSED));
        None
    }

    /// Reports any count but `count`.
    fn counted(&mut self, name: &str, param: &Param, count: usize) -> Option<()> {
        let got = param.values.len();
        if got == count {
            return Some(());
        }
        let values = if count == 1 { "value" } else { "values" };
        let text = format!("`{name}` expects {count} {values}, got {got}");
        self.problems.push(self.policy.report(of_parameter(self.class), &text, param.value_span, UNUSED));
        None
    }

    fn numbers(&mut self, name: &'static str, types: &[ParamType], count: usize) -> Option<Vec<f64>> {
        let param = self.take(name, types)?;
        self.counted(name, &param, count)?;
        match param.values {
            Values::Floats(values) => Some(values),
            Values::Integers(values) => Some(values.into_iter().map(f64::from).collect()),
            Values::Mesh(values) => Some(values.into_iter().map(f64::from).collect()),
            _ => None,
        }
    }

    pub fn optional_float(&mut self, name: &'static str) -> Option<f64> {
        self.numbers(name, &[T::Float], 1).map(|v| v[0])
    }

    pub fn float(&mut self, name: &'static str, default: f64) -> f64 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A float above zero.
    pub fn positive(&mut self, name: &'static str, default: f64) -> f64 {
        let value = self.float(name, default);
        if value > 0.0 {
            return value;
        }
        self.complain(name, format!("`{name}` must be positive, not {value}"));
        default
    }

    pub fn optional_integer(&mut self, name: &'static str) -> Option<i32> {
        self.numbers(name, &[T::Integer], 1).map(|v| v[0] as i32)
    }

    /// A whole number in `least..`.
    pub fn count(&mut self, name: &'static str, default: u32, least: u32) -> u32 {
        match self.optional_integer(name) {
            None => default,
            Some(value) => u32::try_from(value).ok().filter(|v| *v >= least).unwrap_or_else(|| {
                self.complain(name, format!("`{name}` must be at least {least}, not {value}"));
                default
            }),
        }
    }

    pub fn boolean(&mut self, name: &'static str, default: bool) -> bool {
        let Some(param) = self.take(name, &[T::Bool]) else { return default };
        match (self.counted(name, &param, 1), param.values) {
            (Some(()), Values::Bools(values)) => values[0],
            _ => default,
        }
    }

    pub fn optional_string(&mut self, name: &'static str) -> Option<(String, Span)> {
        self.text(name, &[T::String])
    }

    /// A single string of one of `types`.
    pub fn text(&mut self, name: &'static str, types: &[ParamType]) -> Option<(String, Span)> {
        let param = self.take(name, types)?;
        self.counted(name, &param, 1)?;
        match param.values {
            Values::Texts(mut values) => Some((values.pop()?, param.value_span)),
            _ => None,
        }
    }

    /// One of `choices` by name.
    pub fn choice<V: Copy>(&mut self, name: &'static str, default: V, choices: &[(&str, V)]) -> V {
        let Some((text, span)) = self.optional_string(name) else { return default };
        if let Some((_, value)) = choices.iter().find(|(known, _)| *known == text) {
            return *value;
        }
        let known: Vec<&str> = choices.iter().map(|(known, _)| *known).collect();
        let problem = Diagnostic::error(format!("`{text}` is not a value of `{name}`"), Some(span));
        self.problems.push(
            problem.suggest_or(&text, known.iter().copied(), || format!("it takes: {}", known.join(", "))),
        );
        default
    }

    pub fn triple(&mut self, name: &'static str, kind: ParamType) -> Option<[f64; 3]> {
        self.numbers(name, &[kind], 3).map(|v| [v[0], v[1], v[2]])
    }

    /// Exactly `N` floats.
    pub fn floats<const N: usize>(&mut self, name: &'static str) -> Option<[f64; N]> {
        self.numbers(name, &[T::Float], N)?.try_into().ok()
    }

    /// As [`Self::floats`], where pbrt goes on without them if they are not `N`.
    pub fn floats_or_warn<const N: usize>(&mut self, name: &'static str) -> Option<[f64; N]> {
        let slot = self.slots.iter().rfind(|slot| slot.param.name == name)?;
        let got = slot.param.values.len();
        if got == N || slot.param.values == Values::Broken {
            return self.floats(name);
        }
        self.mark(name);
        self.warn(name, format!("`{name}` expects {N} values, got {got}: {UNUSED}"));
        None
    }

    /// Exactly `N` integers.
    pub fn integers<const N: usize>(&mut self, name: &'static str) -> Option<[i32; N]> {
        let values = self.numbers(name, &[T::Integer], N)?;
        Vec::into_iter(values).map(|v| v as i32).collect::<Vec<_>>().try_into().ok()
    }

    /// A list of whole numbers of any length.
    pub fn integer_list(&mut self, name: &'static str) -> Option<Vec<i32>> {
        match self.take(name, &[T::Integer])?.values {
            Values::Integers(values) => Some(values),
            _ => None,
        }
    }

    /// A list of numbers of any length.
    pub fn number_list(&mut self, name: &'static str, kind: ParamType) -> Option<Vec<f32>> {
        match self.take(name, &[kind])?.values {
            Values::Floats(values) => Some(values.into_iter().map(|v| v as f32).collect()),
            _ => None,
        }
    }

    /// A list of points of `N` coordinates each.
    pub fn points<const N: usize>(&mut self, name: &'static str, kind: ParamType) -> Option<Vec<[f32; N]>> {
        let param = self.take(name, &[kind])?;
        if param.values.len() % N != 0 {
            let text = format!("`{name}` expects {N} values a point, but has {}", param.values.len());
            self.problems.push(Diagnostic::error(text, Some(param.value_span)));
            return None;
        }
        let points = match param.values {
            Values::Mesh(values) => values.as_chunks::<N>().0.to_vec(),
            Values::Floats(values) => {
                let chunks = values.as_chunks::<N>().0.iter();
                chunks.map(|p| p.map(|x| x as f32)).collect()
            }
            _ => return None,
        };
        if points.iter().flatten().any(|x: &f32| !x.is_finite()) {
            let text = format!("`{name}` holds a number that is too large");
            self.problems.push(Diagnostic::error(text, Some(param.value_span)));
            return None;
        }
        Some(points)
    }

    pub fn string_list(&mut self, name: &'static str) -> Option<(Vec<String>, Span)> {
        let param = self.take(name, &[T::String])?;
        match param.values {
            Values::Texts(values) => Some((values, param.value_span)),
            _ => None,
        }
    }

    /// Everything that is still to be said, with the parameters nobody read.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        if self.ignore_rest {
            return self.problems;
        }
        let what = self.what();
        for slot in self.slots.iter().filter(|slot| slot.own && !slot.read) {
            let name = &slot.param.name;
            let text = format!("{what} takes no parameter `{name}`");
            let problem =
                self.policy.report(of_parameter(self.class), &text, slot.param.span, "it is ignored");
            self.problems.push(match nearest(name, self.asked.iter().copied()) {
                Some(known) => problem.help(format!("did you mean `{known}`?")),
                None if self.asked.is_empty() => problem.help("it takes none"),
                None => {
                    let mut names: Vec<&str> = self.asked.clone();
                    names.dedup();
                    problem.help(format!("it takes: {}", names.join(", ")))
                }
            });
        }
        self.problems
    }
}
