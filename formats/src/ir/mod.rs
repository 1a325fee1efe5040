//! The scene as an author wrote it: names, instances, textures by path, colours and units as
//! written, transforms in f64. A plain value: it can be compared, snapshot and written back.
//! Nothing here knows how a scene is rendered, or which language it was read from beyond the
//! conventions that change its meaning ([`SpectrumRule`], [`HideEmitters`]).

mod aov;
mod arena;
mod bsdf;
mod color;
mod emitter;
mod integrator;
mod interface;
mod medium;
mod query;
mod references;
mod sensor;
mod shape;
mod sunsky;
mod table;
mod texture;
mod transform;
mod volume;

use serde::{Deserialize, Serialize};

pub use aov::{Aov, AovKind, CoordinateSystem};
pub use arena::{Arena, Id, Reference, Store, Stored};
pub use bsdf::{
    Bsdf, BsdfFile, BsdfKind, LobeSum, Passage, PerturbedShading, Principled, PrincipledIndex,
    PrincipledThin, WardVariant,
};
pub use color::{Color, ColorSlot, SpectrumRule};
pub use emitter::{Emitter, EmitterKind, EnvironmentMapping, LightImage, SpotFalloff};
pub use integrator::{INTEGRATOR_SETTINGS, Integrator, Scalar, ScalarType, Setting};
pub use interface::{
    Coat, Conductor, ConductorMaterial, Dielectric, Ior, Microfacet, MicrofacetDistribution, Plastic,
    RoughnessRemap, Shadowing,
};
pub(crate) use medium::rounded;
pub use medium::{Coefficients, Medium, MediumEmission, MediumInterface, Phase};
pub use query::{
    Nature, Query, clamps_reflectance, emits, exchanges_numbers, has_passages, panes_pass_in_media,
    passages_count, uses_textures,
};
pub use references::{Uses, canonical, parts};
pub use sensor::{
    ComponentFormat, Crop, Film, Filter, FilterNumber, FilterParameter, Fov, FovAxis, Lens, NamedFilter,
    PixelFormat, Projection, Sampler, Sensor, Tonemap,
};
pub use shape::{
    AreaEmission, InlineMesh, MeshFile, MeshFormat, PartialQuadric, Shape, ShapeGroup, ShapeKind,
};
pub use sunsky::{Day, Place, SunModel, SunPosition, SunSky};
pub use table::{Part, VisitField};
pub use texture::{
    Bitmap, ColorInput, FloatInput, Mapping, MixAmount, NoiseKind, Texture, TextureEncoding, TextureFilter,
    TextureKind, WrapMode,
};
pub use transform::Transform;
pub use volume::{
    Cloud, GridSamples, GridValues, Volume, VolumeData, VolumeFile, VolumeFilter, VolumeFormat, VolumeGrid,
};

use crate::diagnostic::Span;

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// The root of the scene.
    pub origin: Origin,
    /// How its spectra become RGB in its own renderer.
    pub spectrum_rule: SpectrumRule,
    /// How they do in a conversion, if not so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectra_as: Option<SpectrumRule>,
    /// What hiding emitters means to its renderer.
    pub hide_emitters: HideEmitters,
    /// `None` where the scene asks for none.
    pub integrator: Option<Integrator>,
    /// In file order; which one renders is `default_sensor`.
    pub sensors: Vec<Sensor>,
    /// Index in `sensors`.
    pub default_sensor: usize,
    /// Outside of groups, in file order.
    pub shapes: Vec<Shape>,
    /// What instances refer to.
    pub groups: Arena<ShapeGroup>,
    /// What shapes refer to.
    pub bsdfs: Arena<Bsdf>,
    /// What BSDFs and emitters refer to.
    pub textures: Arena<Texture>,
    /// What shapes, emitters and sensors refer to.
    #[serde(default, skip_serializing_if = "Arena::is_empty")]
    pub media: Arena<Medium>,
    /// Without area lamps, in file order.
    pub emitters: Vec<Emitter>,
}

/// What `hide_emitters` does to a lamp's own surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HideEmitters {
    /// Mitsuba before 3.7: the emission is hidden, the surface is not.
    Emission,
    /// Since 3.7: camera rays pass through the lamp.
    Surface,
}

/// Where something was written. Never part of a comparison or a snapshot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin(pub Option<Span>);

impl PartialEq for Origin {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Serialize for Origin {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_unit()
    }
}

impl<'de> Deserialize<'de> for Origin {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <()>::deserialize(deserializer).map(|()| Self(None))
    }
}

table::plain! { Origin, Transform, Fov, FovAxis }
