//! The film: what is stored per pixel, and reconstruction filters.

mod aov;
mod binned;
mod counts;
mod doublings;
pub mod filter;
mod layer;
mod packed;
mod pass;
mod pixels;
mod rejected;
mod response;
mod splats;
mod stored;
mod waiting;

use crate::math::Vec2;

pub use aov::{AOVS, Aov, Visible};
pub use binned::{Binned, BinnedSums, MOST_ADDITIONS};
pub use counts::Counts;
pub use doublings::Doublings;
pub use filter::Filter;
pub use layer::{LAYERS, Layer, Radiance};
pub use pass::{Mean, PassSums, StoredMean};
pub use pixels::{Common, Pixels};
pub use rejected::{Rejected, RejectedLayer};
pub use response::Response;
pub use splats::{SplatList, Splats};
pub use stored::STRIDE;
pub use waiting::{SoFar, WAITING_BYTES, Waiting};

/// Size of the picture and the part of it that is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmSize {
    /// Full film, which decides the field of view.
    pub width: u32,
    /// Rows of the full film.
    pub height: u32,
    /// Rendered part: x, y, width, height in pixels of the full film.
    pub crop: [u32; 4],
}

impl FilmSize {
    /// A film all of which is rendered.
    pub fn full(width: u32, height: u32) -> Self {
        Self { width, height, crop: [0, 0, width, height] }
    }

    /// Of the whole film, in pixels.
    pub fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }

    /// The same picture with about `most` rendered pixels, if it has more.
    #[must_use]
    pub fn with_fewer_pixels(&self, most: usize) -> Self {
        let scale = (most as f64 / self.pixel_count().max(1) as f64).sqrt();
        if scale >= 1.0 {
            return *self;
        }
        let scaled = |n: u32| (f64::from(n) * scale).round().max(1.0) as u32;
        let along = |start: u32, length: u32, all: u32| {
            let length = scaled(length);
            let start = (f64::from(start) * scale).round() as u32;
            (start, length, scaled(all).max(start + length))
        };
        let [x, y, w, h] = self.crop;
        let ((x, w, width), (y, h, height)) = (along(x, w, self.width), along(y, h, self.height));
        Self { width, height, crop: [x, y, w, h] }
    }

    /// Pixels that are rendered.
    pub fn pixel_count(&self) -> usize {
        self.crop[2] as usize * self.crop[3] as usize
    }
}
