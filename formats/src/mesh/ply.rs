//! Stanford PLY: ASCII and binary of both byte orders. Polygons become fans; elements and
//! properties other than those of a mesh and its attributes are skipped.

use super::attributes::{Columns, FACE, VERTEX};
use super::{Mesh, MeshError, MeshOptions, check_indices, finish};

/// Reads a PLY file: vertices with `x y z`, optionally `nx ny nz` and one of `u v`, `s t` or
/// `texture_u texture_v`; faces with a list `vertex_index` or `vertex_indices`.
pub fn read_ply(bytes: &[u8], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let header = header(bytes)?;
    let mut source = Source {
        bytes: &bytes[header.length..],
        position: 0,
        start: header.length,
        line: header.lines + 1,
        encoding: header.encoding,
    };
    let mut mesh = Mesh::default();
    for element in &header.elements {
        source.check_claim(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut source, element, &mut mesh)?,
            "face" => read_faces(&mut source, element, &mut mesh)?,
            "tristrips" if element.count > 0 => {
                return Err(MeshError::Unsupported("a PLY file with triangle strips".into()));
            }
            _ => skip(&mut source, element)?,
        }
    }
    check_indices(&mesh)?;
    Ok(finish(mesh, options))
}

/// Attributes of a PLY file that [`read_ply`] leaves out, being of other than one or three numbers, and
/// of how many they are.
pub fn skipped_attributes(bytes: &[u8]) -> Result<Vec<(String, usize)>, MeshError> {
    let mut skipped = Vec::new();
    for element in &header(bytes)?.elements {
        match element.name.as_str() {
            "vertex" => skipped.extend(vertex_columns(element, &targets(element)?).skipped),
            "face" => skipped.extend(face_columns(element).skipped),
            _ => {}
        }
    }
    Ok(skipped)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(name: &str) -> Option<Scalar> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }
}

struct Property {
    name: String,
    /// Type of the length, for lists.
    list: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// In bytes and lines.
    length: usize,
    lines: usize,
}

fn header(bytes: &[u8]) -> Result<Header, MeshError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let (mut length, mut lines) = (0, 0);
    loop {
        let rest = &bytes[length..];
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
            return Err(MeshError::Invalid("the PLY header has no end".into()));
        };
        length += end + 1;
        lines += 1;
        let bad = |what: &str| MeshError::Invalid(format!("line {lines}: {what}"));
        let text = String::from_utf8_lossy(&rest[..end]);
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        match words[..] {
            ["ply"] if lines == 1 => {}
            _ if lines == 1 => return Err(bad("a PLY file starts with the word ply")),
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, "1.0"] => {
                encoding = Some(match name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    _ => return Err(bad(&format!("unknown PLY format \"{name}\""))),
                });
            }
            ["format", ..] => return Err(bad("expected a format and the version 1.0")),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| bad(&format!("bad element count \"{count}\"")))?;
                if matches!(name, "vertex" | "face") && elements.iter().any(|e| e.name == name) {
                    return Err(bad(&format!("element {name} is declared twice")));
                }
                elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", ref kind @ .., name] if matches!(kind.len(), 1 | 3) => {
                let scalar =
                    |name: &str| Scalar::parse(name).ok_or_else(|| bad(&format!("unknown type \"{name}\"")));
                let (list, item) = match *kind {
                    ["list", count, item] => (Some(scalar(count)?), item),
                    [item] => (None, item),
                    _ => return Err(bad("malformed property")),
                };
                let property = Property { name: name.into(), list, scalar: scalar(item)? };
                elements
                    .last_mut()
                    .ok_or_else(|| bad("a property before the first element"))?
                    .properties
                    .push(property);
            }
            ["end_header"] => break,
            _ => return Err(bad(&format!("\"{}\" does not belong in a PLY header", text.trim()))),
        }
    }
    let encoding = encoding.ok_or_else(|| MeshError::Invalid("the PLY header names no format".into()))?;
    Ok(Header { encoding, elements, length, lines })
}

/// Where the values of a vertex go.
#[derive(Clone, Copy)]
enum Target {
    Position(usize),
    Normal(usize),
    Uv(usize),
    Nothing,
}

/// Texture coordinates under the names in use, the best known first.
const UV_NAMES: [[&str; 2]; 4] =
    [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

fn targets(element: &Element) -> Result<Vec<Target>, MeshError> {
    let has = |name: &str| element.properties.iter().any(|p| p.list.is_none() && p.name == name);
    let all = |names: &[&str]| names.iter().all(|name| has(name));
    if !all(&["x", "y", "z"]) {
        return Err(MeshError::Invalid("the PLY vertices lack x, y or z".into()));
    }
    let normals = all(&["nx", "ny", "nz"]);
    let uv_names = UV_NAMES.iter().find(|names| all(*names));
    let find = |names: &[&str], name: &str| names.iter().position(|known| *known == name);
    let target = |property: &Property| {
        let name = property.name.as_str();
        if property.list.is_some() {
            Target::Nothing
        } else if let Some(axis) = find(&["x", "y", "z"], name) {
            Target::Position(axis)
        } else if let (true, Some(axis)) = (normals, find(&["nx", "ny", "nz"], name)) {
            Target::Normal(axis)
        } else if let Some(axis) = uv_names.and_then(|names| find(names, name)) {
            Target::Uv(axis)
        } else {
            Target::Nothing
        }
    };
    Ok(element.properties.iter().map(target).collect())
}

fn vertex_columns(element: &Element, targets: &[Target]) -> Columns {
    let free = element.properties.iter().zip(targets).map(|(p, target)| {
        (p.list.is_none() && matches!(target, Target::Nothing)).then_some(p.name.as_str())
    });
    Columns::new(VERTEX, free)
}

fn face_columns(element: &Element) -> Columns {
    Columns::new(FACE, element.properties.iter().map(|p| p.list.is_none().then_some(p.name.as_str())))
}

fn read_vertices(source: &mut Source<'_>, element: &Element, mesh: &mut Mesh) -> Result<(), MeshError> {
    let targets = targets(element)?;
    let any = |wanted: fn(&Target) -> bool| targets.iter().any(wanted);
    let has_normals = any(|target| matches!(target, Target::Normal(_)));
    let has_uvs = any(|target| matches!(target, Target::Uv(_)));
    let columns = vertex_columns(element, &targets);
    let (mut lists, mut row) = (columns.lists(), columns.row());
    mesh.positions.reserve(element.count);
    for vertex in 0..element.count {
        let (mut position, mut normal, mut uv) = ([0.0; 3], [0.0; 3], [0.0; 2]);
        let mut line = 0;
        for ((property, target), place) in element.properties.iter().zip(&targets).zip(&columns.places) {
            if property.list.is_some() {
                source.skip_property(property)?;
                continue;
            }
            let value = source.number(property.scalar)? as f32;
            match *target {
                Target::Position(axis) => position[axis] = value,
                Target::Normal(axis) => normal[axis] = value,
                Target::Uv(axis) => uv[axis] = value,
                Target::Nothing => {
                    if let Some((attribute, component)) = *place {
                        row[attribute][component] = value;
                    }
                }
            }
            line = source.line;
        }
        if position.iter().any(|c: &f32| !c.is_finite()) {
            let place = match source.encoding {
                Encoding::Ascii => format!(" (line {line})"),
                _ => String::new(),
            };
            return Err(MeshError::Invalid(format!(
                "vertex {vertex}{place} has a coordinate that is not finite"
            )));
        }
        mesh.positions.push(position);
        if has_normals {
            mesh.normals.push(normal);
        }
        if has_uvs {
            mesh.uvs.push(uv);
        }
        columns.push(&mut lists, &row);
    }
    mesh.attributes.append(&mut lists);
    Ok(())
}

fn read_faces(source: &mut Source<'_>, element: &Element, mesh: &mut Mesh) -> Result<(), MeshError> {
    let is_indices = |property: &Property| {
        property.list.is_some() && matches!(property.name.as_str(), "vertex_index" | "vertex_indices")
    };
    if element.count > 0 && !element.properties.iter().any(is_indices) {
        return Err(MeshError::Invalid("the PLY faces lack a list of vertex_indices".into()));
    }
    let columns = face_columns(element);
    let (mut lists, mut row) = (columns.lists(), columns.row());
    let mut corners = Vec::new();
    mesh.triangles.reserve(element.count);
    for _ in 0..element.count {
        let before = mesh.triangles.len();
        for (property, place) in element.properties.iter().zip(&columns.places) {
            if let Some((attribute, component)) = *place {
                row[attribute][component] = source.number(property.scalar)? as f32;
                continue;
            }
            let Some(count) = property.list.filter(|_| is_indices(property)) else {
                source.skip_property(property)?;
                continue;
            };
            let length = source.list_length(count, property.scalar)?;
            corners.clear();
            for _ in 0..length {
                corners.push(source.index(property.scalar)?);
            }
            for pair in corners.windows(2).skip(1) {
                mesh.triangles.push([corners[0], pair[0], pair[1]]);
            }
        }
        // All triangles of a polygon have its values.
        for _ in before..mesh.triangles.len() {
            columns.push(&mut lists, &row);
        }
    }
    mesh.attributes.append(&mut lists);
    Ok(())
}

fn skip(source: &mut Source<'_>, element: &Element) -> Result<(), MeshError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            source.skip_property(property)?;
        }
    }
    Ok(())
}

/// The data after the header.
struct Source<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Length of the header, for messages.
    start: usize,
    /// Current line of an ASCII file.
    line: usize,
    encoding: Encoding,
}

impl<'a> Source<'a> {
    fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    /// Refuses counts that the rest of the file cannot hold, so that they may be reserved.
    fn check_claim(&self, element: &Element) -> Result<(), MeshError> {
        let least = |property: &Property| match self.encoding {
            Encoding::Ascii => 2,
            _ => property.list.unwrap_or(property.scalar).size(),
        };
        let size: usize = element.properties.iter().map(least).sum();
        let needs_data = matches!(element.name.as_str(), "vertex" | "face");
        // The last ASCII value needs no white space after it.
        if (size == 0 && needs_data && element.count > 0)
            || element.count.saturating_mul(size) > self.remaining() + 1
        {
            return Err(MeshError::Invalid(format!(
                "the file is too short for {} elements \"{}\"",
                element.count, element.name
            )));
        }
        Ok(())
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
        if self.encoding == Encoding::Ascii {
            let word = self.word()?;
            return word.parse().map_err(|_| self.bad_word("a number", word));
        }
        let big = self.encoding == Encoding::Big;
        macro_rules! number {
            ($kind:ty) => {{
                let bytes = self.take()?;
                f64::from(if big { <$kind>::from_be_bytes(bytes) } else { <$kind>::from_le_bytes(bytes) })
            }};
        }
        Ok(match scalar {
            Scalar::I8 => number!(i8),
            Scalar::U8 => number!(u8),
            Scalar::I16 => number!(i16),
            Scalar::U16 => number!(u16),
            Scalar::I32 => number!(i32),
            Scalar::U32 => number!(u32),
            Scalar::F32 => number!(f32),
            Scalar::F64 => number!(f64),
        })
    }

    fn index(&mut self, scalar: Scalar) -> Result<u32, MeshError> {
        let value = self.number(scalar)?;
        if value.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(&value) {
            return Ok(value as u32);
        }
        Err(MeshError::Invalid(format!("{}: {value} cannot be a vertex index", self.place())))
    }

    /// Length of a list whose items fit into the rest of the file.
    fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<usize, MeshError> {
        let value = self.number(count)?;
        let item_size = if self.encoding == Encoding::Ascii { 2 } else { item.size() };
        let most = (self.remaining() + 1) / item_size;
        if value.fract() == 0.0 && (0.0..=most as f64).contains(&value) {
            return Ok(value as usize);
        }
        Err(MeshError::Invalid(format!(
            "{}: a list of {value} items does not fit into the file",
            self.place()
        )))
    }

    fn skip_property(&mut self, property: &Property) -> Result<(), MeshError> {
        let count = match property.list {
            Some(count) => self.list_length(count, property.scalar)?,
            None => 1,
        };
        for _ in 0..count {
            self.number(property.scalar)?;
        }
        Ok(())
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let bytes = self.bytes[self.position..].first_chunk::<N>().ok_or_else(|| self.cut_off())?;
        self.position += N;
        Ok(*bytes)
    }

    fn word(&mut self) -> Result<&'a str, MeshError> {
        let rest = &self.bytes[self.position..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace());
        let start = start.ok_or_else(|| self.cut_off())?;
        self.line += rest[..start].iter().filter(|&&byte| byte == b'\n').count();
        let word = &rest[start..];
        let length = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
        self.position += start + length;
        std::str::from_utf8(&word[..length])
            .map_err(|_| MeshError::Invalid(format!("{}: expected a number", self.place())))
    }

    fn bad_word(&self, expected: &str, word: &str) -> MeshError {
        let shown: String = word.chars().take(40).collect();
        MeshError::Invalid(format!("{}: expected {expected}, found \"{shown}\"", self.place()))
    }

    fn cut_off(&self) -> MeshError {
        MeshError::Invalid(format!("the file ends early, at byte {}", self.start + self.bytes.len()))
    }

    fn place(&self) -> String {
        match self.encoding {
            Encoding::Ascii => format!("line {}", self.line),
            _ => format!("byte {}", self.start + self.position),
        }
    }
}
