//! Objects and their entries, before any plugin is interpreted.

use crate::diagnostic::Span;
use crate::ir::{Color, Transform};

/// What an object is used for; the element name decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Class {
    Scene,
    Bsdf,
    Emitter,
    Film,
    Integrator,
    Medium,
    Phase,
    Rfilter,
    Sampler,
    Sensor,
    Shape,
    Spectrum,
    Subsurface,
    Texture,
    Volume,
    /// 0.6 `<null id=…>`: an empty thing that may be referred to.
    Null,
}

const CLASSES: &[(&str, Class)] = &[
    ("scene", Class::Scene),
    ("bsdf", Class::Bsdf),
    ("emitter", Class::Emitter),
    ("film", Class::Film),
    ("integrator", Class::Integrator),
    ("medium", Class::Medium),
    ("phase", Class::Phase),
    ("rfilter", Class::Rfilter),
    ("sampler", Class::Sampler),
    ("sensor", Class::Sensor),
    ("shape", Class::Shape),
    ("spectrum", Class::Spectrum),
    ("subsurface", Class::Subsurface),
    ("texture", Class::Texture),
    ("volume", Class::Volume),
    ("null", Class::Null),
];

impl Class {
    pub fn of_tag(tag: &str) -> Option<Self> {
        CLASSES.iter().find(|(name, _)| *name == tag).map(|(_, class)| *class)
    }

    pub fn name(self) -> &'static str {
        CLASSES.iter().find(|(_, class)| *class == self).map_or("object", |(name, _)| name)
    }
}

/// Index into the object list.
pub(super) type ObjectIndex = usize;

#[derive(Clone, Debug)]
pub(super) struct Object {
    pub class: Class,
    /// Plugin name in lower case; empty when missing or broken (which was reported).
    pub plugin: String,
    /// The `type` as written, or the tag.
    pub span: Span,
    pub id: Option<String>,
    pub entries: Vec<Entry>,
    /// Referred to by something, not only defined at the top level of the scene.
    pub used: bool,
    /// The root element's version of its file was below 2.
    pub camel_case: bool,
}

/// A parameter or nested object.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// snake_case; `None` for an object without name.
    pub name: Option<String>,
    /// The name as the file has it, where that is another.
    pub spelling: Option<String>,
    /// As written.
    pub name_span: Span,
    /// What to point at for its value.
    pub span: Span,
    pub value: Value,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    Boolean(bool),
    Integer(i64),
    Float(f64),
    String(String),
    Point([f64; 3]),
    Vector([f64; 3]),
    Color {
        color: Color,
        tag: &'static str,
    },
    Transform(Transform),
    Object(ObjectIndex),
    /// A reference still to be resolved.
    Reference(String),
    /// Reported already.
    Broken,
}

impl Value {
    /// With article, for "wants …, got …".
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Boolean(_) => "a boolean",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a float",
            Self::String(_) => "a string",
            Self::Point(_) => "a point",
            Self::Vector(_) => "a vector",
            Self::Color { tag, .. } => match *tag {
                "rgb" => "an rgb colour",
                "srgb" => "an srgb colour",
                "blackbody" => "a blackbody",
                _ => "a spectrum",
            },
            Self::Transform(_) => "a transform",
            Self::Object(_) | Self::Reference(_) => "an object",
            Self::Broken => "nothing",
        }
    }
}
