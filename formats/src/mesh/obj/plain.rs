//! The way for files in which nothing needs mending, which most are: every statement is looked at while `tobj` reads
//! it, and handed on as it stands. The first one that might need [`super::mend`] ends the run.

use std::io::{self, BufRead, Read};

/// Longest number: more digits could be more than a number holds.
const LONGEST: usize = 30;

/// What a byte may be part of.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    Blank,
    Digit,
    Sign,
    Exponent,
    Slash,
    End,
    Other,
}

const CLASS: [Class; 256] = {
    let mut class = [Class::Other; 256];
    let mut byte = 0;
    while byte < 256 {
        class[byte] = match byte as u8 {
            b' ' | b'\t' | b'\r' => Class::Blank,
            b'0'..=b'9' => Class::Digit,
            b'-' | b'+' | b'.' => Class::Sign,
            b'e' => Class::Exponent,
            b'/' => Class::Slash,
            b'\n' => Class::End,
            _ => Class::Other,
        };
        byte += 1;
    }
    class
};

/// Hands out the statements of vertices and faces.
pub(super) struct Plain<'a> {
    text: &'a str,
    /// Where the next line begins.
    next: usize,
    /// The part of the present line that was not taken.
    line: &'a str,
    /// Something may need mending.
    odd: bool,
    /// Whether there are texture coordinates, and normals.
    defined: [bool; 2],
    /// Whether a face names a texture coordinate, and a normal.
    named: [bool; 2],
}

impl<'a> Plain<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { text, next: 0, line: "", odd: false, defined: [false; 2], named: [false; 2] }
    }

    /// What `tobj` loaded, if the file was plain and all vertices have the same parts.
    pub fn checked(&self, models: Vec<tobj::Model>) -> Option<Vec<tobj::Model>> {
        // `tobj` overlooks indices into nothing, and keeps what some vertices lack for the others.
        let into_nothing = (0..2).any(|i| self.named[i] && !self.defined[i]);
        let whole = |model: &tobj::Model| {
            let vertices = model.mesh.positions.len() / 3;
            let whole = |values: &[f32], each: usize| values.is_empty() || values.len() == each * vertices;
            whole(&model.mesh.texcoords, 2) && whole(&model.mesh.normals, 3)
        };
        (!self.odd && !into_nothing && models.iter().all(whole)).then_some(models)
    }

    /// Goes on to the next statement that `tobj` is to read; an empty one is the end.
    fn advance(&mut self) {
        self.line = "";
        let bytes = self.text.as_bytes();
        while self.next < bytes.len() && !self.odd {
            let mut start = self.next;
            while start < bytes.len() && CLASS[usize::from(bytes[start])] == Class::Blank {
                start += 1;
            }
            let is = |at: usize, byte: u8| bytes.get(at) == Some(&byte);
            let blank = |at: usize| bytes.get(at).is_some_and(|b| matches!(b, b' ' | b'\t'));
            let end = match bytes.get(start) {
                Some(b'v') if blank(start + 1) => self.numbers(start + 1, 3, 3),
                Some(b'v') if is(start + 1, b'n') && blank(start + 2) => {
                    self.defined[1] = true;
                    self.numbers(start + 2, 3, 3)
                }
                Some(b'v') if is(start + 1, b't') && blank(start + 2) => {
                    self.defined[0] = true;
                    self.numbers(start + 2, 2, 3)
                }
                Some(b'f') if blank(start + 1) => self.face(start + 1),
                _ => {
                    self.skip(start);
                    continue;
                }
            };
            match end {
                Some(end) => {
                    self.next = (end + 1).min(bytes.len());
                    self.line = &self.text[start..self.next];
                    return;
                }
                None => self.odd = true,
            }
        }
    }

    /// Passes over a statement of another kind, unless it goes on in the next line.
    fn skip(&mut self, start: usize) {
        let bytes = &self.text.as_bytes()[start..];
        let length = bytes.iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len());
        self.odd |= bytes[..length].trim_ascii_end().ends_with(b"\\");
        self.next = (start + length + 1).min(self.text.len());
    }

    /// The end of a line of so many finite numbers.
    #[inline]
    fn numbers(&self, start: usize, least: usize, most: usize) -> Option<usize> {
        let bytes = self.text.as_bytes();
        let (mut at, mut found, mut length) = (start, 0, 0);
        loop {
            let class = bytes.get(at).map_or(Class::End, |&byte| CLASS[usize::from(byte)]);
            match class {
                Class::Digit | Class::Sign => length += 1,
                // Other exponents may lead beyond all numbers.
                Class::Exponent if bytes.get(at + 1) == Some(&b'-') => length += 1,
                Class::Blank | Class::End => {
                    found += usize::from(length > 0);
                    if length > LONGEST {
                        return None;
                    }
                    length = 0;
                    if class == Class::End {
                        return (least..=most).contains(&found).then_some(at);
                    }
                }
                Class::Exponent | Class::Slash | Class::Other => return None,
            }
            at += 1;
        }
    }

    /// The end of a line of three or more corners with positive indices.
    #[inline]
    fn face(&mut self, start: usize) -> Option<usize> {
        let bytes = self.text.as_bytes();
        let (mut at, mut corners, mut slashes) = (start, 0, 0);
        let mut before = Class::Blank;
        loop {
            let class = bytes.get(at).map_or(Class::End, |&byte| CLASS[usize::from(byte)]);
            match class {
                Class::Digit => {
                    if before != Class::Digit {
                        corners += usize::from(before == Class::Blank);
                        // Indices count from 1.
                        if bytes[at] == b'0' {
                            return None;
                        }
                        if slashes > 0 {
                            *self.named.get_mut(slashes - 1)? = true;
                        }
                    }
                }
                Class::Slash if before != Class::Blank => slashes += 1,
                Class::Blank | Class::End => {
                    slashes = 0;
                    if class == Class::End {
                        return (corners >= 3).then_some(at);
                    }
                }
                Class::Slash | Class::Sign | Class::Exponent | Class::Other => return None,
            }
            before = class;
            at += 1;
        }
    }
}

impl Read for Plain<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let length = self.fill_buf()?.read(out)?;
        self.consume(length);
        Ok(length)
    }
}

impl BufRead for Plain<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.line.is_empty() {
            self.advance();
        }
        Ok(self.line.as_bytes())
    }

    fn consume(&mut self, amount: usize) {
        self.line = &self.line[amount..];
    }

    /// A whole line at once: `tobj` reads nothing else.
    fn read_line(&mut self, out: &mut String) -> io::Result<usize> {
        self.fill_buf()?;
        out.push_str(self.line);
        Ok(std::mem::take(&mut self.line).len())
    }
}
