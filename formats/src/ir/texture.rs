//! Textures by path and parameter.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Origin;
use super::arena::{Id, Store, Stored};
use super::color::Color;
use super::table::{file, kinds, plain};
use super::transform::Transform;

kinds! {
    /// A colour parameter: constant or textured.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum ColorInput {
        /// The same everywhere.
        "colour" => Color(color: Color),
        /// By the place on the surface.
        "texture" => Texture(id: Id<Texture>),
    }
}

impl ColorInput {
    /// Whether it is black everywhere, as written.
    pub fn is_black(&self) -> bool {
        matches!(self, Self::Color(Color::Gray(0.0) | Color::Rgb([0.0, 0.0, 0.0])))
    }
}

kinds! {
    /// A scalar parameter: constant or textured.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum FloatInput {
        /// The same everywhere.
        "number" => Value(value: f64),
        /// By the place on the surface.
        "texture" => Texture(id: Id<Texture>),
    }
}

/// A texture of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    /// The author's id, if any.
    pub name: Option<String>,
    /// Where it was written.
    pub origin: Origin,
    /// The pattern and its parameters.
    pub kind: TextureKind,
}

impl Stored for Texture {
    const STORE: Store = Store::Textures;
}

kinds! {
    /// A pattern and its parameters.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum TextureKind {
        /// A picture.
        "bitmap" => Bitmap(bitmap: Bitmap),
        /// 2×2 cells per unit of transformed uv; equal floor parity shows `color0`.
        "checkerboard" => Checkerboard {
            /// Where the floors of u and v have the same parity.
            color0: ColorInput,
            /// Elsewhere.
            color1: ColorInput,
            /// Applied to uv first.
            to_uv: Transform,
        },
        /// A colour or texture times another.
        "scale" => Scale {
            /// One of the two.
            value: ColorInput,
            /// The other one.
            factor: ColorInput,
        },
        /// An attribute of the mesh by name (`vertex_color`, `face_color`, …).
        "mesh_attribute" => MeshAttribute {
            /// As the mesh calls it.
            name: String,
            /// Factor on it.
            scale: f64,
        },
        /// Lines around unit cells (0.6 `gridtexture`).
        "gridtexture" => Grid {
            /// Of the cells.
            color0: ColorInput,
            /// Of the lines.
            color1: ColorInput,
            /// In uv.
            line_width: f64,
            /// Applied to uv first.
            to_uv: Transform,
        },
        /// (1 − amount)·first + amount·second.
        "mix" => Mix {
            /// Seen at amount 0.
            first: ColorInput,
            /// Seen at amount 1.
            second: ColorInput,
            /// Share of `second`.
            amount: MixAmount,
        },
        /// Four colours at the corners of the uv square.
        "bilerp" => Bilerp {
            /// In the order 00 01 10 11 of (u, v).
            corners: [Color; 4],
            /// Where on the texture a point lies.
            mapping: Mapping,
        },
        /// pbrt's checkerboard over any mapping: equal floor parity shows `color0`; one cell per unit.
        "checkerboard over a mapping" => MappedCheckerboard {
            /// Where the floors have the same parity.
            color0: ColorInput,
            /// Elsewhere.
            color1: ColorInput,
            /// Where on the texture a point lies.
            mapping: Mapping,
        },
        /// Random disks in uv.
        "dots" => Dots {
            /// Of the disks.
            inside: ColorInput,
            /// Between them.
            outside: ColorInput,
            /// Where on the texture a point lies.
            mapping: Mapping,
        },
        /// Perlin noise in texture space.
        "noise" => Noise {
            /// Which noise.
            kind: NoiseKind,
            /// World → texture.
            to_texture: Transform,
        },
    }
}

kinds! {
    /// The share of the second part of a mix.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum MixAmount {
        /// A number or texture.
        "amount" => Input(amount: FloatInput),
        /// |n·direction| of the geometric normal, in the world.
        "direction" => Direction(direction: [f64; 3]),
    }
}

file! { Bitmap }
plain! { NoiseKind, Mapping }

/// pbrt's noise textures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum NoiseKind {
    /// Fractal sum.
    Fbm {
        /// Terms of the sum.
        octaves: u32,
        /// Factor from one term to the next.
        roughness: f64,
    },
    /// Fractal sum of absolute values.
    Wrinkled {
        /// Terms of the sum.
        octaves: u32,
        /// Factor from one term to the next.
        roughness: f64,
    },
    /// Waves of varying strength.
    Windy,
    /// Coloured veins.
    Marble {
        /// Terms of the sum that bends the veins.
        octaves: u32,
        /// Factor from one term to the next.
        roughness: f64,
        /// Of the point before the lookup.
        scale: f64,
        /// How far the veins bend.
        variation: f64,
    },
}

/// Where on a texture a surface point lies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Mapping {
    /// st = M·(u, v, 0, 1).
    Uv(Transform),
    /// The unit sphere's angles about the origin of texture space.
    Spherical {
        /// World → texture.
        to_texture: Transform,
    },
    /// Angle about and height along z.
    Cylindrical {
        /// World → texture.
        to_texture: Transform,
    },
    /// (p·v1 + offset₀, p·v2 + offset₁).
    Planar {
        /// World → texture.
        to_texture: Transform,
        /// v1 and v2.
        axes: [[f64; 3]; 2],
        /// Added to the products.
        offset: [f64; 2],
    },
    /// The point itself, for three-dimensional patterns.
    Solid {
        /// World → texture.
        to_texture: Transform,
    },
}

/// A picture as a texture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bitmap {
    /// As found by the resolver.
    pub path: PathBuf,
    /// Between pixels.
    pub filter: TextureFilter,
    /// Beyond the left and right border.
    pub wrap_u: WrapMode,
    /// Beyond the upper and lower border.
    pub wrap_v: WrapMode,
    /// From stored numbers to values.
    pub encoding: TextureEncoding,
    /// A single channel of the image (`r g b a`), as gray.
    pub channel: Option<char>,
    /// `Uv`: uv' = M·(u, v, 0, 1) before the lookup; v = 0 is the top row.
    pub mapping: Mapping,
    /// Multiplies the decoded value.
    pub scale: f64,
    /// 1 − value.
    pub invert: bool,
}

impl Bitmap {
    /// The numbers of a picture as they are, repeated and interpolated.
    pub fn raw(path: PathBuf, mapping: Mapping) -> Self {
        Self {
            path,
            filter: TextureFilter::Bilinear,
            wrap_u: WrapMode::Repeat,
            wrap_v: WrapMode::Repeat,
            encoding: TextureEncoding::Linear,
            channel: None,
            mapping,
            scale: 1.0,
            invert: false,
        }
    }
}

/// Lookup between the pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TextureFilter {
    /// The pixel the point lies in.
    Nearest,
    /// Between the four pixels around it.
    Bilinear,
}

/// What lies beyond the borders of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WrapMode {
    /// The picture again.
    Repeat,
    /// The picture again, every second one mirrored.
    Mirror,
    /// The outermost pixels.
    Clamp,
    /// Black.
    Zero,
    /// White.
    One,
}

/// From the stored numbers of a picture to values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum TextureEncoding {
    /// 8- and 16-bit images are sRGB, float images linear.
    Auto,
    /// Stored numbers are used as they are.
    Linear,
    /// sRGB curve.
    Srgb,
    /// Stored number to this power.
    Gamma(f64),
}
