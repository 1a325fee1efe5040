//! Emitters that are not shapes; area lamps are [`super::AreaEmission`].

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Color, ColorInput, Fov, FovAxis, Id, Origin, Texture, TextureEncoding, Transform};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Emitter {
    pub name: Option<String>,
    pub origin: Origin,
    pub kind: EmitterKind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum EmitterKind {
    /// W·sr⁻¹ per channel at `position`.
    Point { position: [f64; 3], intensity: Color },
    /// Along local +Z: 1 up to `beam_width`, then falling to 0 at `cutoff_angle` (degrees).
    Spot {
        to_world: Transform,
        intensity: Color,
        cutoff_angle: f64,
        beam_width: f64,
        falloff: SpotFalloff,
        texture: Option<Id<Texture>>,
    },
    /// `direction` of travel; irradiance on a plane perpendicular to it.
    Directional { direction: [f64; 3], irradiance: Color },
    /// The same radiance from everywhere.
    Constant { radiance: Color },
    /// Radiance from an image around the scene.
    Environment { to_world: Transform, image: LightImage, mapping: EnvironmentMapping },
    /// An image thrown from a point along local +Z, as a slide projector does; irradiance on the plane
    /// z = 1, times π in Mitsuba's convention.
    Projector { to_world: Transform, irradiance: ColorInput, scale: f64, fov: Fov, fov_axis: FovAxis },
    /// pbrt's `projection`: as `Projector`, but `intensity` in W/sr is constant over the image's pixels
    /// and `fov` spans its shorter side.
    Projection { to_world: Transform, image: LightImage, fov: f64, power: Option<f64> },
    /// A point light whose intensity depends on the direction by an equal-area octahedral image.
    Goniometric { to_world: Transform, intensity: Color, image: Option<LightImage>, power: Option<f64> },
}

impl EmitterKind {
    /// Whether light comes from everywhere around the scene.
    pub fn fills_the_sky(&self) -> bool {
        matches!(self, Self::Constant { .. } | Self::Environment { .. })
    }
}

/// How a spot's light falls between `beam_width` and `cutoff_angle`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpotFalloff {
    /// Linear in the angle (Mitsuba).
    Linear,
    /// Smoothstep of the cosine (pbrt).
    Smoothstep,
}

/// A picture that emits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightImage {
    pub path: PathBuf,
    pub encoding: TextureEncoding,
    pub scale: f64,
    /// pbrt's `illuminance` in lux: rescales the light so that a plane facing local +Z receives it.
    pub illuminance: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EnvironmentMapping {
    /// Mitsuba: +Y up, the picture's middle is +Z, its left edge −Z.
    LatLong,
    /// pbrt-v4: square octahedral equal-area map (Clarberg 2008), +Z up.
    EqualArea,
}
