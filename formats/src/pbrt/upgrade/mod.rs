//! pbrt-v3 to v4: what a v3 scene says becomes what v4 says for it.

mod lights;
mod table;

use std::collections::HashMap;

use super::directive::{Directive, Param, ParamType, Value, Values};
use crate::diagnostic::{Diagnostic, Severity, Span};
use table::{Change, Row};

/// One construct of pbrt-v3 and where it stands.
#[derive(Debug)]
struct Found {
    what: String,
    now: String,
    first: Span,
    more: usize,
}

/// Collects the old constructs of a scene.
#[derive(Debug, Default)]
pub(super) struct Old {
    found: Vec<Found>,
    index: HashMap<String, usize>,
    problems: Vec<Diagnostic>,
    /// Spots with an edge, which are v3's if anything is.
    spots: Vec<Span>,
}

/// In place of the new spelling, where pbrt-v4 has none.
const NOTHING: &str = "no equivalent";

/// Type keywords of pbrt-v3.
const TYPES: &[(&str, ParamType)] = &[
    ("point", ParamType::Point3),
    ("vector", ParamType::Vector3),
    ("color", ParamType::Rgb),
    ("xyz", ParamType::Xyz),
];

impl Old {
    /// Records that pbrt-v4 writes `now` for `what`.
    pub fn found(&mut self, span: Span, what: &str, now: &str) {
        if let Some(&known) = self.index.get(what) {
            self.found[known].more += 1;
            return;
        }
        self.index.insert(what.to_owned(), self.found.len());
        self.found.push(Found { what: what.to_owned(), now: now.to_owned(), first: span, more: 0 });
    }

    /// The type an old keyword stands for.
    pub fn param_type(&mut self, keyword: &str, span: Span) -> Option<ParamType> {
        let kind = TYPES.iter().find(|row| row.0 == keyword)?.1;
        let now = if kind == ParamType::Xyz { "rgb" } else { kind.keyword() };
        self.found(span, &format!("the parameter type `{keyword}`"), &format!("`{now}`"));
        Some(kind)
    }

    /// One note that the scene is of pbrt-v3, and the losses of what was upgraded.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        if !self.found.is_empty() {
            for span in std::mem::take(&mut self.spots) {
                let text = "the edge of a spot of pbrt-v3 falls with the fourth power of its cosine's share of the way; \
                            here it falls smoothly, and is brighter";
                self.lost(span, text.to_owned());
            }
        }
        let mut problems = self.problems;
        if let Some(first) = self.found.first() {
            let text = format!("this is a pbrt-v3 scene ({}): it is read as pbrt-v3 means it", first.what);
            problems.push(Diagnostic::new(Severity::Note, text, Some(first.first)));
        }
        problems
    }

    fn lost(&mut self, span: Span, text: String) {
        self.problems.push(Diagnostic::warning(text, Some(span)));
    }

    /// Converts a directive to pbrt-v4; `false` when nothing remains of it.
    pub fn directive(&mut self, d: &mut Directive) -> bool {
        match d.name.as_str() {
            "WorldEnd" => {
                self.found(d.span, "`WorldEnd`", "nothing: the world ends with the file");
                return false;
            }
            "Renderer" | "VolumeIntegrator" | "Volume" => {
                self.found(d.span, &format!("`{}`", d.name), NOTHING);
                self.lost(d.span, format!("`{}` of older versions is left out", d.name));
                return false;
            }
            "SurfaceIntegrator" => {
                self.found(d.span, "`SurfaceIntegrator`", "`Integrator`");
                d.name = "Integrator".to_owned();
            }
            "Texture" => {
                if let Some(kind) = d.arguments.get_mut(1)
                    && kind.value == Value::Text("color".to_owned())
                {
                    self.found(kind.span, "a texture of kind `color`", "`spectrum`");
                    kind.value = Value::Text("spectrum".to_owned());
                }
            }
            _ => {}
        }
        d.params.iter_mut().for_each(from_xyz);
        self.blackbodies(d);
        self.light(d);
        let class = if d.name == "MakeNamedMaterial" { "Material" } else { d.name.as_str() };
        let kind = kind(d);
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
            self.found(place, &what, &format!("`{}`", row.to));
            set_kind(d, row.to);
            if !row.loss.is_empty() {
                self.lost(place, format!("{what} of pbrt-v3 is approximated by `{}`: {}", row.to, row.loss));
            }
        }
        for (name, change) in row.params {
            let Some(index) = d.params.iter().rposition(|p| p.name == *name) else { continue };
            if !change.concerns(&d.params[index], d) {
                continue;
            }
            let span = d.params[index].span;
            let what = format!("the parameter `{name}` of {}", row.noun);
            match change {
                Change::Rename(now) => {
                    self.found(span, &what, &format!("`{now}`"));
                    (*now).clone_into(&mut d.params[index].name);
                }
                Change::Drop => {
                    self.found(span, &what, NOTHING);
                    d.params.retain(|p| p.name != *name);
                }
                Change::Lose(loss) => {
                    self.found(span, &what, NOTHING);
                    self.lost(span, format!("`{name}` is left out: {loss}"));
                    d.params.retain(|p| p.name != *name);
                }
                Change::With(now, convert) => {
                    self.found(span, &what, now);
                    convert(d, index);
                }
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
