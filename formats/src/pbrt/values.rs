//! The values of a parameter.

use super::directive::{ParamType, Values, follows};
use super::number::{self, BadNumber, Number};
use super::parse::Parser;
use super::token::Token;
use crate::diagnostic::{Span, char_floor};

/// Point lists longer than this are kept in the precision of a mesh.
const PRECISE: usize = 64;

impl Parser<'_, '_> {
    pub fn values(&mut self, kind: ParamType, name: &str, span: Span) -> Values {
        let bracket = self.cursor.peek() == Some(Token::Open);
        if bracket {
            self.cursor.next();
            self.cursor.skip_blank();
        }
        let limit = if bracket { usize::MAX } else { 1 };
        let quoted = matches!(self.cursor.peek(), Some(Token::Quoted(_)));
        let values = match kind {
            ParamType::String | ParamType::Texture => self.strings(limit).map(Values::Texts),
            ParamType::Bool => self.bools(limit),
            ParamType::Spectrum if quoted => self.strings(limit).map(Values::Texts),
            ParamType::Integer => self.list(limit).map(Values::Integers),
            ParamType::Point2 | ParamType::Point3 | ParamType::Vector3 | ParamType::Normal => {
                self.points(limit)
            }
            _ => self.list(limit).map(Values::Floats),
        };
        let Some(values) = values else {
            self.skip_value();
            return Values::Broken;
        };
        if bracket {
            match self.cursor.peek() {
                Some(Token::Close) => {
                    self.cursor.next();
                }
                found => {
                    let text = match found {
                        None => format!("the list of `{name}` is not closed"),
                        Some(_) => format!("`{name}` expects {}", wanted(kind)),
                    };
                    self.cursor.skip_blank();
                    let place = if found.is_none() { span } else { self.here() };
                    self.error(text, place);
                    self.skip_value();
                    return Values::Broken;
                }
            }
        }
        if values.len() == 0 {
            let text = if bracket {
                format!("the list of `{name}` is empty")
            } else {
                format!("`{name}` expects {}", wanted(kind))
            };
            self.error(text, span);
            if !bracket {
                self.skip_value();
            }
            return Values::Broken;
        }
        values
    }

    fn list<N: Number>(&mut self, limit: usize) -> Option<Vec<N>> {
        let mut out = Vec::new();
        match number::list(&mut self.cursor, &mut out, limit) {
            Ok(()) => Some(out),
            Err(bad) => {
                self.bad_number(&bad);
                None
            }
        }
    }

    fn points(&mut self, limit: usize) -> Option<Values> {
        let mut precise: Vec<f64> = self.list(limit.min(PRECISE))?;
        if precise.len() < PRECISE {
            return Some(Values::Floats(precise));
        }
        let mut mesh: Vec<f32> = precise.drain(..).map(|x| x as f32).collect();
        match number::list(&mut self.cursor, &mut mesh, limit) {
            Ok(()) => Some(Values::Mesh(mesh)),
            Err(bad) => {
                self.bad_number(&bad);
                None
            }
        }
    }

    pub fn bad_number(&mut self, bad: &BadNumber) {
        let text = self.cursor.text;
        let end = char_floor(text, bad.end.min(bad.start + 60)).max(bad.start);
        let found = &text[bad.start..end];
        let span = self.span(&(bad.start..end));
        self.error(format!("expected {}, found `{found}`", bad.text), span);
    }

    fn strings(&mut self, limit: usize) -> Option<Vec<String>> {
        let mut out = Vec::new();
        while out.len() < limit {
            match self.cursor.peek() {
                Some(Token::Quoted(_)) => {
                    if let Some((Token::Quoted(text), _)) = self.cursor.next() {
                        out.push(text.into_owned());
                    }
                }
                Some(Token::Bad(what)) => {
                    let (_, range) = self.cursor.next()?;
                    let span = self.span(&range);
                    self.error(what, span);
                    return None;
                }
                _ => break,
            }
        }
        Some(out)
    }

    fn bools(&mut self, limit: usize) -> Option<Values> {
        let mut out = Vec::new();
        while out.len() < limit {
            let word = match self.cursor.peek() {
                Some(Token::Word(word)) if follows(word).is_none() => word.to_owned(),
                Some(Token::Quoted(word)) => {
                    let mut ahead = self.cursor.clone();
                    let (_, range) = ahead.next()?;
                    let span = self.span(&range);
                    self.old.found(span, "a quoted boolean", "bare `true` or `false`");
                    word.into_owned()
                }
                _ => break,
            };
            let (_, range) = self.cursor.next()?;
            match word.as_str() {
                "true" => out.push(true),
                "false" => out.push(false),
                _ => {
                    let span = self.span(&range);
                    self.error(format!("expected true or false, found `{word}`"), span);
                    return None;
                }
            }
        }
        Some(Values::Bools(out))
    }

    /// Skips an unreadable value: to its closing bracket, or to the next directive.
    pub fn skip_value(&mut self) {
        let mut ahead = self.cursor.clone();
        let bracketed = loop {
            match ahead.next() {
                None => break false,
                Some((Token::Close, _)) => break true,
                Some((Token::Word(name), _)) if follows(name).is_some() => break false,
                Some((Token::Quoted(text), _)) if declares(&text) => break false,
                _ => {}
            }
        };
        if bracketed {
            self.cursor = ahead;
            return;
        }
        loop {
            match self.cursor.peek() {
                None => return,
                Some(Token::Word(name)) if follows(name).is_some() => return,
                Some(Token::Quoted(text)) if declares(&text) => return,
                _ => {
                    self.cursor.next();
                }
            }
        }
    }
}

/// Whether a string looks like the type and name of a parameter.
fn declares(text: &str) -> bool {
    let mut words = text.split_ascii_whitespace();
    words.next().is_some_and(|word| ParamType::of_keyword(word).is_some())
        && words.next().is_some()
        && words.next().is_none()
}

fn wanted(kind: ParamType) -> &'static str {
    match kind {
        ParamType::String => "a quoted string",
        ParamType::Texture => "the quoted name of a texture",
        ParamType::Bool => "true or false",
        ParamType::Spectrum => "pairs of wavelength and value, or the quoted name of a spectrum",
        ParamType::Integer => "whole numbers",
        _ => "numbers",
    }
}
