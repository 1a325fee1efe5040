//! Sensors, films, reconstruction filters and samplers.

use serde::{Deserialize, Serialize};

use super::{Origin, Transform};

/// A camera looking along local +Z with +Y up and +X to the left of the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    pub name: Option<String>,
    pub origin: Origin,
    pub to_world: Transform,
    pub projection: Projection,
    /// pbrt's window on the screen plane [x0, x1, y0, y1]; `None` follows from the film's shape.
    pub screen_window: Option<[f64; 4]>,
    /// Range along the optical axis; nothing nearer or farther is seen.
    pub near_clip: f64,
    pub far_clip: f64,
    /// Fractions of the film.
    pub principal_point_offset: [f64; 2],
    /// `None`: pinhole.
    pub lens: Option<Lens>,
    pub film: Film,
    pub sampler: Sampler,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Projection {
    Perspective {
        fov: Fov,
        axis: FovAxis,
    },
    /// Sees x in ±1 and y in ±1/aspect of its local frame, which `to_world` may scale.
    Orthographic,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fov {
    /// Full angle along the fov axis.
    Degrees(f64),
    /// Millimetres on a 36 × 24 mm frame; gives the diagonal angle.
    FocalLength(f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FovAxis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    pub aperture_radius: f64,
    /// z of the plane of focus.
    pub focus_distance: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    pub origin: Origin,
    pub width: u32,
    pub height: u32,
    /// Part of the full film that is rendered and stored; `None` is all.
    pub crop: Option<Crop>,
    pub filter: Filter,
    pub pixel_format: PixelFormat,
    pub component_format: ComponentFormat,
    /// Extension-like name as written: `openexr`, `rgbe`, `pfm`, `png`, `jpeg`.
    pub file_format: String,
    pub sample_border: bool,
    /// Radiance of the scene times this is what the film stores (pbrt's imaging ratio).
    pub imaging_ratio: f64,
    /// Colour temperature in kelvin of the daylight that is to look white; `None` keeps colours (pbrt's
    /// `whitebalance`).
    pub white_balance: Option<f64>,
    /// Tone mapping asked for by an `ldrfilm`; used for the PNG only.
    pub tonemap: Option<Tonemap>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Filter {
    Box {
        radius: f64,
    },
    Tent {
        radius: f64,
    },
    Gaussian {
        stddev: f64,
    },
    Mitchell {
        b: f64,
        c: f64,
    },
    CatmullRom,
    Lanczos {
        lobes: u32,
    },
    /// pbrt's: truncated at `radius`, with the value there taken off.
    TruncatedGaussian {
        sigma: f64,
        radius: [f64; 2],
    },
    /// pbrt's: stretched to `radius`.
    ScaledMitchell {
        b: f64,
        c: f64,
        radius: [f64; 2],
    },
    /// pbrt's box and triangle may be wider on one axis.
    WideBox {
        radius: [f64; 2],
    },
    WideTent {
        radius: [f64; 2],
    },
    /// pbrt's Lanczos-windowed sinc.
    WindowedSinc {
        tau: f64,
        radius: [f64; 2],
    },
}

impl Filter {
    /// Filters by the names of Mitsuba's plugins, with its default parameters.
    pub const NAMED: &[(&str, Self)] = &[
        ("box", Self::Box { radius: 0.5 }),
        ("tent", Self::Tent { radius: 1.0 }),
        ("gaussian", Self::Gaussian { stddev: 0.5 }),
        ("mitchell", Self::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        ("catmullrom", Self::CatmullRom),
        ("lanczos", Self::Lanczos { lobes: 3 }),
    ];

    /// The filter of this name in [`Filter::NAMED`].
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(known, _)| *known == name).map(|(_, filter)| *filter)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PixelFormat {
    Luminance,
    LuminanceAlpha,
    Rgb,
    Rgba,
    Xyz,
    Xyza,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ComponentFormat {
    Float16,
    Float32,
    Uint32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tonemap {
    /// Stops.
    pub exposure: f64,
    /// `None`: the sRGB curve.
    pub gamma: Option<f64>,
}

/// Only the count matters to us; the plugin name is kept for writing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sampler {
    pub plugin: String,
    pub sample_count: u32,
    pub seed: u64,
}
