//! Textures by path and parameter.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Color, ColorInput, Origin, Transform};

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
    /// Mitsuba 0.6 `scale`: a colour or texture times a factor.
    Scale {
        value: ColorInput,
        factor: Color,
    },
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
    /// uv' = M·(u, v, 0, 1) before the lookup; v = 0 is the top row.
    pub to_uv: Transform,
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
