//! Pictures that a scene asks for beside that of light.

use serde::{Deserialize, Serialize};

use super::Origin;

/// A layer of the file, as Mitsuba's `aov` and `multichannel` ask for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aov {
    /// Where it was written.
    pub origin: Origin,
    /// Of the layer: `name.X` and so on are its channels.
    pub name: String,
    /// What it shows.
    pub kind: AovKind,
}

/// What such a layer shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AovKind {
    /// The picture itself, under the name of the nested integrator.
    Picture,
    /// Diffuse reflectance.
    Albedo,
    /// Length of the camera ray from the near plane on.
    Depth,
    /// In the world.
    Position,
    /// Texture coordinates.
    Uv,
    /// Of the shape itself.
    GeoNormal,
    /// Interpolated, and bent by a bump or normal map.
    ShNormal,
    /// ∂p/∂u.
    DpDu,
    /// ∂p/∂v.
    DpDv,
    /// Change of uv from a pixel to the next to the right.
    DuvDx,
    /// Change of uv from a pixel to the next below.
    DuvDy,
    /// Number of the triangle in its mesh, from 0.
    PrimIndex,
    /// Number of the shape in the scene, from 1.
    ShapeIndex,
    /// Length of the camera ray from the pinhole on (0.6).
    Distance,
    /// In the coordinates of the camera (0.6).
    RelPosition,
    /// Number of the shape in the scene, from 0 (0.6).
    ShapeNumber,
}

impl AovKind {
    /// Types of Mitsuba 3's `aov` in its own words.
    pub const TYPES: [(&str, Self); 12] = [
        ("albedo", Self::Albedo),
        ("depth", Self::Depth),
        ("position", Self::Position),
        ("uv", Self::Uv),
        ("geo_normal", Self::GeoNormal),
        ("sh_normal", Self::ShNormal),
        ("dp_du", Self::DpDu),
        ("dp_dv", Self::DpDv),
        ("duv_dx", Self::DuvDx),
        ("duv_dy", Self::DuvDy),
        ("prim_index", Self::PrimIndex),
        ("shape_index", Self::ShapeIndex),
    ];

    /// Fields of Mitsuba 0.6's `field` in its own words.
    pub const FIELDS: [(&str, Self); 9] = [
        ("position", Self::Position),
        ("relPosition", Self::RelPosition),
        ("distance", Self::Distance),
        ("geoNormal", Self::GeoNormal),
        ("shNormal", Self::ShNormal),
        ("uv", Self::Uv),
        ("albedo", Self::Albedo),
        ("shapeIndex", Self::ShapeNumber),
        ("primIndex", Self::PrimIndex),
    ];

    /// The type of Mitsuba 3, and whether it means just the same; `None` for the picture.
    pub fn mitsuba3(self) -> Option<(&'static str, bool)> {
        let (near, same) = match self {
            Self::Distance => (Self::Depth, false),
            Self::RelPosition => (Self::Position, false),
            Self::ShapeNumber => (Self::ShapeIndex, false),
            own => (own, true),
        };
        Self::TYPES.iter().find(|(_, kind)| *kind == near).map(|(name, _)| (*name, same))
    }
}

/// The coordinates in which pbrt's `gbuffer` film stores places and directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CoordinateSystem {
    /// Those of the camera.
    Camera,
    /// Those of the world.
    World,
}
