//! Values of options that shells offer, and that somebody else checks.

use clap::builder::{PossibleValue, TypedValueParser};
use clap::error::Error;
use clap::{Arg, Command};

/// A parser that shells are told the words of.
#[derive(Clone)]
pub struct Offering<P> {
    parser: P,
    words: Vec<&'static str>,
}

/// Takes what `parser` takes, and offers these words.
pub fn offering<P>(parser: P, words: impl IntoIterator<Item = &'static str>) -> Offering<P> {
    Offering { parser, words: words.into_iter().collect() }
}

/// Takes any text, and offers these words: what is wrong with a text is found out later, and said with a suggestion.
pub fn any_of(
    words: impl IntoIterator<Item = &'static str>,
) -> Offering<impl TypedValueParser<Value = String>> {
    offering(|text: &str| Ok::<_, String>(text.to_owned()), words)
}

impl<P: TypedValueParser> TypedValueParser for Offering<P> {
    type Value = P::Value;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Self::Value, Error> {
        self.parser.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.words.iter().map(PossibleValue::new)))
    }
}
