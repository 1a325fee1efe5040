//! Emitters that are not shapes; area lamps are [`super::AreaEmission`].

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Origin;
use super::arena::Id;
use super::color::Color;
use super::medium::Medium;
use super::sensor::{Fov, FovAxis};
use super::sunsky::SunSky;
use super::table::{file, kinds, plain, record};
use super::texture::{ColorInput, Texture, TextureEncoding};
use super::transform::Transform;

record! {
    /// A light that is no shape.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Emitter {
        /// The author's id, if any.
        pub name: Option<String>,
        /// Where it was written.
        pub origin: Origin,
        /// The light and its parameters.
        pub kind: EmitterKind,
        /// The medium around it; `None` is vacuum.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub medium: Option<Id<Medium>>,
    }
}

kinds! {
    /// A light and its parameters.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum EmitterKind says
        /// Whether light comes from everywhere around the scene.
        fills_the_sky: bool
    {
        /// W·sr⁻¹ per channel, the same in all directions.
        "point" [false] => Point {
            /// In the world.
            position: [f64; 3],
            /// W·sr⁻¹.
            intensity: Color,
        },
        /// Along local +Z: 1 up to `beam_width`, then falling to 0 at `cutoff_angle`.
        "spot" [false] => Spot {
            /// Local → world.
            to_world: Transform,
            /// W·sr⁻¹ on the axis.
            intensity: Color,
            /// Half angle in degrees.
            cutoff_angle: f64,
            /// Half angle in degrees.
            beam_width: f64,
            /// Between the two angles.
            falloff: SpotFalloff,
            /// Factor over the cone's square.
            texture: Option<Id<Texture>>,
        },
        /// Parallel light.
        "directional" [false] => Directional {
            /// Of travel.
            direction: [f64; 3],
            /// On a plane perpendicular to it.
            irradiance: Color,
        },
        /// The same radiance from everywhere.
        "constant" [true] => Constant {
            /// W·m⁻²·sr⁻¹.
            radiance: Color,
        },
        /// Radiance from an image around the scene.
        "envmap" [true] => Environment {
            /// Local → world; only its rotation counts.
            to_world: Transform,
            /// W·m⁻²·sr⁻¹.
            image: LightImage,
            /// From directions to the image.
            mapping: EnvironmentMapping,
        },
        /// Sun and sky of a clear day.
        "sunsky" [true] => SunSky(light: Box<SunSky>),
        /// An image thrown from a point along local +Z, as a slide projector does.
        "projector" [false] => Projector {
            /// Local → world.
            to_world: Transform,
            /// On the plane z = 1, times π in Mitsuba's convention.
            irradiance: ColorInput,
            /// Factor on `irradiance`.
            scale: f64,
            /// Of the image.
            fov: Fov,
            /// Which side of the image `fov` spans.
            fov_axis: FovAxis,
        },
        /// pbrt's `projection`: as `Projector`, but the intensity is constant over a pixel of the image.
        "projection" [false] => Projection {
            /// Local → world.
            to_world: Transform,
            /// W·sr⁻¹.
            image: LightImage,
            /// Full angle of the shorter side, in degrees.
            fov: f64,
            /// Rescales the light to emit this many watts.
            power: Option<f64>,
        },
        /// A point light whose intensity depends on the direction by an equal-area octahedral image.
        "goniometric" [false] => Goniometric {
            /// Local → world.
            to_world: Transform,
            /// W·sr⁻¹.
            intensity: Color,
            /// Factor by direction.
            image: Option<LightImage>,
            /// Rescales the light to emit this many watts.
            power: Option<f64>,
        },
    }
}

impl EmitterKind {
    /// Whether its light comes from beyond the scene.
    pub fn is_far(&self) -> bool {
        self.fills_the_sky() || matches!(self, Self::Directional { .. })
    }
}

file! { LightImage }
plain! { SpotFalloff, EnvironmentMapping }

/// How a spot's light falls between `beam_width` and `cutoff_angle`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SpotFalloff {
    /// Linear in the angle (Mitsuba).
    Linear,
    /// Smoothstep of the cosine (pbrt-v4).
    Smoothstep,
    /// Fourth power of the cosine's share of the way (pbrt-v3).
    Quartic,
}

/// A picture that emits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightImage {
    /// As found by the resolver.
    pub path: PathBuf,
    /// From stored numbers to radiance.
    pub encoding: TextureEncoding,
    /// Multiplies the decoded value.
    pub scale: f64,
    /// pbrt's `illuminance` in lux: rescales the light so that a plane facing local +Z receives it.
    pub illuminance: Option<f64>,
}

/// From directions to the picture of an environment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EnvironmentMapping {
    /// Mitsuba: +Y up, the picture's middle is +Z, its left edge −Z.
    LatLong,
    /// pbrt-v4: square octahedral equal-area map (Clarberg 2008), +Z up.
    EqualArea,
}
