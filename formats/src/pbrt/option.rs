//! `Option "name" value`.

use super::directive::{Directive, Value};
use super::reader::{Reader, text};
use crate::diagnostic::Diagnostic;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Bool,
    Number,
    Text,
    Seed,
}

/// Names without `-` and `_`, what their value is, and what happens to one that is set.
const OPTIONS: &[(&str, Kind, Option<&str>)] = &[
    ("disablepixeljitter", Kind::Bool, Some("samples stay spread over the pixel")),
    ("disabletexturefiltering", Kind::Bool, None),
    ("disablewavelengthjitter", Kind::Bool, None),
    ("displacementedgescale", Kind::Number, None),
    ("forcediffuse", Kind::Bool, Some("materials stay as they are")),
    ("msereferenceimage", Kind::Text, Some("`caustica compare` compares pictures")),
    ("msereferenceout", Kind::Text, Some("`caustica compare` compares pictures")),
    ("pixelstats", Kind::Bool, Some("`--stats` writes statistics")),
    ("rendercoordsys", Kind::Text, None),
    ("seed", Kind::Seed, None),
    ("wavefront", Kind::Bool, None),
];

impl Reader<'_> {
    pub fn option(&mut self, d: &Directive) {
        let name = text(d, 0);
        let plain: String = name.chars().filter(|c| !matches!(c, '-' | '_')).collect();
        let plain = plain.to_ascii_lowercase();
        let Some((_, kind, consequence)) = OPTIONS.iter().find(|row| row.0 == plain) else {
            let problem =
                Diagnostic::error(format!("no option is called `{name}`"), Some(d.arguments[0].span));
            self.problems.push(problem.suggest(&plain, OPTIONS.iter().map(|row| row.0)));
            return;
        };
        let Some(value) = d.arguments.get(1) else { return };
        let set = match (&value.value, kind) {
            (Value::Word(word), Kind::Bool) => match word.as_str() {
                "true" => true,
                "false" => false,
                _ => return self.error(format!("`{name}` is true or false, not `{word}`"), value.span),
            },
            (Value::Word(word), Kind::Number) if word.parse::<f64>().is_ok() => true,
            (Value::Word(word), Kind::Seed) => match word.parse() {
                Ok(seed) => {
                    self.head.seed = seed;
                    true
                }
                Err(_) => return self.error(format!("`{name}` is a whole number, not `{word}`"), value.span),
            },
            (Value::Text(_), Kind::Text) => true,
            _ => {
                let wanted = match kind {
                    Kind::Bool => "true or false",
                    Kind::Number => "a number",
                    Kind::Seed => "a whole number",
                    Kind::Text => "a quoted string",
                };
                return self.error(format!("the value of `{name}` is {wanted}"), value.span);
            }
        };
        if let Some(consequence) = consequence.filter(|_| set) {
            self.warn(format!("option `{name}` is ignored: {consequence}"), d.arguments[0].span);
        }
    }
}
