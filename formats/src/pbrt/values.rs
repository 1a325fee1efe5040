//! The values of a parameter.

use super::directive::{ParamType, Values, follows};
use super::number::{self, BadNumber, Number};
use super::parse::Parser;
use super::token::Token;
use crate::diagnostic::{Diagnostic, Span, char_floor};

/// Point lists longer than this are kept in the precision of a mesh.
const PRECISE: usize = 64;

impl Parser<'_, '_> {
    pub fn values(&mut self, kind: ParamType, name: &str, span: Span) -> Values {
        let bracket = self.cursor.peek() == Some(Token::Open);
        if bracket {
            self.cursor.next();
            self.cursor.skip_blank();
        }
        let quoted = matches!(self.cursor.peek(), Some(Token::Quoted(_)));
        let values = match kind {
            ParamType::String | ParamType::Texture => {
                self.strings(if bracket { usize::MAX } else { 1 }).map(Values::Texts)
            }
            ParamType::Bool => self.bools(if bracket { usize::MAX } else { 1 }),
            ParamType::Spectrum if quoted => {
                self.strings(if bracket { usize::MAX } else { 1 }).map(Values::Texts)
            }
            ParamType::Integer => self.list(bracket).map(Values::Integers),
            ParamType::Point2 | ParamType::Point3 | ParamType::Vector3 | ParamType::Normal => {
                self.points(bracket)
            }
            _ => self.list(bracket).map(Values::Floats),
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
                Some(_) if mismatched(kind, self.cursor.peek().as_ref()) => {
                    let text = format!("`{name}` expects {}", wanted(kind));
                    let place = self.after_blank();
                    self.old.slip(place, text, "it counts as not given");
                    self.skip_value();
                    return Values::Broken;
                }
                found => {
                    let place = self.after_blank();
                    let open = Diagnostic::error(format!("the list of `{name}` is not closed"), Some(span));
                    let problem = match found {
                        None => open,
                        Some(token) if begins_anew(&token) => {
                            open.label(place, "there is no `]` before this")
                        }
                        _ => Diagnostic::error(format!("`{name}` expects {}", wanted(kind)), Some(place)),
                    };
                    self.problems.push(problem);
                    self.skip_value();
                    return Values::Broken;
                }
            }
        }
        if values.len() == 0 {
            if bracket {
                self.old.slip(span, format!("the list of `{name}` is empty"), "it counts as not given");
            } else {
                self.error(format!("`{name}` expects {}", wanted(kind)), span);
                self.skip_value();
            }
            return Values::Broken;
        }
        self.check_brackets(name, &values, bracket, span);
        values
    }

    fn after_blank(&mut self) -> Span {
        self.cursor.skip_blank();
        self.here()
    }

    /// pbrt takes one number without brackets; exporters forget them around the three of a colour.
    fn check_brackets(&mut self, name: &str, values: &Values, bracket: bool, span: Span) {
        let numbers = !matches!(values, Values::Texts(_) | Values::Bools(_));
        if numbers && !bracket && values.len() > 1 {
            let text = format!("the {} numbers of `{name}` have no brackets", values.len());
            self.problems.push(Diagnostic::warning(text, Some(span)));
        }
    }

    fn list<N: Number>(&mut self, bracket: bool) -> Option<Vec<N>> {
        let mut out = Vec::new();
        self.numbers_into(&mut out, bracket, usize::MAX).then_some(out)
    }

    /// Appends up to `limit` numbers; `false` after reporting one that no version reads.
    pub fn numbers_into<N: Number>(&mut self, out: &mut Vec<N>, bracket: bool, limit: usize) -> bool {
        let end = out.len().saturating_add(limit);
        while out.len() < end {
            let most = if bracket { end - out.len() } else { 1 };
            let before = out.len();
            match number::list(&mut self.cursor, out, most) {
                // The list was not closed: what follows it is no number of it.
                Err(bad) if bracket && follows(&self.cursor.text[bad.start..bad.end]).is_some() => break,
                Err(bad) if !self.loose_number(&bad, out) => return false,
                Ok(()) if bracket || out.len() == before => break,
                _ => {}
            }
            let more = |token: &Token<'_>| matches!(token, Token::Word(word) if f64::leading(word.as_bytes()).is_some());
            if !bracket && !self.cursor.peek().as_ref().is_some_and(more) {
                break;
            }
        }
        true
    }

    /// Takes what pbrt-v3 reads of a word that is no number; `false` after reporting that it reads nothing.
    fn loose_number<N: Number>(&mut self, bad: &BadNumber, out: &mut Vec<N>) -> bool {
        let found = &self.cursor.text[bad.start..bad.end];
        let Some((value, exact)) = N::leading(found.as_bytes()) else {
            self.bad_number(bad);
            return false;
        };
        let instead = if exact { String::new() } else { format!("{value} is used") };
        let text = format!("expected {}, found `{}`", bad.text, short(found));
        let span = self.span(&(bad.start..bad.end));
        self.old.slip(span, text, instead);
        out.push(value);
        self.cursor.position = bad.end;
        true
    }

    fn points(&mut self, bracket: bool) -> Option<Values> {
        let mut precise: Vec<f64> = Vec::new();
        if !self.numbers_into(&mut precise, bracket, PRECISE) {
            return None;
        }
        if precise.len() < PRECISE {
            return Some(Values::Floats(precise));
        }
        let mut mesh: Vec<f32> = precise.drain(..).map(|x| x as f32).collect();
        self.numbers_into(&mut mesh, bracket, usize::MAX - PRECISE).then_some(Values::Mesh(mesh))
    }

    pub fn bad_number(&mut self, bad: &BadNumber) {
        let text = self.cursor.text;
        let found = short(&text[bad.start..bad.end]);
        let span = self.span(&(bad.start..bad.start + found.len()));
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
                    self.old.found(span, "a quoted boolean");
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
                    let text = format!("expected true or false, found `{word}`");
                    self.old.slip(span, text, "false is used");
                    out.push(false);
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

/// Not more than a message can show.
fn short(text: &str) -> &str {
    &text[..char_floor(text, 60)]
}

/// Whether a string looks like the type and name of a parameter.
fn declares(text: &str) -> bool {
    let mut words = text.split_ascii_whitespace();
    words.next().is_some_and(|word| ParamType::of_keyword(word).is_some())
        && words.next().is_some()
        && words.next().is_none()
}

/// Whether what follows a value belongs to what comes after it, so that its list was not closed.
fn begins_anew(found: &Token<'_>) -> bool {
    match found {
        Token::Word(name) => follows(name).is_some(),
        Token::Quoted(text) => declares(text),
        _ => false,
    }
}

/// Whether a quoted string stands where numbers are due, which pbrt-v3 passes over.
fn mismatched(kind: ParamType, found: Option<&Token<'_>>) -> bool {
    let texts = matches!(kind, ParamType::String | ParamType::Texture | ParamType::Bool);
    !texts && matches!(found, Some(Token::Quoted(text)) if !declares(text))
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
