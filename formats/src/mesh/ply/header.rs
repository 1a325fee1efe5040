//! The header of a PLY file: the elements of the data and their properties.

use crate::mesh::MeshError;

/// How the data after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
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

    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }
}

pub(super) struct Property {
    pub name: String,
    /// Type of the length, for lists.
    pub list: Option<Scalar>,
    pub scalar: Scalar,
}

pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// In bytes.
    pub length: usize,
    /// In lines.
    pub lines: usize,
}

pub(super) fn header(bytes: &[u8]) -> Result<Header, MeshError> {
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
