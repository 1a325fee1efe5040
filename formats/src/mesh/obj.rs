//! Wavefront OBJ: positions, texture coordinates, normals and faces; everything else is skipped.
//!
//! All objects and groups become one mesh. A vertex is a distinct (position, uv, normal) triple.
//! Faces of fewer than three corners have no area and are left out.

use std::collections::HashMap;

use super::{Mesh, MeshError, MeshOptions, finish};
use crate::encoding::to_utf8;

/// Reads an OBJ file. Indices may be relative (negative) and may precede what they refer to;
/// `\` at the end of a line continues it.
///
/// # Errors
/// When a line is malformed or an index points nowhere.
pub fn read_obj(bytes: &[u8], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let file = parse(&to_utf8(bytes))?;
    file.check_indices()?;
    Ok(finish(file.index(), options))
}

/// Marks an absent texture coordinate or normal.
const NONE: u32 = u32::MAX;

/// Indices of position, texture coordinate and normal.
type Corner = [u32; 3];

#[derive(Default)]
struct File {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// Three per triangle.
    corners: Vec<Corner>,
    /// The largest index of each kind and its line.
    largest: [Option<(u32, usize)>; 3],
}

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

fn parse(bytes: &[u8]) -> Result<File, MeshError> {
    let mut file = File::default();
    let mut face = Vec::new();
    let mut rest = bytes;
    let mut line = 1;
    while !rest.is_empty() {
        let (statement, lines) = take_statement(&mut rest);
        let mut words = Words(statement);
        match words.next() {
            Some(b"v") => {
                let position = numbers(&mut words, 3, line)?;
                file.positions.push(position);
                if position.iter().any(|c| !c.is_finite()) {
                    return Err(MeshError::Invalid(format!(
                        "vertex {} (line {line}) has a coordinate that is not finite",
                        file.positions.len()
                    )));
                }
            }
            Some(b"vt") => {
                let [u, v, _] = numbers(&mut words, 1, line)?;
                file.uvs.push([u, v]);
            }
            Some(b"vn") => file.normals.push(numbers(&mut words, 3, line)?),
            Some(b"f") => {
                face.clear();
                for word in words {
                    face.push(file.corner(word, line)?);
                }
                for pair in face.windows(2).skip(1) {
                    file.corners.extend([face[0], pair[0], pair[1]]);
                }
            }
            _ => {}
        }
        line += lines;
    }
    Ok(file)
}

/// Cuts one statement off `rest`: up to a line end that no `\` precedes. Also the number of lines.
fn take_statement<'a>(rest: &mut &'a [u8]) -> (&'a [u8], usize) {
    let all = *rest;
    let (mut end, mut lines) = (0, 1);
    loop {
        match all[end..].iter().position(|&byte| byte == b'\n') {
            None => {
                *rest = &[];
                return (all, lines);
            }
            Some(length) => {
                let body = &all[..end + length];
                let body = body.strip_suffix(b"\r").unwrap_or(body);
                end += length + 1;
                if !body.ends_with(b"\\") {
                    *rest = &all[end..];
                    return (body, lines);
                }
                lines += 1;
            }
        }
    }
}

/// Words of a statement, up to a comment.
struct Words<'a>(&'a [u8]);

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let space = |byte: &u8| byte.is_ascii_whitespace() || *byte == b'\\';
        let start = self.0.iter().position(|byte| !space(byte))?;
        let word = &self.0[start..];
        if word[0] == b'#' {
            self.0 = &[];
            return None;
        }
        let length = word.iter().position(space).unwrap_or(word.len());
        self.0 = &word[length..];
        Some(&word[..length])
    }
}

/// Up to three numbers, of which `required` must be present; the others are zero.
fn numbers(words: &mut Words<'_>, required: usize, line: usize) -> Result<[f32; 3], MeshError> {
    let mut values = [0.0; 3];
    for (i, value) in values.iter_mut().enumerate() {
        match words.next() {
            Some(word) => {
                *value = std::str::from_utf8(word)
                    .ok()
                    .and_then(|word| word.parse().ok())
                    .ok_or_else(|| bad_word("a number", word, line))?;
            }
            None if i < required => {
                return Err(MeshError::Invalid(format!(
                    "line {line}: expected {required} numbers, found {i}"
                )));
            }
            None => break,
        }
    }
    Ok(values)
}

fn bad_word(expected: &str, word: &[u8], line: usize) -> MeshError {
    let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
    MeshError::Invalid(format!("line {line}: expected {expected}, found \"{shown}\""))
}

impl File {
    /// Parses `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, word: &[u8], line: usize) -> Result<Corner, MeshError> {
        let malformed = || bad_word("a corner like 1/2/3", word, line);
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [NONE; 3];
        for (kind, part) in word.split(|&byte| byte == b'/').enumerate() {
            if part.is_empty() && (1..3).contains(&kind) {
                continue;
            }
            let slot = corner.get_mut(kind).ok_or_else(malformed)?;
            let number = integer(part).ok_or_else(malformed)?;
            let index = if number > 0 { number - 1 } else { counts[kind] as i64 + number };
            *slot = u32::try_from(index)
                .ok()
                .filter(|&index| number != 0 && index != NONE)
                .ok_or_else(|| self.out_of_range(kind, number, line))?;
            if self.largest[kind].is_none_or(|(largest, _)| *slot > largest) {
                self.largest[kind] = Some((*slot, line));
            }
        }
        Ok(corner)
    }

    fn counts(&self) -> [usize; 3] {
        [self.positions.len(), self.uvs.len(), self.normals.len()]
    }

    fn out_of_range(&self, kind: usize, number: i64, line: usize) -> MeshError {
        let (name, count) = (KINDS[kind], self.counts()[kind]);
        MeshError::Invalid(format!(
            "the face on line {line} refers to {name} {number}, but {count} are defined"
        ))
    }

    fn check_indices(&self) -> Result<(), MeshError> {
        for (kind, count) in self.counts().into_iter().enumerate() {
            if let Some((index, line)) = self.largest[kind]
                && index as usize >= count
            {
                return Err(self.out_of_range(kind, i64::from(index) + 1, line));
            }
        }
        Ok(())
    }

    /// Gives every distinct corner a vertex, in order of first use.
    fn index(self) -> Mesh {
        let mut vertices = Vertices::new(self.positions.len());
        let indices: Vec<u32> = self.corners.iter().map(|&corner| vertices.index(corner)).collect();
        let corners = &vertices.corners;
        let triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let positions = corners.iter().map(|c| self.positions[c[0] as usize]).collect();
        let uvs = match corners.iter().any(|corner| corner[1] != NONE) {
            true => corners.iter().map(|c| get_or_zero(&self.uvs, c[1])).collect(),
            false => Vec::new(),
        };
        let normals = match corners.iter().any(|corner| corner[2] != NONE) {
            true => corners.iter().map(|c| get_or_zero(&self.normals, c[2])).collect(),
            false => Vec::new(),
        };
        Mesh { positions, normals, uvs, triangles, attributes: Vec::new() }
    }
}

fn get_or_zero<const N: usize>(values: &[[f32; N]], index: u32) -> [f32; N] {
    values.get(index as usize).copied().unwrap_or([0.0; N])
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

/// Distinct corners. Each position heads a list of its corners; few have more than a handful, and
/// the rest go into a hash map.
struct Vertices {
    corners: Vec<Corner>,
    /// Per position, the corner added last.
    heads: Vec<u32>,
    /// Per corner, the one added before it at the same position.
    next: Vec<u32>,
    overflow: HashMap<Corner, u32>,
}

const LIST_LIMIT: usize = 32;

impl Vertices {
    fn new(positions: usize) -> Self {
        Vertices {
            corners: Vec::with_capacity(positions),
            heads: vec![NONE; positions],
            next: Vec::with_capacity(positions),
            overflow: HashMap::new(),
        }
    }

    fn index(&mut self, corner: Corner) -> u32 {
        let head = self.heads[corner[0] as usize];
        let mut candidate = head;
        let mut length = 0;
        while candidate != NONE {
            if self.corners[candidate as usize] == corner {
                return candidate;
            }
            candidate = self.next[candidate as usize];
            length += 1;
        }
        let new = self.corners.len() as u32;
        if length >= LIST_LIMIT {
            let index = *self.overflow.entry(corner).or_insert(new);
            if index == new {
                self.corners.push(corner);
                self.next.push(NONE);
            }
            return index;
        }
        self.corners.push(corner);
        self.next.push(head);
        self.heads[corner[0] as usize] = new;
        new
    }
}
