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

/// A piece of a camera path, and the planes at its two ends.
///
/// A place at `o + w` belongs to it if `w·begin ≥ 0` and `w·end < length`: half-open, so that of several in a row one
/// has each place. A kernel is a disc across the segment. Where the segment comes through a boundary at a slant, half of
/// the disc is in the medium before the segment is, and the other half after it: the plane of the boundary, rather than
/// one across the segment, takes all of the first half and none of the second. Otherwise light would be lost, as much as
/// the radius is wide. On a flat boundary the distance from it along `d` is `w·begin`, and nothing is blurred.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Where the camera is nearer.
    pub o: Vec3,
    /// Unit direction, away from the camera.
    pub d: Vec3,
    /// In scene units, finite.
    pub length: f32,
    /// Normal of the plane through `o`, as long as makes its product with `d` 1.
    begin: Vec3,
    /// The same at the other end.
    end: Vec3,
}

/// Tangent of the angle beyond which ends are no steeper: a place that belongs to the segment is no further from it
/// along `d` than so many radii.
const STEEPEST: f32 = 8.0;

impl Segment {
    /// With ends straight across.
    pub fn new(o: Vec3, d: Vec3, length: f32) -> Self {
        Self { o, d, length, begin: d, end: d }
    }

    /// It begins at a surface with this normal, of either sign.
    #[must_use]
    pub fn begins_at(self, normal: Vec3) -> Self {
        Self { begin: slanted(self.d, normal), ..self }
    }

    /// It ends at a surface with this normal, of either sign.
    #[must_use]
    pub fn ends_at(self, normal: Vec3) -> Self {
        Self { end: slanted(self.d, normal), ..self }
    }

    /// The point at distance `t`.
    #[inline(always)]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }

    /// Through all the places within `radius` that belong to it.
    fn ray(&self, radius: f32) -> Ray {
        let [before, behind] = [self.begin, self.end].map(|h| (h - self.d).length() * radius);
        Ray { tmax: self.length + before + behind, ..Ray::new(self.at(-before), self.d) }
    }
}

/// `normal` as long as makes its product with `d` 1, but no steeper than [`STEEPEST`].
fn slanted(d: Vec3, normal: Vec3) -> Vec3 {
    let cos = normal.dot(d);
    let across = (normal - d * cos) * cos.signum();
    let sine = across.length();
    let tangent = (sine / cos.abs()).min(STEEPEST);
    if sine > 0.0 { d + across * (tangent / sine) } else { d }
}

/// A box grown by a search radius, and by the rounding of distances as large as its coordinates.
fn grown(bounds: Bounds, radius: f32) -> Bounds {
    let by = radius + 8.0 * f32::EPSILON * (bounds.magnitude() + radius);
    Bounds { min: bounds.min - by, max: bounds.max + by }
}
