//! `Option "name" value`.

use super::directive::{Directive, Value};
use super::reader::{Reader, text};
use crate::diagnostic::Diagnostic;

#[derive(Clone, Copy, PartialEq, Eq)]
enum OptionType {
    Bool,
    Number,
    Text,
    Seed,
}

/// Names without `-` and `_`, the type of the value, and the warning when it is set.
const OPTIONS: &[(&str, OptionType, Option<&str>)] = &[
    ("disablepixeljitter", OptionType::Bool, Some("samples stay spread over the pixel")),
    ("disabletexturefiltering", OptionType::Bool, None),
    ("disablewavelengthjitter", OptionType::Bool, None),
    ("displacementedgescale", OptionType::Number, None),
    ("forcediffuse", OptionType::Bool, Some("materials are unchanged")),
    ("msereferenceimage", OptionType::Text, Some("`caustica compare` compares pictures")),
    ("msereferenceout", OptionType::Text, Some("`caustica compare` compares pictures")),
    ("pixelstats", OptionType::Bool, Some("`--stats` writes statistics")),
    ("rendercoordsys", OptionType::Text, None),
    ("seed", OptionType::Seed, None),
    ("wavefront", OptionType::Bool, None),
];

impl Reader<'_> {
    pub fn option(&mut self, d: &Directive) {
        let name = text(d, 0);
        let plain: String = name.chars().filter(|c| !matches!(c, '-' | '_')).collect();
        let plain = plain.to_ascii_lowercase();
        let Some((_, value_type, consequence)) = OPTIONS.iter().find(|row| row.0 == plain) else {
            let problem = Diagnostic::error(format!("no option named `{name}`"), Some(d.arguments[0].span));
            self.problems.push(problem.suggest(&plain, OPTIONS.iter().map(|row| row.0)));
            return;
        };
        let Some(value) = d.arguments.get(1) else { return };
        let set = match (&value.value, value_type) {
            (Value::Word(word), OptionType::Bool) => match word.as_str() {
                "true" => true,
                "false" => false,
                _ => return self.error(format!("`{name}` is true or false, not `{word}`"), value.span),
            },
            (Value::Word(word), OptionType::Number) if word.parse::<f64>().is_ok() => true,
            (Value::Word(word), OptionType::Seed) => match word.parse() {
                Ok(seed) => {
                    self.head.seed = seed;
                    true
                }
                Err(_) => return self.error(format!("`{name}` is a whole number, not `{word}`"), value.span),
            },
            (Value::Text(_), OptionType::Text) => true,
            _ => {
                let wanted = match value_type {
                    OptionType::Bool => "true or false",
                    OptionType::Number => "a number",
                    OptionType::Seed => "a whole number",
                    OptionType::Text => "a quoted string",
                };
                return self.error(format!("the value of `{name}` is {wanted}"), value.span);
            }
        };
        if let Some(consequence) = consequence.filter(|_| set) {
            self.warn(format!("option `{name}` is ignored: {consequence}"), d.arguments[0].span);
        }
    }
}
