//! The pass before `tobj`: statement by statement, what it would stumble over is mended or refused by line.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{self, BufRead, Read};

use super::parts::name;
use super::{Words, take_statement};
use crate::mesh::MeshError;

/// Position, texture coordinate, normal.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// What is to be read, and what a run has found out about the faces.
#[derive(Default)]
pub(super) struct Task<'a> {
    /// Only faces with this material, group by group.
    pub material: Option<&'a str>,
    /// Whether there are corners with and without texture coordinate, and normal.
    with: [bool; 2],
    without: [bool; 2],
    /// Texture coordinate and normal are made up for corners that lack theirs.
    fill: [bool; 2],
}

impl<'a> Task<'a> {
    /// All faces, or those with a material.
    pub fn new(material: Option<&'a str>) -> Self {
        Self { material, ..Self::default() }
    }

    /// Whether another run is needed, in which corners without texture coordinate or normal get zeros: `tobj` keeps
    /// either for every vertex or for none.
    pub fn fill(&mut self) -> bool {
        self.fill = [0, 1].map(|i| self.with[i] && self.without[i]);
        self.fill.contains(&true)
    }
}

/// Marks an absent texture coordinate or normal.
const NONE: u32 = u32::MAX;

/// The mended statements, each handed out as a line.
pub(super) struct Mended<'a, 't, 'm> {
    rest: &'a str,
    task: &'t mut Task<'m>,
    current: Cow<'a, str>,
    /// How much of `current` was taken.
    at: usize,
    line: usize,
    next_line: usize,
    counts: [usize; 3],
    /// The largest index of each kind and its line.
    largest: [Option<(u32, usize)>; 3],
    /// Faces have the wanted material.
    wanted: bool,
    corners: Vec<[u32; 3]>,
    error: Option<MeshError>,
}

impl<'a, 't, 'm> Mended<'a, 't, 'm> {
    pub fn new(text: &'a str, task: &'t mut Task<'m>) -> Self {
        let zeros = match task.fill {
            [true, true] => "vt 0 0\nvn 0 0 0",
            [true, false] => "vt 0 0",
            [false, true] => "vn 0 0 0",
            [false, false] => "",
        };
        let wanted = task.material.is_none_or(str::is_empty);
        let current = Cow::Borrowed(zeros);
        let (line, next_line, counts, largest) = (1, 1, [0; 3], [None; 3]);
        let corners = Vec::new();
        Self {
            rest: text,
            task,
            current,
            at: 0,
            line,
            next_line,
            counts,
            largest,
            wanted,
            corners,
            error: None,
        }
    }

    /// What was found wrong, now that everything was read; `loaded` is what `tobj` says.
    pub fn checked<T>(mut self, loaded: Result<T, tobj::LoadError>) -> Result<T, MeshError> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        let failed = loaded.is_err() && !self.rest.is_empty();
        for (kind, count) in self.counts.into_iter().enumerate().filter(|_| !failed) {
            if let Some((index, line)) = self.largest[kind]
                && index as usize >= count
            {
                return Err(self.out_of_range(kind, i64::from(index) + 1, line));
            }
        }
        loaded.map_err(|e| {
            let bad = Words::new(&self.current).skip(1).find(|word| word.parse::<f32>().is_err());
            bad.map_or_else(
                || MeshError::Invalid(format!("line {}: {e}", self.line)),
                |word| bad_word("a number", word, self.line),
            )
        })
    }

    /// Goes on to the next statement that `tobj` is to read; an empty one is the end.
    fn advance(&mut self) {
        (self.current, self.at) = (Cow::Borrowed(""), 0);
        while !self.rest.is_empty() && self.error.is_none() {
            let (statement, lines) = take_statement(&mut self.rest);
            self.line = self.next_line;
            self.next_line += lines;
            match self.mend(statement) {
                Ok(Some(mended)) => {
                    self.current = mended;
                    return;
                }
                Ok(None) => {}
                Err(error) => self.error = Some(error),
            }
        }
    }

    fn mend(&mut self, statement: &'a str) -> Result<Option<Cow<'a, str>>, MeshError> {
        let mut words = Words::new(statement);
        match words.next() {
            Some("v") => self.numbers(statement, words, 0, [3, 3]).map(Some),
            Some("vt") => self.numbers(statement, words, 1, [1, 2]).map(Some),
            Some("vn") => self.numbers(statement, words, 2, [3, 3]).map(Some),
            Some("f") => self.face(statement, words),
            // `tobj` ends a mesh at a group, and knows no materials here.
            Some("g") if self.task.material.is_some() => Ok(Some(Cow::Borrowed("g"))),
            Some("usemtl") if self.task.material.is_some() => {
                self.wanted = self.task.material == Some(&name(statement));
                Ok(Some(Cow::Borrowed("g")))
            }
            _ => Ok(None),
        }
    }

    /// A statement of numbers, of which some are required and some are kept; `tobj` has its own meaning for more.
    fn numbers(
        &mut self,
        statement: &'a str,
        mut words: Words<'a>,
        kind: usize,
        [required, kept]: [usize; 2],
    ) -> Result<Cow<'a, str>, MeshError> {
        self.counts[kind] += 1;
        let mut end = words.at;
        let mut found = 0;
        while found < 3 {
            let Some(word) = words.next() else { break };
            if !is_plain(word) {
                self.odd_number(word, kind)?;
            }
            found += 1;
            if found <= kept {
                end = words.at;
            }
        }
        if found < required {
            let text = format!("line {}: expected {required} numbers, found {found}", self.line);
            return Err(MeshError::Invalid(text));
        }
        let taken = &statement[..end];
        Ok(if found < kept { Cow::Owned(format!("{taken} 0")) } else { without_breaks(taken) })
    }

    /// Refuses what is no number, and positions that are not finite.
    #[cold]
    fn odd_number(&self, word: &str, kind: usize) -> Result<(), MeshError> {
        let value: f32 = word.parse().map_err(|_| bad_word("a number", word, self.line))?;
        if kind == 0 && !value.is_finite() {
            return Err(MeshError::Invalid(format!(
                "vertex {} (line {}) has a coordinate that is not finite",
                self.counts[0], self.line
            )));
        }
        Ok(())
    }

    fn face(&mut self, statement: &'a str, mut words: Words<'a>) -> Result<Option<Cow<'a, str>>, MeshError> {
        let mut end = 0;
        self.corners.clear();
        while let Some(word) = words.next() {
            let corner = self.corner(word)?;
            self.corners.push(corner);
            end = words.at;
        }
        if self.corners.len() < 3 || !self.wanted {
            return Ok(None);
        }
        for i in 0..2 {
            self.task.with[i] |= self.corners.iter().any(|corner| corner[i + 1] != NONE);
            self.task.without[i] |= self.corners.iter().any(|corner| corner[i + 1] == NONE);
        }
        if self.task.fill == [false; 2] {
            return Ok(Some(without_breaks(&statement[..end])));
        }
        Ok(Some(Cow::Owned(self.filled())))
    }

    /// The face with zeros, which stand before all others, where a texture coordinate or normal is absent.
    fn filled(&self) -> String {
        let mut out = "f".to_owned();
        for corner in &self.corners {
            let number = |kind: usize| match (self.task.fill[kind - 1], corner[kind]) {
                (true, NONE) => "1".to_owned(),
                (true, index) => (u64::from(index) + 2).to_string(),
                (false, NONE) => String::new(),
                (false, index) => (u64::from(index) + 1).to_string(),
            };
            let position = u64::from(corner[0]) + 1;
            write!(out, " {position}/{}/{}", number(1), number(2)).expect("a string takes all");
        }
        out
    }

    /// Indices from 0 of `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, word: &str) -> Result<[u32; 3], MeshError> {
        let malformed = || bad_word("a corner like 1/2/3", word, self.line);
        let mut corner = [NONE; 3];
        for (kind, part) in word.as_bytes().split(|&byte| byte == b'/').enumerate() {
            if part.is_empty() && (1..3).contains(&kind) {
                continue;
            }
            let slot = corner.get_mut(kind).ok_or_else(malformed)?;
            let number = integer(part).ok_or_else(malformed)?;
            let index = if number > 0 { number - 1 } else { self.counts[kind] as i64 + number };
            *slot = u32::try_from(index)
                .ok()
                .filter(|&index| number != 0 && index != NONE)
                .ok_or_else(|| self.out_of_range(kind, number, self.line))?;
            if self.largest[kind].is_none_or(|(largest, _)| *slot > largest) {
                self.largest[kind] = Some((*slot, self.line));
            }
        }
        Ok(corner)
    }

    fn out_of_range(&self, kind: usize, number: i64, line: usize) -> MeshError {
        let (name, count) = (KINDS[kind], self.counts[kind]);
        MeshError::Invalid(format!(
            "the face on line {line} refers to {name} {number}, but {count} are defined"
        ))
    }
}

impl Read for Mended<'_, '_, '_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let length = self.fill_buf()?.read(out)?;
        self.consume(length);
        Ok(length)
    }
}

impl BufRead for Mended<'_, '_, '_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.at == self.current.len() {
            self.advance();
        }
        Ok(&self.current.as_bytes()[self.at..])
    }

    fn consume(&mut self, amount: usize) {
        self.at += amount;
    }

    /// A whole line at once: `tobj` reads nothing else.
    fn read_line(&mut self, out: &mut String) -> io::Result<usize> {
        if self.at == self.current.len() {
            self.advance();
        }
        let rest = &self.current[self.at..];
        let line = rest.split_inclusive('\n').next().unwrap_or_default();
        out.push_str(line);
        self.at += line.len();
        Ok(line.len())
    }
}

/// Digits, points and signs, not so many that they could be more than a number holds.
#[inline]
fn is_plain(word: &str) -> bool {
    word.len() <= 30 && word.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+'))
}

/// With blanks in place of the breaks of continued lines.
fn without_breaks(statement: &str) -> Cow<'_, str> {
    if !statement.as_bytes().contains(&b'\\') {
        return Cow::Borrowed(statement);
    }
    let words: Vec<&str> = Words::new(statement).collect();
    Cow::Owned(words.join(" "))
}

fn bad_word(expected: &str, word: &str, line: usize) -> MeshError {
    let shown: String = word.chars().take(40).collect();
    MeshError::Invalid(format!("line {line}: expected {expected}, found \"{shown}\""))
}

/// Decimal integer with an optional sign; anything beyond 32 bits saturates far out of range.
fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0_i64;
    for digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = (value * 10 + i64::from(digit - b'0')).min(1 << 40);
    }
    Some(if negative { -value } else { value })
}
