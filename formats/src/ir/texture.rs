//! Textures by path and parameter.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Color, ColorInput, FloatInput, Origin, Transform};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Texture {
    pub name: Option<String>,
    pub origin: Origin,
    pub kind: TextureKind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TextureKind {
    Bitmap(Bitmap),
    /// 2×2 cells per unit of transformed uv; equal floor parity shows `color0`.
    Checkerboard {
        color0: ColorInput,
        color1: ColorInput,
        to_uv: Transform,
    },
    /// A colour or texture times another.
    Scale {
        value: ColorInput,
        factor: ColorInput,
    },
    /// An attribute of the mesh by name (`vertex_color`, `face_color`, …).
    MeshAttribute {
        name: String,
        scale: f64,
    },
    /// Lines of `line_width` (in uv) around unit cells (0.6 `gridtexture`).
    Grid {
        color0: ColorInput,
        color1: ColorInput,
        line_width: f64,
        to_uv: Transform,
    },
    /// (1 − amount)·first + amount·second.
    Mix {
        first: ColorInput,
        second: ColorInput,
        amount: MixAmount,
    },
    /// Four colours at the corners of the uv square, in the order 00 01 10 11 of (u, v).
    Bilerp {
        corners: [Color; 4],
        mapping: Mapping,
    },
    /// pbrt's checkerboard over any mapping: equal floor parity shows `color0`; one cell per unit.
    MappedCheckerboard {
        color0: ColorInput,
        color1: ColorInput,
        mapping: Mapping,
    },
    /// Random disks in uv.
    Dots {
        inside: ColorInput,
        outside: ColorInput,
        mapping: Mapping,
    },
    /// Perlin noise in the space of `to_texture` (world → texture).
    Noise {
        kind: NoiseKind,
        to_texture: Transform,
    },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum MixAmount {
    Input(FloatInput),
    /// |n·direction| of the geometric normal, in the world.
    Direction([f64; 3]),
}

/// pbrt's noise textures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum NoiseKind {
    Fbm { octaves: u32, roughness: f64 },
    Wrinkled { octaves: u32, roughness: f64 },
    Windy,
    Marble { octaves: u32, roughness: f64, scale: f64, variation: f64 },
}

/// Where on a texture a surface point lies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Mapping {
    /// st = M·(u, v, 0, 1).
    Uv(Transform),
    /// The unit sphere's angles about the origin of texture space.
    Spherical { to_texture: Transform },
    /// Angle about and height along z.
    Cylindrical { to_texture: Transform },
    /// (p·v1 + offset₀, p·v2 + offset₁).
    Planar { to_texture: Transform, axes: [[f64; 3]; 2], offset: [f64; 2] },
    /// The point itself, for three-dimensional patterns.
    Solid { to_texture: Transform },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bitmap {
    pub path: PathBuf,
    pub filter: TextureFilter,
    pub wrap_u: WrapMode,
    pub wrap_v: WrapMode,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TextureFilter {
    Nearest,
    Bilinear,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WrapMode {
    Repeat,
    Mirror,
    Clamp,
    Zero,
    One,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum TextureEncoding {
    /// 8- and 16-bit images are sRGB, float images linear.
    Auto,
    /// Stored numbers are used as they are.
    Linear,
    Srgb,
    /// Stored number to this power.
    Gamma(f64),
}
