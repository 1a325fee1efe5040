//! Numbers, colours and directions that vary in space.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::color::Color;
use super::table::{file, kinds, plain, record};
use super::texture::WrapMode;
use super::transform::Transform;

kinds! {
    /// A parameter that may depend on the place.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum Volume {
        /// The same everywhere, without bounds.
        "constant" => Constant(color: Color),
        /// The same direction everywhere, in the world.
        "direction" => Direction(direction: [f64; 3]),
        /// Interpolated values.
        "grid" => Grid(grid: VolumeGrid),
        /// pbrt's procedural density of a cloud.
        "cloud" => Cloud(cloud: Cloud),
    }
}

impl Volume {
    /// The same number everywhere.
    pub fn number(value: f64) -> Self {
        Self::Constant(Color::Gray(value))
    }

    /// Whether it depends on the place.
    pub fn varies(&self) -> bool {
        matches!(self, Self::Grid(_) | Self::Cloud(_))
    }
}

record! {
    /// Values on the points of a grid of cells.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct VolumeGrid {
        /// The values.
        pub data: VolumeData,
        /// The box they fill, as [min, max]; `None` is that of the file.
        pub bounds: Option<[[f64; 3]; 2]>,
        /// From the space of the box to the world.
        pub to_world: Transform,
        /// Between the values.
        pub filter: VolumeFilter,
        /// Beyond the outermost values. Mitsuba's border is where the box ends; pbrt's values beyond it are zero and
        /// are interpolated with.
        pub wrap: WrapMode,
        /// Where in the box the values stand.
        pub samples: GridSamples,
    }
}

kinds! {
    /// Where the values of a grid are.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum VolumeData {
        /// In a file of their own.
        "file" => File(file: VolumeFile),
        /// In the scene itself.
        "values" => Inline(values: Arc<GridValues>),
    }
}

/// A file of volumes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VolumeFile {
    /// As found by the resolver.
    pub path: PathBuf,
    /// How to read it.
    pub format: VolumeFormat,
}

/// Formats of volume files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum VolumeFormat {
    /// Mitsuba's `VOL`.
    Vol,
    /// NanoVDB.
    NanoVdb {
        /// Name of the grid in the file.
        grid: String,
    },
}

/// Values in the scene file itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridValues {
    /// Along x, y and z.
    pub resolution: [u32; 3],
    /// Numbers for each point; three are linear Rec. 709.
    pub channels: u32,
    /// x fastest, then y, then z; the channels of a point stand together.
    pub values: Vec<f32>,
}

/// Lookup between the values of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum VolumeFilter {
    /// The value of the cell.
    Nearest,
    /// Between the eight values around a point.
    Trilinear,
}

/// Where in its box a grid has its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum GridSamples {
    /// In the middle of cells, n along an axis with n values (pbrt, Mitsuba 2 and 3).
    Centers,
    /// At the corners of cells, n − 1 along an axis with n values (Mitsuba 0.6).
    Corners,
}

/// pbrt's `cloud`: Perlin noise that thins out upwards.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloud {
    /// Of the noise, before it is clamped to 0..1.
    pub density: f64,
    /// How far the lookup is moved by another noise.
    pub wispiness: f64,
    /// Of the noise.
    pub frequency: f64,
    /// The box it fills, as [min, max].
    pub bounds: [[f64; 3]; 2],
    /// From the space of the box and of the noise to the world.
    pub to_world: Transform,
}

file! { VolumeFile }
plain! { VolumeFilter, GridSamples, Cloud, WrapMode }
