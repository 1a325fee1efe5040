//! Text → tokens with byte ranges. Lists of numbers have a faster way through [`super::number`].

use std::borrow::Cow;
use std::ops::Range;

use nom::branch::alt;
use nom::bytes::complete::{is_not, take_till, take_while1};
use nom::character::complete::{char, multispace1, satisfy};
use nom::combinator::{recognize, value};
use nom::multi::many0_count;
use nom::sequence::{delimited, preceded};
use nom::{IResult, Parser};

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// A quoted string with its escapes resolved.
    Quoted(Cow<'a, str>),
    /// Everything else that is not a bracket: directives, numbers, `true`.
    Word(&'a str),
    Open,
    Close,
    /// Not a token; the text says why.
    Bad(String),
}

/// White space and `#` comments.
fn blank(text: &str) -> IResult<&str, ()> {
    let comment = preceded(char('#'), take_till(|c| c == '\n'));
    value((), many0_count(alt((value((), multispace1), value((), comment))))).parse(text)
}

/// Ends at white space, quotes and brackets; a `#` inside does not end it.
fn word(text: &str) -> IResult<&str, &str> {
    take_while1(|c: char| !c.is_ascii_whitespace() && !matches!(c, '"' | '[' | ']')).parse(text)
}

/// What stands between two quotes on one line, escapes and all.
fn quoted(text: &str) -> IResult<&str, &str> {
    let escape = recognize((char('\\'), satisfy(|c| c != '\n')));
    let body = recognize(many0_count(alt((is_not("\"\\\n"), escape))));
    delimited(char('"'), body, char('"')).parse(text)
}

fn unescape(body: &str) -> Token<'_> {
    if !body.contains('\\') {
        return Token::Quoted(Cow::Borrowed(body));
    }
    let mut out = String::with_capacity(body.len());
    let mut chars = body.chars();
    while let Some(c) = chars.next() {
        out.push(match (c, if c == '\\' { chars.next() } else { None }) {
            ('\\', Some('b')) => '\u{8}',
            ('\\', Some('f')) => '\u{c}',
            ('\\', Some('n')) => '\n',
            ('\\', Some('r')) => '\r',
            ('\\', Some('t')) => '\t',
            ('\\', Some(same @ ('\\' | '\'' | '"'))) => same,
            ('\\', other) => {
                let other = other.unwrap_or_default();
                return Token::Bad(format!("`\\{other}` is not an escape; `\\\\` is a backslash"));
            }
            _ => c,
        });
    }
    Token::Quoted(Cow::Owned(out))
}

/// Reads a text from front to back.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    pub text: &'a str,
    pub position: usize,
}

impl<'a> Cursor<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { text, position: 0 }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.position..]
    }

    pub fn skip_blank(&mut self) {
        if let Ok((rest, ())) = blank(self.rest()) {
            self.position = self.text.len() - rest.len();
        }
    }

    /// The next token and where it stands; `None` at the end.
    pub fn next(&mut self) -> Option<(Token<'a>, Range<usize>)> {
        self.skip_blank();
        let start = self.position;
        let rest = self.rest();
        let (token, length) = match rest.bytes().next()? {
            b'[' => (Token::Open, 1),
            b']' => (Token::Close, 1),
            b'"' => match quoted(rest) {
                Ok((_, body)) => (unescape(body), body.len() + 2),
                Err(_) => {
                    let line = rest.find('\n').unwrap_or(rest.len());
                    (Token::Bad("the string is not closed on its line".to_owned()), line)
                }
            },
            _ => match word(rest) {
                Ok((_, word)) => (Token::Word(word), word.len()),
                // Unreachable: a byte that is no blank, quote or bracket starts a word.
                Err(_) => (Token::Bad("unreadable".to_owned()), rest.len()),
            },
        };
        self.position += length;
        Some((token, start..self.position))
    }

    /// The next token without taking it.
    pub fn peek(&self) -> Option<Token<'a>> {
        self.clone().next().map(|(token, _)| token)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<Token<'_>> {
        let mut cursor = Cursor::new(text);
        std::iter::from_fn(|| cursor.next().map(|(token, _)| token)).collect()
    }

    #[test]
    fn words_strings_brackets_and_comments() {
        let text = "Shape\"sphere\" # c \"\n\"float r\"[1.5]a#b";
        let found = tokens(text);
        let quoted = |s: &'static str| Token::Quoted(Cow::Borrowed(s));
        let expected = [
            Token::Word("Shape"),
            quoted("sphere"),
            quoted("float r"),
            Token::Open,
            Token::Word("1.5"),
            Token::Close,
            Token::Word("a#b"),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn escapes() {
        assert_eq!(tokens(r#""a\"b\\\n""#), [Token::Quoted(Cow::Borrowed("a\"b\\\n"))]);
        assert!(matches!(tokens(r#""\q""#)[..], [Token::Bad(_)]));
        assert!(matches!(tokens("\"open\n1")[..], [Token::Bad(_), Token::Word("1")]));
        assert!(matches!(tokens("\"ends\\")[..], [Token::Bad(_)]));
    }
}
