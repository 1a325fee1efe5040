//! pbrt-v3 to v4: the names of a v3 scene become those of v4. What v4 has no words for is left to the readers, which
//! know the version of the scene.

mod table;

use std::collections::HashSet;

use super::directive::{Directive, Param, ParamType, Value, Values};
use super::policy::{Fault, Policy, Version};
use crate::diagnostic::{Diagnostic, Severity, Span};
use table::{Change, Row};

/// Something of one version only, and where it stands first.
#[derive(Debug)]
struct Mark {
    what: String,
    span: Span,
}

/// What pbrt-v3 forgives and v4 does not.
#[derive(Debug)]
struct Slip {
    problem: Diagnostic,
    /// What happens; empty where pbrt-v3 is silent.
    instead: String,
}

/// Collects what tells the version of a scene, and what depends on it while files are read.
#[derive(Debug, Default)]
pub(super) struct Old {
    /// Of pbrt-v3 and before.
    three: Vec<Mark>,
    known: HashSet<String>,
    /// Of pbrt-v4.
    four: Vec<Mark>,
    /// Whether materials or directives are of pbrt-v4, of which pbrt-v3 would make another picture.
    surely_four: bool,
    slips: Vec<Slip>,
    losses: Vec<Diagnostic>,
}

/// Type keywords of pbrt-v3.
const TYPES: &[(&str, ParamType)] = &[
    ("point", ParamType::Point3),
    ("vector", ParamType::Vector3),
    ("color", ParamType::Rgb),
    ("xyz", ParamType::Xyz),
];

impl Old {
    /// Records something that only pbrt-v3 and older versions have.
    pub fn found(&mut self, span: Span, what: &str) {
        if self.known.insert(what.to_owned()) {
            self.three.push(Mark { what: what.to_owned(), span });
        }
    }

    /// Records a mistake that pbrt-v4 stops at, and what older versions do (nothing to say where they are silent).
    pub fn slip(&mut self, span: Span, text: impl Into<String>, instead: impl Into<String>) {
        self.slipped(Diagnostic::error(text, Some(span)), instead);
    }

    /// As [`Self::slip`].
    pub fn slipped(&mut self, problem: Diagnostic, instead: impl Into<String>) {
        self.slips.push(Slip { problem, instead: instead.into() });
    }

    /// The type an old keyword stands for.
    pub fn param_type(&mut self, keyword: &str, span: Span) -> Option<ParamType> {
        let kind = TYPES.iter().find(|row| row.0 == keyword)?.1;
        self.found(span, &format!("the parameter type `{keyword}`"));
        Some(kind)
    }

    /// The version of what was read. Samplers, films and integrators are often changed in files that are otherwise of
    /// another version: they count for v4 only where not more is of v3.
    pub fn version(&self) -> Version {
        if self.surely_four || self.three.len() <= self.four.len() { Version::Four } else { Version::Three }
    }

    /// What is to be said now that the version is known.
    pub fn finish(mut self, policy: Policy) -> Vec<Diagnostic> {
        let version = self.version();
        // Parameters were read before the directives around them.
        self.three.sort_by_key(|mark| (mark.span.file, mark.span.start));
        let mut problems = self.losses;
        for Slip { problem, instead } in self.slips {
            if policy.stops(Fault::Mistake) || !instead.is_empty() {
                problems.push(policy.judge(Fault::Mistake, problem, &instead));
            }
        }
        let of_another = |marks: &[Mark], [theirs, ours]: [&str; 2], first: &Mark| -> Vec<Diagnostic> {
            let warn = |mark: &Mark| {
                let text = format!("{} is of pbrt-{theirs}; pbrt-{ours} does not read it", mark.what);
                Diagnostic::warning(text, Some(mark.span))
                    .label(first.span, format!("{} makes this a scene of pbrt-{ours}", first.what))
            };
            marks.iter().map(warn).collect()
        };
        match (version, self.three.first(), self.four.first()) {
            (Version::Three, Some(first), _) => {
                let text = format!(
                    "a scene of pbrt-v3 or before ({}), which is read by the rules of pbrt-v3",
                    first.what
                );
                problems.push(Diagnostic::new(Severity::Note, text, Some(first.span)));
                problems.extend(of_another(&self.four, ["v4", "v3"], first));
            }
            (Version::Four, _, Some(first)) => {
                problems.extend(of_another(&self.three, ["v3", "v4"], first));
            }
            _ => {}
        }
        problems
    }

    fn lost(&mut self, span: Span, text: String) {
        self.losses.push(Diagnostic::warning(text, Some(span)));
    }

    /// Notes what the type of an entity, or the name of a directive, says about the version.
    fn date(&mut self, d: &Directive, class: &str, kind: &str) {
        let has = |table: &[(&str, &[&str])]| {
            table.iter().any(|(of, kinds)| *of == class && (kinds.is_empty() || kinds.contains(&kind)))
        };
        let what = || {
            let class = class.to_ascii_lowercase();
            if kind.is_empty() { format!("`{}`", d.name) } else { format!("{class} `{kind}`") }
        };
        if has(table::ONLY_THREE) {
            self.found(kind_span(d), &what());
        } else if has(table::ONLY_FOUR) {
            self.surely_four |= !matches!(class, "Sampler" | "Film" | "Integrator");
            if self.known.insert(what()) {
                self.four.push(Mark { what: what(), span: kind_span(d) });
            }
        }
    }

    /// Converts a directive to pbrt-v4; `false` when nothing remains of it.
    pub fn directive(&mut self, d: &mut Directive) -> bool {
        match d.name.as_str() {
            "WorldEnd" => {
                self.found(d.span, "`WorldEnd`");
                return false;
            }
            "Renderer" | "VolumeIntegrator" => {
                let what = format!("`{}`", d.name);
                self.found(d.span, &what);
                self.lost(d.span, format!("{what} of older versions is ignored"));
                return false;
            }
            "SurfaceIntegrator" => {
                self.found(d.span, "`SurfaceIntegrator`");
                d.name = "Integrator".to_owned();
            }
            "Texture" => {
                if let Some(kind) = d.arguments.get_mut(1)
                    && kind.value == Value::Text("color".to_owned())
                {
                    self.found(kind.span, "a texture of kind `color`");
                    kind.value = Value::Text("spectrum".to_owned());
                }
            }
            _ => {}
        }
        d.params.iter_mut().for_each(from_xyz);
        for p in d.params.iter().filter(|p| p.kind == ParamType::Blackbody && p.values.len() == 2) {
            self.found(p.value_span, "a blackbody with a scale");
        }
        let class = if d.name == "MakeNamedMaterial" { "Material".to_owned() } else { d.name.clone() };
        let kind = kind(d);
        self.date(d, &class, &kind);
        let general: Vec<&Row> = table::ROWS
            .iter()
            .filter(|row| row.class == class && (row.from.is_empty() || row.from == kind))
            .collect();
        for row in general {
            self.apply(d, row);
        }
        true
    }

    fn apply(&mut self, d: &mut Directive, row: &Row) {
        let place = kind_span(d);
        if row.to != row.from {
            let what = format!("{} `{}`", row.noun, row.from);
            self.found(place, &what);
            set_kind(d, row.to);
            if !row.loss.is_empty() {
                self.lost(place, format!("{what} of pbrt-v3 is approximated by `{}`: {}", row.to, row.loss));
            }
        }
        for (name, change) in row.params {
            let Some(index) = d.params.iter().rposition(|p| p.name == *name) else { continue };
            if !change.concerns(&d.params[index]) {
                continue;
            }
            let span = d.params[index].span;
            let what = format!("the parameter `{name}` of {}", row.noun);
            self.found(span, &what);
            match change {
                Change::Rename(now) => (*now).clone_into(&mut d.params[index].name),
                Change::Drop => d.params.retain(|p| p.name != *name),
                Change::With(convert) => convert(d, index),
            }
        }
        for (name, values) in row.defaults {
            if d.params.iter().all(|p| p.name != *name) {
                let kind = if values.len() == 3 { ParamType::Rgb } else { ParamType::Float };
                d.params.push(made(kind, name, Values::Floats(values.to_vec()), place));
            }
        }
    }
}

/// The type of an entity.
fn kind(d: &Directive) -> String {
    if d.name == "MakeNamedMaterial" {
        let kind = d.params.iter().rfind(|p| p.name == "type").map(|p| &p.values);
        return match kind {
            Some(Values::Texts(texts)) => texts.first().cloned().unwrap_or_default(),
            _ => String::new(),
        };
    }
    match d.arguments.last().map(|argument| &argument.value) {
        Some(Value::Text(text)) => text.clone(),
        _ => String::new(),
    }
}

fn kind_span(d: &Directive) -> Span {
    if d.name == "MakeNamedMaterial"
        && let Some(param) = d.params.iter().rfind(|p| p.name == "type")
    {
        return param.value_span;
    }
    d.arguments.last().map_or(d.span, |argument| argument.span)
}

fn set_kind(d: &mut Directive, kind: &str) {
    if d.name == "MakeNamedMaterial" {
        if let Some(param) = d.params.iter_mut().rfind(|p| p.name == "type") {
            param.values = Values::Texts(vec![kind.to_owned()]);
        }
    } else if let Some(argument) = d.arguments.last_mut() {
        argument.value = Value::Text(kind.to_owned());
    }
}

fn made(kind: ParamType, name: &str, values: Values, span: Span) -> Param {
    Param { kind, name: name.to_owned(), span, value_span: span, values }
}

/// XYZ → linear Rec.709 (IEC 61966-2-1), negative components cut.
fn from_xyz(p: &mut Param) {
    if p.kind != ParamType::Xyz {
        return;
    }
    p.kind = ParamType::Rgb;
    if let Values::Floats(v) = &mut p.values
        && let [x, y, z] = v[..]
    {
        *v = vec![
            (3.240_97 * x - 1.537_383 * y - 0.498_611 * z).max(0.0),
            (-0.969_244 * x + 1.875_968 * y + 0.041_555 * z).max(0.0),
            (0.055_63 * x - 0.203_977 * y + 1.056_972 * z).max(0.0),
        ];
    }
}
