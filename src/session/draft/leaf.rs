//! The types of which a scene's values are.

use std::any::Any;
use std::sync::Arc;

use caustica_formats::ir::{
    Bitmap, Color, ColorInput, FloatInput, InlineMesh, Ior, LightImage, MeshFile, Transform,
};

use super::array::{Array, ValueError};

macro_rules! leaves {
    ($($(#[$doc:meta])* $Kind:ident($Type:ty)),+ $(,)?) => {
        /// A value of the scene.
        #[derive(Clone)]
        pub enum Leaf {
            $($(#[$doc])* $Kind($Type)),+
        }

        impl Leaf {
            /// The value of a field, if it is one.
            pub fn of(field: &dyn Any) -> Option<Self> {
                $(if let Some(value) = field.downcast_ref::<$Type>() {
                    return Some(Self::$Kind(value.clone()));
                })+
                None
            }

            /// Into a field of the same type.
            pub fn store(self, field: &mut dyn Any) {
                match self {
                    $(Self::$Kind(value) => if let Some(place) = field.downcast_mut::<$Type>() {
                        *place = value;
                    }),+
                }
            }
        }
    };
}

leaves! {
    /// A length, an angle, a factor.
    Number(f64),
    /// 0 or 1.
    Flag(bool),
    /// A place in texture space.
    Pair([f64; 2]),
    /// A place or direction.
    Point([f64; 3]),
    /// From one space to another.
    Matrix(Transform),
    /// The same everywhere.
    Color(Color),
    /// May be a texture.
    ColorInput(ColorInput),
    /// May be a texture.
    FloatInput(FloatInput),
    /// Index of refraction.
    Ior(Ior),
    /// A picture as a texture.
    Bitmap(Bitmap),
    /// A picture as a light.
    Light(LightImage),
    /// A mesh in a file.
    File(MeshFile),
    /// A mesh in the scene file.
    Inline(Arc<InlineMesh>),
}

/// Arrays of a mesh, as parts of its key.
pub const MESH_PARTS: [&str; 4] = [".vertex_positions", ".vertex_normals", ".vertex_texcoords", ".faces"];

impl Leaf {
    /// What is added to the path of the field, for each array that the value is made of.
    pub fn parts(&self) -> &'static [&'static str] {
        match self {
            Self::Bitmap(_) | Self::Light(_) => &[".data"],
            Self::File(_) | Self::Inline(_) => &MESH_PARTS,
            _ => &[""],
        }
    }

    /// Plain numbers; `None` for the others, which need the rest of the scene.
    pub fn numbers(&self) -> Option<Array> {
        Some(match self {
            Self::Number(v) => Array::doubles(&[], [*v]),
            Self::Flag(v) => Array::doubles(&[], [f64::from(u8::from(*v))]),
            Self::Pair(v) => Array::doubles(&[2], *v),
            Self::Point(v) => Array::doubles(&[3], *v),
            Self::Matrix(m) => Array::doubles(&[4, 4], m.0.as_flattened().iter().copied()),
            Self::FloatInput(FloatInput::Value(v)) | Self::Ior(Ior::Value(v)) => Array::doubles(&[], [*v]),
            _ => return None,
        })
    }

    /// The same value with other numbers; `None` where the value is none of plain numbers and colours, or takes
    /// a picture and is given one.
    pub fn with(&self, key: &str, array: &Array) -> Result<Option<Self>, ValueError> {
        let single = || match array.data[..] {
            [v] if array.shape.len() <= 1 => Ok(v),
            _ => Err(ValueError::shape(key, "one number", array)),
        };
        let many = |expected: &[usize], words: &str| {
            if array.shape == expected { Ok(&array.data) } else { Err(ValueError::shape(key, words, array)) }
        };
        Ok(Some(match self {
            Self::Number(_) => Self::Number(single()?),
            Self::Ior(_) => Self::Ior(Ior::Value(single()?)),
            Self::Flag(_) => Self::Flag(single()? != 0.0),
            Self::Pair(_) => {
                let v = many(&[2], "an array of shape (2,)")?;
                Self::Pair([v[0], v[1]])
            }
            Self::Point(_) => {
                let v = many(&[3], "an array of shape (3,)")?;
                Self::Point([v[0], v[1], v[2]])
            }
            Self::Matrix(_) => {
                let v = many(&[4, 4], "a matrix of shape (4, 4)")?;
                Self::Matrix(Transform(std::array::from_fn(|i| std::array::from_fn(|j| v[4 * i + j]))))
            }
            Self::Color(_) => Self::Color(color(key, array, "one number or an array of shape (3,)")?),
            Self::ColorInput(_) if array.shape.len() < 2 => {
                let words = "one number, an array of shape (3,), or a picture of shape (h, w) or (h, w, 3)";
                Self::ColorInput(ColorInput::Color(color(key, array, words)?))
            }
            Self::FloatInput(_) if array.shape.len() < 2 => match array.data[..] {
                [v] => Self::FloatInput(FloatInput::Value(v)),
                _ => return Err(ValueError::shape(key, "one number or a picture of shape (h, w)", array)),
            },
            _ => return Ok(None),
        }))
    }
}

fn color(key: &str, array: &Array, words: &str) -> Result<Color, ValueError> {
    match array.data[..] {
        [v] if array.shape.len() <= 1 => Ok(Color::Rgb([v; 3])),
        [r, g, b] if array.shape.len() == 1 => Ok(Color::Rgb([r, g, b])),
        _ => Err(ValueError::shape(key, words, array)),
    }
}
