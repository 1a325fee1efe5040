//! Wavefront OBJ, read with `tobj` after a pass that mends what it cannot read.
//!
//! All objects and groups become one mesh, or one mesh for each material as Mitsuba 0.6 has them. A vertex is a
//! distinct (position, uv, normal) triple. Faces of fewer than three corners have no area and are left out.

mod mend;
mod mtl;
mod parts;
mod plain;

use std::borrow::Cow;

use tobj::{LoadError, LoadOptions};

use super::{Mesh, MeshError, MeshOptions, finish};
use crate::encoding::to_utf8;
use mend::{Mended, Task};
use plain::Plain;

pub use mtl::{ObjMaterial, read_mtl};
pub use parts::{ObjParts, obj_parts};

/// Reads an OBJ file. Indices may be relative (negative) and may precede what they refer to;
/// `\` at the end of a line continues it.
///
/// # Errors
/// When a line is malformed or an index points nowhere.
pub fn read_obj(bytes: &[u8], options: &MeshOptions) -> Result<Mesh, MeshError> {
    Ok(finish(read(bytes, None)?, options))
}

/// The faces of an OBJ file that have the material at `index` of [`ObjParts::materials`]. Vertices are shared inside
/// of a group and not between groups, as in Mitsuba 0.6.
///
/// # Errors
/// As [`read_obj`].
pub fn read_obj_part(bytes: &[u8], index: u32, options: &MeshOptions) -> Result<Mesh, MeshError> {
    let parts = obj_parts(bytes);
    let name = parts.materials.get(index as usize).ok_or_else(|| {
        MeshError::Invalid(format!(
            "the file has {} materials; there is none with index {index}",
            parts.materials.len()
        ))
    })?;
    Ok(finish(read(bytes, Some(name))?, options))
}

fn read(bytes: &[u8], material: Option<&str>) -> Result<Mesh, MeshError> {
    let bytes = to_utf8(bytes);
    let text = text(&bytes);
    let unmended = if material.is_none() { plain(&text) } else { None };
    let models = unmended.map_or_else(|| mended(&text, material), Ok)?;
    let mut mesh = Mesh::default();
    for model in models {
        join(&mut mesh, model.mesh);
    }
    Ok(mesh)
}

/// The text without a copy if all of it is readable.
fn text(bytes: &[u8]) -> Cow<'_, str> {
    std::str::from_utf8(bytes).map_or_else(|_| String::from_utf8_lossy(bytes), Cow::Borrowed)
}

const OPTIONS: LoadOptions =
    LoadOptions { triangulate: true, single_index: true, ignore_points: false, ignore_lines: false };

/// `None` where something may need mending.
fn plain(text: &str) -> Option<Vec<tobj::Model>> {
    let mut plain = Plain::new(text);
    let (models, _) = tobj::load_obj_buf(&mut plain, &OPTIONS, |_| Err(LoadError::GenericFailure)).ok()?;
    plain.checked(models)
}

fn mended(text: &str, material: Option<&str>) -> Result<Vec<tobj::Model>, MeshError> {
    let mut task = Task::new(material);
    let models = load(text, &mut task)?;
    if task.fill() { load(text, &mut task) } else { Ok(models) }
}

/// One run of `tobj` over the mended statements; what it finds out about the faces is kept in `task`.
fn load(text: &str, task: &mut Task<'_>) -> Result<Vec<tobj::Model>, MeshError> {
    let mut mended = Mended::new(text, task);
    let loaded = tobj::load_obj_buf(&mut mended, &OPTIONS, |_| Err(LoadError::GenericFailure));
    Ok(mended.checked(loaded)?.0)
}

fn join(mesh: &mut Mesh, part: tobj::Mesh) {
    let before = mesh.positions.len() as u32;
    let positions = part.positions.as_chunks::<3>().0;
    if before == 0 {
        mesh.positions = positions.to_vec();
        mesh.uvs = part.texcoords.as_chunks::<2>().0.to_vec();
        mesh.normals = part.normals.as_chunks::<3>().0.to_vec();
        mesh.triangles = part.indices.as_chunks::<3>().0.to_vec();
        return;
    }
    mesh.positions.extend_from_slice(positions);
    mesh.uvs.extend_from_slice(part.texcoords.as_chunks::<2>().0);
    mesh.normals.extend_from_slice(part.normals.as_chunks::<3>().0);
    mesh.triangles.extend(part.indices.as_chunks::<3>().0.iter().map(|t| t.map(|i| i + before)));
}

/// Cuts one statement off `rest`: up to a line end that no `\` precedes. Also the number of lines.
fn take_statement<'a>(rest: &mut &'a str) -> (&'a str, usize) {
    let all = *rest;
    let (mut end, mut lines) = (0, 1);
    loop {
        let Some(length) = all[end..].find('\n') else {
            *rest = "";
            return (all, lines);
        };
        let body = &all[..end + length];
        let body = body.strip_suffix('\r').unwrap_or(body);
        end += length + 1;
        if !body.ends_with('\\') {
            *rest = &all[end..];
            return (body, lines);
        }
        lines += 1;
    }
}

/// Bytes between words.
const SPACE: [bool; 256] = {
    let mut space = [false; 256];
    let mut byte = 0;
    while byte < 256 {
        space[byte] = (byte as u8).is_ascii_whitespace() || byte as u8 == b'\\';
        byte += 1;
    }
    space
};

/// Words of a statement, up to a comment; a `\` separates words as a blank does.
struct Words<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a str;

    #[inline]
    fn next(&mut self) -> Option<&'a str> {
        let space = |byte: u8| SPACE[usize::from(byte)];
        let bytes = self.text.as_bytes();
        let mut start = self.at;
        while start < bytes.len() && space(bytes[start]) {
            start += 1;
        }
        if start == bytes.len() || bytes[start] == b'#' {
            self.at = bytes.len();
            return None;
        }
        let mut end = start + 1;
        while end < bytes.len() && !space(bytes[end]) {
            end += 1;
        }
        self.at = end;
        Some(&self.text[start..end])
    }
}
