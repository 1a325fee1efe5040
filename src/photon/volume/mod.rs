//! Photons in participating media, found along a segment of a camera path.
//!
//! Two kinds: a [`VolumePhoton`] lies where light collided with the medium, a [`Beam`] is a way that light went.
//! Both are blurred by the same kernel across the segment, so that both estimate the same radiance:
//! points do it with less work in dense media, beams with less noise in thin ones.
//!
//! [`points`] and [`beams`] hold and find them, [`estimate`] weighs them. Nothing here knows what a medium is:
//! [`Passage`] tells what the estimators need.

pub mod beams;
pub mod estimate;
pub mod flight;
mod morton;
pub mod points;

pub use beams::{Beam, BeamMap, Crossing};
pub use estimate::{Found, Passage, VolumeGather};
pub use points::{Near, PointMap, VolumePhoton};

use crate::math::{Bounds, Ray, Vec3};

/// A piece of a camera path: `o + t·d` with `0 ≤ t < length`. Half-open, so that of several in a row one has each place.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Where the camera is nearer.
    pub o: Vec3,
    /// Unit direction, away from the camera.
    pub d: Vec3,
    /// In scene units, finite.
    pub length: f32,
}

impl Segment {
    /// The point at distance `t`.
    #[inline(always)]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }

    fn ray(&self) -> Ray {
        Ray { tmax: self.length, ..Ray::new(self.o, self.d) }
    }
}

/// A box grown by a search radius, and by the rounding of distances as large as its coordinates.
fn grown(bounds: Bounds, radius: f32) -> Bounds {
    let by = radius + 8.0 * f32::EPSILON * (bounds.magnitude() + radius);
    Bounds { min: bounds.min - by, max: bounds.max + by }
}
