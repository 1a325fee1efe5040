//! Typed access to the entries of one object, which remembers what was asked for.

use super::number;
use super::object::{Class, Entry, Object, ObjectIndex, Value};
use super::policy::Policy;
use super::upgrade::camel_case;
use crate::diagnostic::{Diagnostic, Severity, Span, nearest};
use crate::ir::{Ior, Origin, Transform};
use crate::spectrum::ior_names;

/// Every entry that nobody took is reported by [`Props::finish`]; every name that was asked for
/// is a valid name for its suggestion. So a reader asks for all names on every path.
pub(super) struct Props<'a> {
    pub object: &'a Object,
    objects: &'a [Object],
    taken: Vec<bool>,
    known: Vec<&'static str>,
    pub problems: Vec<Diagnostic>,
}

/// A nested object and the place that names it.
#[derive(Clone, Copy)]
pub(super) struct Nested {
    pub index: ObjectIndex,
    pub span: Span,
}

impl<'a> Props<'a> {
    pub fn new(objects: &'a [Object], index: ObjectIndex) -> Self {
        let object = &objects[index];
        let taken = vec![false; object.entries.len()];
        Self { object, objects, taken, known: Vec::new(), problems: Vec::new() }
    }

    pub fn origin(&self) -> Origin {
        Origin(Some(self.object.span))
    }

    pub fn name(&self) -> Option<String> {
        self.object.id.clone()
    }

    /// The entry called `name`, now accounted for.
    pub fn entry(&mut self, name: &'static str) -> Option<&'a Entry> {
        self.known.push(name);
        // Given twice, the later one counts, as in Mitsuba.
        let at = self.object.entries.iter().rposition(|e| e.name.as_deref() == Some(name))?;
        for (taken, entry) in self.taken.iter_mut().zip(&self.object.entries) {
            *taken |= entry.name.as_deref() == Some(name);
        }
        Some(&self.object.entries[at])
    }

    pub fn has(&self, name: &str) -> bool {
        self.object.entries.iter().any(|e| e.name.as_deref() == Some(name))
    }

    /// Accepts entries that do not change the image, without a message.
    pub fn ignore(&mut self, names: &[&'static str]) {
        for name in names {
            self.entry(name);
        }
    }

    /// Accepts entries that would change the image if they were supported, with a warning.
    pub fn ignore_with_warning(&mut self, names: &[&'static str], why: &str) {
        for name in names {
            if let Some(entry) = self.entry(name) {
                let text = format!("parameter `{name}` is ignored: {why}");
                self.problems.push(Diagnostic::warning(text, Some(entry.name_span)));
            }
        }
    }

    /// Accepts all remaining entries without a message.
    pub fn ignore_rest(&mut self) {
        self.taken.fill(true);
    }

    /// Accounts for the entries whose names `matches` accepts.
    pub fn ignore_matching(&mut self, matches: impl Fn(&str) -> bool) {
        for (taken, entry) in self.taken.iter_mut().zip(&self.object.entries) {
            *taken |= entry.name.as_deref().is_some_and(&matches);
        }
    }

    pub fn optional_float(&mut self, name: &'static str) -> Option<f64> {
        let entry = self.entry(name)?;
        match &entry.value {
            Value::Float(v) => Some(*v),
            Value::Integer(v) => Some(*v as f64),
            _ => self.wrong(entry, "a float"),
        }
    }

    pub fn float(&mut self, name: &'static str, default: f64) -> f64 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A float that must be greater than zero.
    pub fn positive(&mut self, name: &'static str, default: f64) -> f64 {
        let value = self.float(name, default);
        if value > 0.0 {
            return value;
        }
        self.complain(name, format!("parameter `{name}` must be positive, not {value}"));
        default
    }

    pub fn optional_integer(&mut self, name: &'static str) -> Option<i64> {
        let entry = self.entry(name)?;
        match &entry.value {
            Value::Integer(v) => Some(*v),
            _ => self.wrong(entry, "an integer"),
        }
    }

    /// An integer within `range`.
    pub fn count(&mut self, name: &'static str, default: u32, range: std::ops::RangeInclusive<u32>) -> u32 {
        let Some(value) = self.optional_integer(name) else { return default };
        match u32::try_from(value).ok().filter(|v| range.contains(v)) {
            Some(value) => value,
            None => {
                let text = format!(
                    "parameter `{name}` must lie between {} and {}, not {value}",
                    range.start(),
                    range.end()
                );
                self.complain(name, text);
                default
            }
        }
    }

    pub fn boolean(&mut self, name: &'static str, default: bool) -> bool {
        let Some(entry) = self.entry(name) else { return default };
        match &entry.value {
            Value::Boolean(v) => *v,
            _ => self.wrong(entry, "a boolean").unwrap_or(default),
        }
    }

    pub fn optional_string(&mut self, name: &'static str) -> Option<(&'a str, Span)> {
        let entry = self.entry(name)?;
        match &entry.value {
            Value::String(v) => Some((v, entry.span)),
            _ => self.wrong(entry, "a string"),
        }
    }

    /// One of the words of `table`, whatever the case.
    pub fn choice<T: Copy>(&mut self, name: &'static str, default: T, table: &[(&'static str, T)]) -> T {
        self.optional_choice(name, table).unwrap_or(default)
    }

    pub fn optional_choice<T: Copy>(&mut self, name: &'static str, table: &[(&'static str, T)]) -> Option<T> {
        let (text, span) = self.optional_string(name)?;
        let found = table.iter().find(|(word, _)| word.eq_ignore_ascii_case(text.trim()));
        if found.is_none() {
            let words: Vec<&str> = table.iter().map(|(word, _)| *word).collect();
            let problem = Diagnostic::error(format!("parameter `{name}` has no value `{text}`"), Some(span));
            self.problems.push(
                problem.suggest_or(text, words.iter().copied(), || format!("possible: {}", words.join(", "))),
            );
        }
        found.map(|(_, value)| *value)
    }

    /// A point or vector.
    pub fn triple(&mut self, name: &'static str) -> Option<[f64; 3]> {
        let entry = self.entry(name)?;
        match &entry.value {
            Value::Point(v) | Value::Vector(v) => Some(*v),
            _ => self.wrong(entry, "a point"),
        }
    }

    pub fn optional_transform(&mut self, name: &'static str) -> Option<Transform> {
        let entry = self.entry(name)?;
        match &entry.value {
            Value::Transform(v) => Some(*v),
            _ => self.wrong(entry, "a transform"),
        }
    }

    pub fn transform(&mut self, name: &'static str) -> Transform {
        self.optional_transform(name).unwrap_or_default()
    }

    pub fn optional_ior(&mut self, name: &'static str) -> Option<Ior> {
        let entry = self.entry(name)?;
        match &entry.value {
            Value::Float(v) if *v > 0.0 => Some(Ior::Value(*v)),
            Value::Integer(v) if *v > 0 => Some(Ior::Value(*v as f64)),
            Value::String(text) => match number::float(text) {
                Some(v) if v > 0.0 => Some(Ior::Value(v)),
                _ => {
                    let name = ior_names().find(|known| known.eq_ignore_ascii_case(text.trim()));
                    if name.is_none() {
                        let known = ior_names().collect::<Vec<_>>().join(", ");
                        let text = format!("no index of refraction named `{text}`");
                        let problem = Diagnostic::error(text, Some(entry.span));
                        self.problems.push(problem.help(format!("known: {known}")));
                    }
                    name.map(|name| Ior::Named(name.to_owned()))
                }
            },
            Value::Float(_) | Value::Integer(_) => {
                self.complain(name, format!("parameter `{name}` must be positive"));
                None
            }
            _ => self.wrong(entry, "a float or the name of a material"),
        }
    }

    /// The next nested object of `class` that was not taken, whatever its name.
    pub fn child(&mut self, class: Class) -> Option<Nested> {
        let objects = self.objects;
        let at = self.object.entries.iter().zip(&self.taken).position(|(entry, taken)| {
            !taken && matches!(entry.value, Value::Object(index) if objects[index].class == class)
        })?;
        self.taken[at] = true;
        let entry = &self.object.entries[at];
        match entry.value {
            Value::Object(index) => Some(Nested { index, span: entry.span }),
            _ => None,
        }
    }

    /// Whether an object of `class` is nested and was not taken yet.
    pub fn has_child(&self, class: Class) -> bool {
        let objects = self.objects;
        self.object.entries.iter().zip(&self.taken).any(|(entry, taken)| {
            !taken && matches!(entry.value, Value::Object(index) if objects[index].class == class)
        })
    }

    /// The only nested object of `class`; a second one is an error.
    pub fn only_child(&mut self, class: Class) -> Option<Nested> {
        self.only_child_of(&[class])
    }

    /// The only nested texture, for which a spectrum plugin may stand.
    pub fn only_texture(&mut self) -> Option<Nested> {
        self.only_child_of(&[Class::Texture, Class::Spectrum])
    }

    fn only_child_of(&mut self, classes: &[Class]) -> Option<Nested> {
        let first = classes.iter().find_map(|class| self.child(*class))?;
        while let Some(second) = classes.iter().find_map(|class| self.child(*class)) {
            let what = classes[0].name();
            let text = format!("{} takes one {what}; this is a second one", self.object.plugin);
            let problem = Diagnostic::error(text, Some(second.span));
            self.problems.push(problem.label(first.span, "the first one"));
        }
        Some(first)
    }

    /// Reports an error when two alternative parameters are both given.
    pub fn exclusive(&mut self, a: &str, b: &str) {
        let place = |name: &str| {
            let entry = self.object.entries.iter().find(|e| e.name.as_deref() == Some(name));
            entry.map(|e| e.name_span)
        };
        if let (Some(first), Some(second)) = (place(a), place(b)) {
            let text = format!("{} takes either `{a}` or `{b}`, not both", self.object.plugin);
            self.problems.push(Diagnostic::error(text, Some(second)).label(first, "the other one"));
        }
    }

    /// An error about a missing nested object, unless one is there that was reported already.
    pub fn needs(&mut self, what: &str) {
        if !self.object.entries.iter().any(|e| matches!(e.value, Value::Broken)) {
            let text = format!("{} needs {what}", self.object.plugin);
            self.problems.push(Diagnostic::error(text, Some(self.object.span)));
        }
    }

    /// An error about the value of parameter `name`, or about the object when it is not given.
    pub fn complain(&mut self, name: &str, text: impl Into<String>) {
        let entry = self.object.entries.iter().find(|e| e.name.as_deref() == Some(name));
        let span = entry.map_or(self.object.span, |e| e.span);
        self.problems.push(Diagnostic::error(text, Some(span)));
    }

    /// Reports that `entry` is of another type than `wanted`. A broken one was reported before.
    pub fn wrong<T>(&mut self, entry: &Entry, wanted: &str) -> Option<T> {
        let got = match &entry.value {
            Value::Broken => return None,
            Value::Object(index) => format!("a {}", self.objects[*index].class.name()),
            other => other.describe().to_owned(),
        };
        let name = entry.name.as_deref().unwrap_or_default();
        let text = format!("parameter `{name}` of {} expects {wanted}, got {got}", self.object.plugin);
        self.problems.push(Diagnostic::error(text, Some(entry.span)));
        None
    }

    /// All problems, including those of entries that nobody asked for, with names as the file spells them.
    pub fn finish(mut self, policy: Policy) -> Vec<Diagnostic> {
        for (entry, taken) in self.object.entries.iter().zip(&self.taken) {
            if *taken || (matches!(entry.value, Value::Broken) && entry.name.is_none()) {
                continue;
            }
            let plugin = &self.object.plugin;
            let problem = match (&entry.name, &entry.value) {
                (None, Value::Object(index)) => {
                    let class = self.objects[*index].class.name();
                    let text = format!("{plugin} takes no nested {class} here");
                    policy.parameter(self.object, true, &text, entry.span)
                }
                (name, value) => {
                    let name = name.as_deref().unwrap_or_default();
                    let text = format!("unknown parameter `{name}` of {plugin}");
                    let nested = matches!(value, Value::Object(_));
                    let problem = policy.parameter(self.object, nested, &text, entry.name_span);
                    let list = problem.severity == Severity::Error;
                    self.suggest(name, problem, list)
                }
            };
            self.problems.push(problem);
        }
        if self.object.camel_case || self.object.entries.iter().any(|e| e.spelling.is_some()) {
            let mut problems = std::mem::take(&mut self.problems);
            for problem in &mut problems {
                problem.message = self.respelt(&problem.message);
                problem.help.iter_mut().for_each(|help| *help = self.respelt(help));
            }
            return problems;
        }
        self.problems
    }

    /// `name` as the file spells it, or as the author's version of the language does.
    fn spelt(&self, name: &str) -> String {
        let given = self.object.entries.iter().find(|e| e.name.as_deref() == Some(name));
        match given {
            Some(entry) => entry.spelling.clone().unwrap_or_else(|| name.to_owned()),
            None if self.object.camel_case => camel_case(name),
            None => name.to_owned(),
        }
    }

    /// A message in which names of parameters, which stand between `` ` ``, are spelt as in the file.
    fn respelt(&self, text: &str) -> String {
        let is_name = |word: &str| {
            self.known.contains(&word) || self.object.entries.iter().any(|e| e.name.as_deref() == Some(word))
        };
        let quoted = |(i, word): (usize, &str)| match i % 2 == 1 && is_name(word) {
            true => self.spelt(word),
            false => word.to_owned(),
        };
        text.split('`').enumerate().map(quoted).collect::<Vec<_>>().join("`")
    }

    fn suggest(&self, name: &str, problem: Diagnostic, list: bool) -> Diagnostic {
        let mut known = self.known.clone();
        known.sort_unstable();
        known.dedup();
        match nearest(name, known.iter().copied()) {
            Some(near) => problem.help(format!("did you mean `{near}`?")),
            None if known.is_empty() && list => problem.help("it takes no parameters"),
            None if list => {
                let all: Vec<String> = known.iter().map(|k| self.spelt(k)).collect();
                problem.help(format!("it takes: {}", all.join(", ")))
            }
            None => problem,
        }
    }
}
