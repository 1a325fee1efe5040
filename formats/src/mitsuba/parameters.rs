//! `$name` substitution.

use std::path::Path;

use super::policy::Policy;
use crate::diagnostic::{Diagnostic, Span, nearest, quoted};

/// Longest substituted value: `<default>`s that double each other would fill the memory.
const MAX_VALUE_BYTES: usize = 16 << 20;
/// Most bytes of all substituted values of a scene together.
const MAX_BYTES: usize = 64 << 20;

#[derive(Clone, Debug)]
struct Parameter {
    name: String,
    value: String,
    given: bool,
    used: bool,
}

/// A name without a value.
#[derive(Clone, Debug)]
struct Undefined {
    name: String,
    /// Where it was first used.
    span: Span,
    /// It was used only in what does not change the light.
    harmless: bool,
}

/// Values of `$name`, from the command line and from `<default>`.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters {
    /// Longest name first, so that `$width` is not `$w` followed by `idth`.
    items: Vec<Parameter>,
    /// Bytes of all values that were put together.
    bytes: usize,
    undefined: Vec<Undefined>,
}

impl Parameters {
    pub fn new(defines: &[(String, String)]) -> Self {
        let mut parameters = Self::default();
        for (name, value) in defines {
            parameters.items.retain(|p| p.name != *name);
            parameters.insert(name, value, true);
        }
        parameters
    }

    fn insert(&mut self, name: &str, value: &str, given: bool) {
        let at = self.items.partition_point(|p| p.name.len() > name.len());
        let item = Parameter { name: name.to_owned(), value: value.to_owned(), given, used: false };
        self.items.insert(at, item);
    }

    /// `<default>`: the first value wins, and the command line wins over all.
    pub fn default_value(&mut self, name: &str, value: &str) {
        if !self.items.iter().any(|p| p.name == name) {
            self.insert(name, value, false);
        }
    }

    /// `text` with every `$name` replaced. `later` finds the value of a `<default>` that comes
    /// after this place; `harmless` is said of a place that does not change the light. `Err` when something was undefined, which is kept for [`Self::report_undefined`].
    pub fn substitute(
        &mut self,
        text: &str,
        span: Span,
        harmless: bool,
        later: &dyn Fn(&str) -> Option<(String, String)>,
        problems: &mut Vec<Diagnostic>,
    ) -> Result<Option<String>, ()> {
        if !text.contains('$') {
            return Ok(None);
        }
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
        let mut complete = true;
        while let Some(at) = rest.find('$') {
            if rest[..at].ends_with('\\') {
                out.push_str(&rest[..at - 1]);
                out.push('$');
                rest = &rest[at + 1..];
                continue;
            }
            out.push_str(&rest[..at]);
            rest = &rest[at + 1..];
            if let Some(parameter) = self.items.iter_mut().find(|p| rest.starts_with(&p.name)) {
                parameter.used = true;
                out.push_str(&parameter.value);
                rest = &rest[parameter.name.len()..];
            } else if let Some((name, value)) = later(rest) {
                problems.push(
                    Diagnostic::warning(format!("`${name}` is used before its <default>"), Some(span))
                        .help("Mitsuba rejects this; move the <default> up"),
                );
                out.push_str(&value);
                rest = &rest[name.len()..];
                self.default_value(&name, &value);
            } else {
                let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
                self.add_undefined(&rest[..end], span, harmless);
                rest = &rest[end..];
                complete = false;
            }
            if out.len() > MAX_VALUE_BYTES || self.bytes + out.len() > MAX_BYTES {
                problems
                    .push(Diagnostic::error("the value becomes too long by `$` substitution", Some(span)));
                return Err(());
            }
        }
        out.push_str(rest);
        self.bytes += out.len();
        if complete { Ok(Some(out)) } else { Err(()) }
    }

    fn add_undefined(&mut self, name: &str, span: Span, harmless: bool) {
        match self.undefined.iter_mut().find(|known| known.name == name) {
            Some(known) => known.harmless &= harmless,
            None => self.undefined.push(Undefined { name: name.to_owned(), span, harmless }),
        }
    }

    /// How many names have no value so far, to come back to by [`Self::forget_undefined`].
    pub fn undefined_count(&self) -> usize {
        self.undefined.len()
    }

    /// Forgets all names without a value but the first `kept`.
    pub fn forget_undefined(&mut self, kept: usize) {
        self.undefined.truncate(kept);
    }

    /// One message about all names without a value, with a command line that gives them one.
    pub fn report_undefined(&self, scene: &Path, policy: Policy) -> Option<Diagnostic> {
        let [first, others @ ..] = self.undefined.as_slice() else { return None };
        let names: Vec<String> = self.undefined.iter().map(|u| format!("`${}`", u.name)).collect();
        let plural = if others.is_empty() { "" } else { "s" };
        let what = format!("undefined parameter{plural} {}", names.join(", "));
        let instead = "every place has its default";
        let harmless = self.undefined.iter().all(|u| u.harmless);
        let mut problem = policy.judge_unless(harmless, &what, instead, first.span);
        for other in others {
            problem = problem.label(other.span, format!("`${}`", other.name));
        }
        let mut command = format!("caustica render {}", quoted(&scene.display().to_string()));
        for given in self.items.iter().filter(|p| p.given) {
            command.push_str(&format!(" -D {}", quoted(&format!("{}={}", given.name, given.value))));
        }
        let mut missing = false;
        for Undefined { name, .. } in &self.undefined {
            let known = self.items.iter().map(|p| p.name.as_str()).filter(|known| known != name);
            match nearest(name, known) {
                Some(known) => problem = problem.help(format!("did you mean `${known}` by `${name}`?")),
                None => {
                    missing = true;
                    command.push_str(&format!(" -D {name}=..."));
                }
            }
        }
        Some(if missing { problem.help(format!("give a value: {command}")) } else { problem })
    }

    /// One error for each parameter of the command line that the scene does not have.
    pub fn unused(&self) -> impl Iterator<Item = Diagnostic> {
        self.items.iter().filter(|p| p.given && !p.used).map(|unused| {
            let name = &unused.name;
            let problem =
                Diagnostic::error(format!("the scene never uses the parameter `{name}` given by -D"), None)
                    .request();
            let known = self.items.iter().filter(|p| p.used || !p.given).map(|p| p.name.as_str());
            problem.suggest_or(name, known.clone(), || {
                let mut known: Vec<_> = known.collect();
                known.sort_unstable();
                format!("the scene's parameters: {}", list_or_none(&known))
            })
        })
    }
}

fn list_or_none(names: &[&str]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
