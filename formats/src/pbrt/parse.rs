//! Tokens → directives. A statement that cannot be read is reported and skipped.

use std::ops::Range;

use super::directive::{Argument, DIRECTIVES, Directive, Follows, Param, ParamType, Value, follows};
use super::token::{Cursor, Token};
use super::upgrade::Old;
use crate::diagnostic::{Diagnostic, Span};

/// Reads the directives of one file.
pub(super) fn parse(text: &str, file: u32, old: &mut Old, problems: &mut Vec<Diagnostic>) -> Vec<Directive> {
    let mut parser = Parser { cursor: Cursor::new(text), file, old, problems };
    let mut directives = Vec::new();
    while let Some((token, range)) = parser.cursor.next() {
        let span = parser.span(&range);
        match token {
            Token::Word(name) => match follows(name) {
                Some(grammar) => directives.extend(parser.directive(name, span, grammar)),
                None => {
                    parser.problems.push(unknown_directive(name, span));
                    parser.skip_statement();
                }
            },
            Token::Bad(what) => parser.error(what, span),
            _ => {
                parser.error("expected a directive such as Shape", span);
                parser.skip_statement();
            }
        }
    }
    directives
}

fn unknown_directive(name: &str, span: Span) -> Diagnostic {
    let shown: String = name.chars().take(40).collect();
    let problem = Diagnostic::error(format!("unknown directive `{shown}`"), Some(span));
    problem.suggest(&shown, DIRECTIVES.iter().map(|row| row.0))
}

pub(super) struct Parser<'a, 'p> {
    pub cursor: Cursor<'a>,
    file: u32,
    pub old: &'p mut Old,
    pub problems: &'p mut Vec<Diagnostic>,
}

impl Parser<'_, '_> {
    pub fn span(&self, range: &Range<usize>) -> Span {
        // Files over 4 GiB were refused.
        Span { file: self.file, start: range.start as u32, end: range.end as u32 }
    }

    pub fn here(&self) -> Span {
        let end = self.cursor.text.len();
        let at = self.cursor.position.min(end);
        self.span(&(at..at))
    }

    pub fn error(&mut self, text: impl Into<String>, span: Span) {
        self.problems.push(Diagnostic::error(text, Some(span)));
    }

    /// Skips to the next directive.
    fn skip_statement(&mut self) {
        while let Some(token) = self.cursor.peek() {
            if matches!(token, Token::Word(name) if follows(name).is_some()) {
                return;
            }
            self.cursor.next();
        }
    }

    fn directive(&mut self, name: &str, span: Span, grammar: Follows) -> Option<Directive> {
        let mut directive =
            Directive { name: name.to_owned(), span, arguments: Vec::new(), params: Vec::new() };
        let complete = match grammar {
            Follows::Alone => true,
            Follows::Numbers(count) => self.numbers(&mut directive, count),
            Follows::Texts(least, most) => self.texts(&mut directive, least, most),
            Follows::Entity(count) => {
                let complete = self.texts(&mut directive, count, count);
                if complete {
                    self.params(&mut directive.params);
                }
                complete
            }
            Follows::Word => self.word(&mut directive),
            Follows::Option => self.texts(&mut directive, 1, 1) && self.option_value(&mut directive),
        };
        if !complete {
            self.skip_statement();
        }
        complete.then_some(directive)
    }

    fn numbers(&mut self, directive: &mut Directive, count: usize) -> bool {
        let bracket = self.cursor.peek() == Some(Token::Open);
        if bracket {
            self.cursor.next();
        }
        self.cursor.skip_blank();
        let start = self.cursor.position;
        let mut values: Vec<f64> = Vec::with_capacity(count);
        if !self.numbers_into(&mut values, true, count) {
            return false;
        }
        let span = self.span(&(start..self.cursor.position));
        if values.len() < count {
            let text = format!("{} expects {count} numbers, got {}", directive.name, values.len());
            self.error(text, directive.span);
            return false;
        }
        if bracket && self.cursor.peek() != Some(Token::Close) {
            let here = self.here();
            self.error(format!("{} expects {count} numbers and then a `]`", directive.name), here);
            return false;
        }
        if bracket {
            self.cursor.next();
        }
        directive.arguments.push(Argument { value: Value::Numbers(values), span });
        true
    }

    fn texts(&mut self, directive: &mut Directive, least: usize, most: usize) -> bool {
        while directive.arguments.len() < most {
            // pbrt allows brackets here as well.
            let bracket = self.cursor.peek() == Some(Token::Open);
            let before = self.cursor.position;
            if bracket {
                self.cursor.next();
            }
            match self.cursor.peek() {
                Some(Token::Quoted(_)) => {
                    let Some((Token::Quoted(text), range)) = self.cursor.next() else { return false };
                    let span = self.span(&range);
                    directive.arguments.push(Argument { value: Value::Text(text.into_owned()), span });
                }
                _ => {
                    self.cursor.position = before;
                    break;
                }
            }
            if bracket && self.cursor.peek() == Some(Token::Close) {
                self.cursor.next();
            }
        }
        if directive.arguments.len() >= least {
            return true;
        }
        let wanted = if least == 1 { "a quoted name".to_owned() } else { format!("{least} quoted names") };
        self.error(format!("{} expects {wanted} after it", directive.name), directive.span);
        false
    }

    fn word(&mut self, directive: &mut Directive) -> bool {
        if let Some(Token::Word(_)) = self.cursor.peek()
            && let Some((Token::Word(word), range)) = self.cursor.next()
        {
            let span = self.span(&range);
            directive.arguments.push(Argument { value: Value::Word(word.to_owned()), span });
            return true;
        }
        self.error(format!("{} expects a word after it", directive.name), directive.span);
        false
    }

    fn option_value(&mut self, directive: &mut Directive) -> bool {
        let value = match self.cursor.peek() {
            Some(Token::Word(word)) if follows(word).is_none() => Value::Word(word.to_owned()),
            Some(Token::Quoted(text)) => Value::Text(text.into_owned()),
            _ => {
                self.error("Option expects a name and a value", directive.span);
                return false;
            }
        };
        let Some((_, range)) = self.cursor.next() else { return false };
        let span = self.span(&range);
        directive.arguments.push(Argument { value, span });
        true
    }

    fn params(&mut self, params: &mut Vec<Param>) {
        loop {
            match self.cursor.peek() {
                Some(Token::Quoted(_)) => {}
                Some(Token::Word(name)) if follows(name).is_some() => return,
                None => return,
                Some(Token::Word(name)) if name.starts_with(|c: char| c.is_ascii_uppercase()) => return,
                _ => {
                    let Some((token, range)) = self.cursor.next() else { return };
                    let span = self.span(&range);
                    let text = match token {
                        Token::Bad(what) => what,
                        _ => "expected a parameter such as \"float radius\", or a directive".to_owned(),
                    };
                    self.error(text, span);
                    self.skip_value();
                    continue;
                }
            }
            let Some((Token::Quoted(declared), range)) = self.cursor.next() else { return };
            let span = self.span(&range);
            params.extend(self.param(&declared, span));
        }
    }

    fn param(&mut self, declared: &str, span: Span) -> Option<Param> {
        let mut words = declared.split_ascii_whitespace();
        let (Some(keyword), Some(name)) = (words.next(), words.next()) else {
            self.error(format!("`{declared}` is not a type and a name, as in \"float radius\""), span);
            self.skip_value();
            return None;
        };
        if words.next().is_some() {
            let text = format!("`{declared}`: what follows the name `{name}` is ignored");
            self.problems.push(Diagnostic::warning(text, Some(span)));
        }
        let kind = ParamType::of_keyword(keyword).filter(|kind| *kind != ParamType::Xyz);
        let Some(kind) = kind.or_else(|| self.old.param_type(keyword, span)) else {
            let problem = Diagnostic::error(format!("unknown parameter type `{keyword}`"), Some(span));
            let problem = problem.suggest_or(keyword, ParamType::keywords(), || {
                let all: Vec<_> = ParamType::keywords().collect();
                format!("known: {}", all.join(", "))
            });
            self.old.slipped(problem, "the parameter is ignored");
            self.skip_value();
            return None;
        };
        self.cursor.skip_blank();
        let start = self.cursor.position;
        let values = self.values(kind, name, span);
        let value_span = self.span(&(start..self.cursor.position.max(start)));
        Some(Param { kind, name: name.to_owned(), span, value_span, values })
    }
}
