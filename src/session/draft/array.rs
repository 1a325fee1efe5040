//! Numbers by shape, and why one cannot be read or set.

use caustica_formats::diagnostic::nearest;
use thiserror::Error;

/// What the numbers of an [`Array`] are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberKind {
    /// 64-bit floats.
    Double,
    /// 32-bit floats, of vertices and pictures.
    Single,
    /// 32-bit whole numbers from 0.
    Index,
}

/// Numbers in rows: the last index counts fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Length of each dimension; nothing for a single number.
    pub shape: Vec<usize>,
    /// As many as the product of `shape`.
    pub data: Vec<f64>,
    /// In what precision they are kept.
    pub kind: NumberKind,
}

impl Array {
    /// 64-bit floats.
    pub(super) fn doubles(shape: &[usize], data: impl IntoIterator<Item = f64>) -> Self {
        Self { shape: shape.to_vec(), data: data.into_iter().collect(), kind: NumberKind::Double }
    }

    /// Rows of 32-bit floats.
    pub(super) fn rows<const N: usize>(rows: &[[f32; N]]) -> Self {
        let data = rows.as_flattened().iter().map(|v| f64::from(*v)).collect();
        Self { shape: vec![rows.len(), N], data, kind: NumberKind::Single }
    }

    /// The numbers as rows of `N`, where they have that shape.
    pub(super) fn as_rows<const N: usize>(&self) -> Option<&[[f64; N]]> {
        let (rows, rest) = self.data.as_chunks::<N>();
        (self.shape == [rows.len(), N] && rest.is_empty()).then_some(rows)
    }
}

/// Why a value of a scene cannot be read or changed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ValueError {
    /// The scene has no such value.
    #[error("the scene has no value `{key}`{}", hint(.nearest))]
    Unknown {
        /// As it was asked for.
        key: String,
        /// A key that was probably meant.
        nearest: Option<String>,
    },
    /// The numbers have another shape than the value can have.
    #[error("`{key}` takes {expected}, not an array of shape {found:?}")]
    Shape {
        /// The value.
        key: String,
        /// In words.
        expected: String,
        /// Of the numbers.
        found: Vec<usize>,
    },
    /// The numbers themselves are wrong.
    #[error("`{key}`: {what}")]
    Invalid {
        /// The value.
        key: String,
        /// What is wrong.
        what: String,
    },
}

fn hint(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

impl ValueError {
    pub(super) fn unknown(key: &str, known: &[String]) -> Self {
        let nearest = nearest(key, known.iter().map(String::as_str)).map(str::to_owned);
        Self::Unknown { key: key.to_owned(), nearest }
    }

    pub(super) fn shape(key: &str, expected: impl Into<String>, found: &Array) -> Self {
        Self::Shape { key: key.to_owned(), expected: expected.into(), found: found.shape.clone() }
    }

    pub(super) fn invalid(key: &str, what: impl ToString) -> Self {
        Self::Invalid { key: key.to_owned(), what: what.to_string() }
    }
}
