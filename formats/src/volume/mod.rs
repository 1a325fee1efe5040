//! Volume files: bytes to grids of numbers. Values are as stored; none of them is infinite or not a number.

mod bricks;
mod nvdb;
mod vol;

pub use bricks::Bricks;

use crate::ir::{GridValues, Transform, VolumeFormat};

/// Values on a regular grid of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Along x, y and z; at least 1.
    pub resolution: [u32; 3],
    /// Numbers for each point.
    pub channels: u32,
    /// From the unit cube, which is the box of the grid, to the space of the file; `None` where that box is empty.
    pub place: Option<Transform>,
    /// The numbers.
    pub store: Store,
}

/// The numbers of a [`Grid`].
#[derive(Clone, Debug, PartialEq)]
pub enum Store {
    /// x fastest; the channels of a point stand together.
    Dense(Vec<f32>),
    /// One channel, of which much may be constant.
    Bricks(Bricks),
}

impl Grid {
    /// A number of a point; points count from 0.
    ///
    /// # Panics
    /// If there is no such point or channel.
    pub fn value(&self, point: [u32; 3], channel: u32) -> f32 {
        let in_range = (0..3).all(|i| point[i] < self.resolution[i]) && channel < self.channels;
        assert!(in_range, "point {point:?}, channel {channel} of a grid of {:?}", self.resolution);
        let [x, y, z] = point.map(|i| i as usize);
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        match &self.store {
            Store::Dense(values) => {
                values[((z * ny + y) * nx + x) * self.channels as usize + channel as usize]
            }
            Store::Bricks(bricks) => bricks.value(point),
        }
    }

    /// Bytes held by the values.
    pub fn bytes(&self) -> usize {
        match &self.store {
            Store::Dense(values) => size_of_val(values.as_slice()),
            Store::Bricks(bricks) => bricks.bytes(),
        }
    }
}

impl From<&GridValues> for Grid {
    /// The values of a scene file; their box is the scene's matter.
    fn from(values: &GridValues) -> Self {
        let GridValues { resolution, channels, values } = values.clone();
        Self { resolution, channels, place: None, store: Store::Dense(values) }
    }
}

/// Why a volume file is not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VolumeError {
    /// Not of this format.
    #[error("not a volume file: it does not begin with {0}")]
    Magic(&'static str),
    /// Of the format, but with something that is not read.
    #[error("a volume file {0} is not supported")]
    Unsupported(String),
    /// Shorter than it says.
    #[error("the file ends early: {needed} bytes are needed, {found} are there")]
    Short {
        /// By its header.
        needed: u64,
        /// Its size.
        found: u64,
    },
    /// Numbers that cannot be.
    #[error("{0}")]
    Invalid(String),
    /// No grid has this name.
    #[error("the file has no grid named `{asked}`; it has {}", if has.is_empty() { "none" } else { has.as_str() })]
    NoGrid {
        /// The name that was looked for.
        asked: String,
        /// The names that are there.
        has: String,
    },
}

/// Reads a volume file. Memory stays within a small multiple of its size.
///
/// # Errors
/// When the file is malformed, or has what is not supported.
pub fn read(bytes: &[u8], format: &VolumeFormat) -> Result<Grid, VolumeError> {
    match format {
        VolumeFormat::Vol => vol::read(bytes),
        VolumeFormat::NanoVdb { grid } => nvdb::read(bytes, grid),
    }
}

/// The names of the grids in a NanoVDB file.
///
/// # Errors
/// When the file is malformed, or has what is not supported.
pub fn grid_names(bytes: &[u8]) -> Result<Vec<String>, VolumeError> {
    nvdb::names(bytes)
}
