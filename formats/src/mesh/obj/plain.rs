//! The way for files in which nothing needs mending, which most are: every statement is looked at while `tobj` reads
//! it, and handed on as it stands. The first one that might need [`super::mend`] ends the run.

use std::io::{self, BufRead, Read};

/// Longest number: more digits could be more than a number holds.
const LONGEST: usize = 30;

const BLANK: u8 = 1;
const DIGIT: u8 = 2;
/// Digits, signs and points.
const NUMBER: u8 = 4;

/// What a byte may be part of.
const CLASS: [u8; 256] = {
    let mut class = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        class[byte] = match byte as u8 {
            b' ' | b'\t' | b'\r' => BLANK,
            b'0'..=b'9' => DIGIT | NUMBER,
            b'-' | b'+' | b'.' => NUMBER,
            _ => 0,
        };
        byte += 1;
    }
    class
};

/// The first byte from `at` on that is not of a class.
#[inline(always)]
fn past(bytes: &[u8], mut at: usize, class: u8) -> usize {
    while at < bytes.len() && CLASS[usize::from(bytes[at])] & class != 0 {
        at += 1;
    }
    at
}

/// Whether a word ends here.
#[inline(always)]
fn is_end(bytes: &[u8], at: usize) -> bool {
    bytes.get(at).is_none_or(|&byte| byte == b'\n' || CLASS[usize::from(byte)] == BLANK)
}

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
            let start = past(bytes, self.next, BLANK);
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
        let (mut at, mut found) = (start, 0);
        loop {
            at = past(bytes, at, BLANK);
            if at == bytes.len() || bytes[at] == b'\n' {
                return (least..=most).contains(&found).then_some(at);
            }
            let word = at;
            at = past(bytes, at, NUMBER);
            // Other exponents may lead beyond all numbers.
            if bytes[at..].starts_with(b"e-") {
                at = past(bytes, at + 2, DIGIT);
            }
            if at == word || at - word > LONGEST || !is_end(bytes, at) {
                return None;
            }
            found += 1;
        }
    }

    /// The end of a line of three or more corners with positive indices.
    #[inline]
    fn face(&mut self, start: usize) -> Option<usize> {
        let bytes = self.text.as_bytes();
        let (mut at, mut corners) = (start, 0);
        loop {
            at = past(bytes, at, BLANK);
            if at == bytes.len() || bytes[at] == b'\n' {
                return (corners >= 3).then_some(at);
            }
            for kind in 0..3 {
                let index = at;
                at = past(bytes, at, DIGIT);
                if at > index {
                    // Indices count from 1.
                    if bytes[index] == b'0' {
                        return None;
                    }
                    if kind > 0 {
                        self.named[kind - 1] = true;
                    }
                } else if kind != 1 {
                    return None;
                }
                if bytes.get(at) != Some(&b'/') {
                    break;
                }
                at += 1;
            }
            if !is_end(bytes, at) {
                return None;
            }
            corners += 1;
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
        if out.is_empty() {
            // As large as it must be, without the steps of growth.
            *out = self.line.to_owned();
        } else {
            out.push_str(self.line);
        }
        Ok(std::mem::take(&mut self.line).len())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{mended, plain};

    const LINES: &[&str] = &[
        "v 0 0 0",
        "v 1.5 -2 3e-2",
        "  v\t1 2 3 \r",
        "v 0 1 0",
        "v 4 5 6",
        "vt 0.5 0.25",
        "vt .5 1 0",
        "vn 0 0 1",
        "f 1 2 3",
        "f 1/1 2/1 3/2",
        "f 1/ 2/ 3/",
        "f 1//1 2//1 3//1 4//1",
        "f 1/1/1 2/2/1 4/1/1",
        "g one",
        "# a comment",
        "",
    ];
    const ODD: &[&str] = &[
        "v 1 2",
        "v 1 2 3 4",
        "v 1 2 3 0.1 0.2 0.3",
        "v 1e30 1e39 1",
        "v nan 0 0",
        "vt 0.5",
        "vt inf 1",
        "vn 1 2 3 4",
        "f 1 2",
        "f 0 1 2",
        "f 01 2 3",
        "f -1 -2 -3",
        "f 1/2/3/4 2 3",
        "f 1/9 2/9 3/9",
        "f 1 2 99",
        "f 99999999999999999999 1 2",
        "f 1 2 3 # comment",
        "f 1 2 \\",
        "# continued \\",
        "l 1 2",
        "v 1 2 0000000000000000000000000000000000001",
    ];

    /// Whatever is not handed to the mending pass reads as if it had been.
    #[test]
    fn unmended_files_read_as_mended_ones() {
        let mut state = 1_u32;
        let mut next = |n: usize| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as usize % n
        };
        let mut taken = 0;
        for _ in 0..4000 {
            let (count, odd) = (3 + next(14), next(3) == 0);
            let mut lines: Vec<&str> = (0..count).map(|_| LINES[next(LINES.len())]).collect();
            if odd {
                lines.insert(next(count), ODD[next(ODD.len())]);
            }
            let text = lines.join("\n");
            if let Some(models) = plain(&text) {
                let mended = mended(&text, None);
                let mended = mended.unwrap_or_else(|e| panic!("{text}\nis refused: {e}"));
                let parts = |models: &[tobj::Model]| format!("{models:?}");
                assert_eq!(parts(&models), parts(&mended), "{text}");
                taken += usize::from(!models.is_empty());
            }
        }
        assert!(taken > 200, "only {taken} files had faces and nothing to mend");
        for odd in ODD.iter().filter(|line| !line.starts_with(['l', '#'])) {
            assert!(plain(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\n{odd}\n")).is_none(), "{odd}");
        }
    }
}
