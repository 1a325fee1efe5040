//! The data of a PLY file after its header.

use super::header::{Element, Encoding, Property, Scalar};
use crate::mesh::MeshError;

/// The data after the header.
pub(super) struct Source<'a> {
    pub bytes: &'a [u8],
    pub position: usize,
    /// Length of the header, for messages.
    pub start: usize,
    /// Current line of an ASCII file.
    pub line: usize,
    pub encoding: Encoding,
}

impl<'a> Source<'a> {
    fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    /// Refuses counts that the rest of the file cannot hold, so that it is safe to reserve memory for them.
    pub fn check_claim(&self, element: &Element) -> Result<(), MeshError> {
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

    pub fn number(&mut self, scalar: Scalar) -> Result<f64, MeshError> {
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

    pub fn index(&mut self, scalar: Scalar) -> Result<u32, MeshError> {
        let value = self.number(scalar)?;
        if value.fract() == 0.0 && (0.0..f64::from(u32::MAX)).contains(&value) {
            return Ok(value as u32);
        }
        Err(MeshError::Invalid(format!("{}: {value} cannot be a vertex index", self.place())))
    }

    /// Length of a list whose items fit into the rest of the file.
    pub fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<usize, MeshError> {
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

    pub fn skip_property(&mut self, property: &Property) -> Result<(), MeshError> {
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
