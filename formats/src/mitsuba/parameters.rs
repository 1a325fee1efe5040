//! `$name` substitution.

use crate::diagnostic::{Diagnostic, Span, nearest};

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

/// Values of `$name`, from the command line and from `<default>`.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters {
    /// Longest name first, so that `$width` is not `$w` followed by `idth`.
    items: Vec<Parameter>,
    /// Bytes of all values that were put together.
    bytes: usize,
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
    /// after this place. `Err` when something was undefined; it was reported.
    pub fn substitute(
        &mut self,
        text: &str,
        span: Span,
        later: &dyn Fn(&str) -> Option<(String, String)>,
        problems: &mut Vec<Diagnostic>,
    ) -> Result<Option<String>, ()> {
        if !text.contains('$') {
            return Ok(None);
        }
        let mut out = String::with_capacity(text.len());
        let mut rest = text;
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
                problems.push(self.undefined(rest, span));
                return Err(());
            }
            if out.len() > MAX_VALUE_BYTES || self.bytes + out.len() > MAX_BYTES {
                problems
                    .push(Diagnostic::error("the value becomes too long by `$` substitution", Some(span)));
                return Err(());
            }
        }
        out.push_str(rest);
        self.bytes += out.len();
        Ok(Some(out))
    }

    fn undefined(&self, rest: &str, span: Span) -> Diagnostic {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let name = &rest[..end];
        let problem = Diagnostic::error(format!("undefined parameter `${name}`"), Some(span));
        match nearest(name, self.items.iter().map(|p| p.name.as_str())) {
            Some(known) => problem.help(format!("did you mean `${known}`?")),
            None => {
                problem.help(format!("add <default name=\"{name}\" value=\"…\"/> above, or give -D {name}=…"))
            }
        }
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
