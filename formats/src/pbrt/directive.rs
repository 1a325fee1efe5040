//! The parsed form of a file: directives with typed parameters and where each stands.

use crate::diagnostic::Span;

/// A statement of the file.
#[derive(Clone, Debug)]
pub(super) struct Directive {
    pub name: String,
    pub span: Span,
    pub arguments: Vec<Argument>,
    pub params: Vec<Param>,
}

#[derive(Clone, Debug)]
pub(super) struct Argument {
    pub value: Value,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Text(String),
    /// A bare word: `All`, `true`.
    Word(String),
    Numbers(Vec<f64>),
}

/// `"type name" values`.
#[derive(Clone, Debug)]
pub(super) struct Param {
    pub kind: ParamType,
    pub name: String,
    /// The quoted type and name.
    pub span: Span,
    /// The values with their brackets.
    pub value_span: Span,
    pub values: Values,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Floats(Vec<f64>),
    /// Long lists of points, in the precision of a mesh.
    Mesh(Vec<f32>),
    Integers(Vec<i32>),
    Bools(Vec<bool>),
    Texts(Vec<String>),
    /// Reported already.
    Broken,
}

impl Values {
    pub fn len(&self) -> usize {
        match self {
            Self::Floats(v) => v.len(),
            Self::Mesh(v) => v.len(),
            Self::Integers(v) => v.len(),
            Self::Bools(v) => v.len(),
            Self::Texts(v) => v.len(),
            Self::Broken => 0,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ParamType {
    Integer,
    Float,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    Bool,
    String,
    Texture,
    Rgb,
    Blackbody,
    Spectrum,
    /// pbrt-v3 only.
    Xyz,
}

use ParamType as T;

/// Every type keyword of pbrt-v4.
const TYPES: &[(&str, ParamType)] = &[
    ("integer", T::Integer),
    ("float", T::Float),
    ("point2", T::Point2),
    ("vector2", T::Vector2),
    ("point3", T::Point3),
    ("vector3", T::Vector3),
    ("normal", T::Normal),
    ("bool", T::Bool),
    ("string", T::String),
    ("texture", T::Texture),
    ("rgb", T::Rgb),
    ("blackbody", T::Blackbody),
    ("spectrum", T::Spectrum),
    ("xyz", T::Xyz),
];

impl ParamType {
    pub fn of_keyword(word: &str) -> Option<Self> {
        TYPES.iter().find(|row| row.0 == word).map(|row| row.1)
    }

    pub fn keyword(self) -> &'static str {
        TYPES.iter().find(|row| row.1 == self).map_or("", |row| row.0)
    }

    /// The keywords of pbrt-v4.
    pub fn keywords() -> impl Iterator<Item = &'static str> {
        TYPES.iter().map(|row| row.0).filter(|name| *name != "xyz")
    }
}

/// What follows the name of a directive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Follows {
    /// Nothing.
    Alone,
    /// This many numbers, brackets optional.
    Numbers(usize),
    /// Quoted strings, at least and at most so many.
    Texts(usize, usize),
    /// Quoted strings, so many, then parameters.
    Entity(usize),
    /// One bare word.
    Word,
    /// A quoted name, then any one token.
    Option,
}

use Follows as S;

/// Every directive of pbrt-v4.
pub(super) const DIRECTIVES: &[(&str, Follows)] = &[
    ("Accelerator", S::Entity(1)),
    ("ActiveTransform", S::Word),
    ("AreaLightSource", S::Entity(1)),
    ("Attribute", S::Entity(1)),
    ("AttributeBegin", S::Alone),
    ("AttributeEnd", S::Alone),
    ("Camera", S::Entity(1)),
    ("ColorSpace", S::Texts(1, 1)),
    ("ConcatTransform", S::Numbers(16)),
    ("CoordinateSystem", S::Texts(1, 1)),
    ("CoordSysTransform", S::Texts(1, 1)),
    ("Film", S::Entity(1)),
    ("Identity", S::Alone),
    ("Import", S::Texts(1, 1)),
    ("Include", S::Texts(1, 1)),
    ("Integrator", S::Entity(1)),
    ("LightSource", S::Entity(1)),
    ("LookAt", S::Numbers(9)),
    ("MakeNamedMaterial", S::Entity(1)),
    ("MakeNamedMedium", S::Entity(1)),
    ("Material", S::Entity(1)),
    ("MediumInterface", S::Texts(1, 2)),
    ("NamedMaterial", S::Texts(1, 1)),
    ("ObjectBegin", S::Texts(1, 1)),
    ("ObjectEnd", S::Alone),
    ("ObjectInstance", S::Texts(1, 1)),
    ("Option", S::Option),
    ("PixelFilter", S::Entity(1)),
    ("ReverseOrientation", S::Alone),
    ("Rotate", S::Numbers(4)),
    ("Sampler", S::Entity(1)),
    ("Scale", S::Numbers(3)),
    ("Shape", S::Entity(1)),
    ("Texture", S::Entity(3)),
    ("Transform", S::Numbers(16)),
    ("TransformBegin", S::Alone),
    ("TransformEnd", S::Alone),
    ("TransformTimes", S::Numbers(2)),
    ("Translate", S::Numbers(3)),
    ("WorldBegin", S::Alone),
];

/// Directives that older versions have; [`super::upgrade`] says what becomes of them.
pub(super) const OLD_DIRECTIVES: &[(&str, Follows)] = &[
    ("WorldEnd", S::Alone),
    ("Renderer", S::Entity(1)),
    ("SurfaceIntegrator", S::Entity(1)),
    ("VolumeIntegrator", S::Entity(1)),
    ("Volume", S::Entity(1)),
];

/// What follows a directive of this name, in any version.
pub(super) fn follows(name: &str) -> Option<Follows> {
    DIRECTIVES.iter().chain(OLD_DIRECTIVES).find(|row| row.0 == name).map(|row| row.1)
}
