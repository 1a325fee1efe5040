//! Sensors, films, reconstruction filters and samplers.

use std::mem::discriminant;

use serde::{Deserialize, Serialize};

use super::{CoordinateSystem, Id, Medium, Origin, Transform};

/// A camera looking along local +Z with +Y up and +X to the left of the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// The author's id, if any.
    pub name: Option<String>,
    /// Where it was written.
    pub origin: Origin,
    /// Local → world.
    pub to_world: Transform,
    /// From directions to the film.
    pub projection: Projection,
    /// pbrt's window on the screen plane [x0, x1, y0, y1]; `None` follows from the film's shape.
    pub screen_window: Option<[f64; 4]>,
    /// Range along the optical axis; nothing nearer or farther is seen.
    pub near_clip: f64,
    /// The far end of that range.
    pub far_clip: f64,
    /// Fractions of the film.
    pub principal_point_offset: [f64; 2],
    /// `None`: pinhole.
    pub lens: Option<Lens>,
    /// What is stored.
    pub film: Film,
    /// How many samples.
    pub sampler: Sampler,
    /// The medium around it; `None` is vacuum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medium: Option<Id<Medium>>,
}

/// From directions to places on the film.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Projection {
    /// Pinhole or thin lens.
    Perspective {
        /// Its angle.
        fov: Fov,
        /// The axis of the film that `fov` spans.
        axis: FovAxis,
    },
    /// Sees x in ±1 and y in ±1/aspect of its local frame, which `to_world` may scale.
    Orthographic,
    /// All of the film sees the radiance along one ray, the local +Z axis (Mitsuba's `radiancemeter`).
    Ray,
}

/// How the angle of a camera is given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fov {
    /// Full angle along the fov axis.
    Degrees(f64),
    /// Millimetres on a 36 × 24 mm frame; gives the diagonal angle.
    FocalLength(f64),
}

/// An axis of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FovAxis {
    /// Width.
    X,
    /// Height.
    Y,
    /// From corner to corner.
    Diagonal,
    /// The shorter of width and height.
    Smaller,
    /// The longer of the two.
    Larger,
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// In scene units.
    pub aperture_radius: f64,
    /// z of the plane of focus.
    pub focus_distance: f64,
}

/// Size, filter and format of the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// Where it was written.
    pub origin: Origin,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Part of the full film that is rendered and stored; `None` is all.
    pub crop: Option<Crop>,
    /// From samples to pixels.
    pub filter: Filter,
    /// Channels as written.
    pub pixel_format: PixelFormat,
    /// Numbers as written.
    pub component_format: ComponentFormat,
    /// Extension-like name as written: `openexr`, `rgbe`, `pfm`, `png`, `jpeg`.
    pub file_format: String,
    /// Takes samples beyond the border that the filter reaches.
    pub sample_border: bool,
    /// Radiance of the scene times this is what the film stores (pbrt's imaging ratio).
    pub imaging_ratio: f64,
    /// Colour temperature in kelvin of the daylight that is to look white; `None` keeps colours (pbrt's
    /// `whitebalance`).
    pub white_balance: Option<f64>,
    /// Tone mapping asked for by an `ldrfilm`; used for the PNG only.
    pub tonemap: Option<Tonemap>,
    /// The channels of pbrt's `gbuffer` film are stored beside the picture, in these coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gbuffer: Option<CoordinateSystem>,
}

/// A rectangle of the film, in pixels from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    /// Left edge.
    pub x: u32,
    /// Upper edge.
    pub y: u32,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
}

/// Reconstruction filter; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Filter {
    /// Constant.
    Box {
        /// Half its width.
        radius: f64,
    },
    /// Linear to zero.
    Tent {
        /// Half its width.
        radius: f64,
    },
    /// Truncated at 4 standard deviations, less the value there.
    Gaussian {
        /// Standard deviation.
        stddev: f64,
    },
    /// Mitchell and Netravali 1988, of radius 2.
    Mitchell {
        /// Blur.
        b: f64,
        /// Ringing.
        c: f64,
    },
    /// `Mitchell` with b = 0 and c = 1/2.
    CatmullRom,
    /// Windowed sinc.
    Lanczos {
        /// Of the sinc, on each side.
        lobes: u32,
    },
    /// pbrt's: truncated at `radius`, with the value there taken off.
    TruncatedGaussian {
        /// Standard deviation.
        sigma: f64,
        /// Half width and half height.
        radius: [f64; 2],
    },
    /// pbrt's: stretched to `radius`.
    ScaledMitchell {
        /// Blur.
        b: f64,
        /// Ringing.
        c: f64,
        /// Half width and half height.
        radius: [f64; 2],
    },
    /// pbrt's box and triangle may be wider on one axis.
    WideBox {
        /// Half width and half height.
        radius: [f64; 2],
    },
    /// As `WideBox`.
    WideTent {
        /// Half width and half height.
        radius: [f64; 2],
    },
    /// pbrt's Lanczos-windowed sinc.
    WindowedSinc {
        /// Cycles of the window.
        tau: f64,
        /// Half width and half height.
        radius: [f64; 2],
    },
}

/// A filter that Mitsuba has a plugin for.
#[derive(Clone, Copy, Debug)]
pub struct NamedFilter {
    /// Of the plugin.
    pub name: &'static str,
    /// With Mitsuba's default parameters.
    pub default: Filter,
    /// In the order they are written.
    pub parameters: &'static [FilterParameter],
}

/// A parameter of a [`NamedFilter`].
#[derive(Clone, Copy, Debug)]
pub struct FilterParameter {
    /// As written.
    pub name: &'static str,
    /// Where a filter of this kind keeps it; `None` for other kinds.
    pub number: fn(&mut Filter) -> Option<FilterNumber<'_>>,
}

/// The value of a [`FilterParameter`], with the values that it may take.
#[derive(Debug, PartialEq)]
pub enum FilterNumber<'a> {
    /// Above 0.
    Positive(&'a mut f64),
    /// Any number.
    Any(&'a mut f64),
    /// A whole number from 1 to 64.
    Count(&'a mut u32),
}

/// A row of [`Filter::NAMED`]: `field: Kind("name as written") = default`.
macro_rules! named {
    ($name:literal, $Variant:ident { $($field:ident: $Kind:ident($written:literal) = $value:expr),* }) => {
        NamedFilter {
            name: $name,
            default: Filter::$Variant { $($field: $value),* },
            parameters: &[$(FilterParameter {
                name: $written,
                number: |filter| match filter {
                    Filter::$Variant { $field, .. } => Some(FilterNumber::$Kind($field)),
                    _ => None,
                },
            }),*],
        }
    };
}

impl Filter {
    /// The filters of Mitsuba: its scenes are read and written by these rows, and the command line lists them.
    pub const NAMED: &[NamedFilter] = &[
        named!("box", Box { radius: Positive("radius") = 0.5 }),
        named!("tent", Tent { radius: Positive("radius") = 1.0 }),
        named!("gaussian", Gaussian { stddev: Positive("stddev") = 0.5 }),
        named!("mitchell", Mitchell { b: Any("B") = 1.0 / 3.0, c: Any("C") = 1.0 / 3.0 }),
        named!("catmullrom", CatmullRom {}),
        named!("lanczos", Lanczos { lobes: Count("lobes") = 3 }),
    ];

    /// The filter of this name in [`Filter::NAMED`].
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|row| row.name == name).map(|row| row.default)
    }

    /// The row of [`Filter::NAMED`] for filters of this kind; `None` for those that only pbrt has.
    pub fn row(&self) -> Option<&'static NamedFilter> {
        Self::NAMED.iter().find(|row| discriminant(&row.default) == discriminant(self))
    }
}

/// Channels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum PixelFormat {
    /// Gray.
    Luminance,
    /// Gray and coverage.
    LuminanceAlpha,
    /// Linear Rec. 709.
    Rgb,
    /// Linear Rec. 709 and coverage.
    Rgba,
    /// CIE 1931.
    Xyz,
    /// CIE 1931 and coverage.
    Xyza,
}

/// Numbers of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ComponentFormat {
    /// Half precision.
    Float16,
    /// Single precision.
    Float32,
    /// Whole numbers.
    Uint32,
}

/// From radiance to a picture of 8 bits.
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
    /// As written.
    pub plugin: String,
    /// In each pixel.
    pub sample_count: u32,
    /// Of the random numbers.
    pub seed: u64,
}
