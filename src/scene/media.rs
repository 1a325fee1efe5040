//! What fills the space between surfaces.
//!
//! What lies behind a boundary is what the boundary says, whatever the ray was in before: a scene whose boundaries
//! contradict each other has a picture, the same as in Mitsuba and pbrt.

use super::{Scene, ShapeRecord, Surface};
use crate::math::{Ray, Vec2, Vec3};
use crate::medium::{Medium, MediumId};

impl Scene {
    /// What a ray that goes on from `s` along `d` is in, if it was in `now` before.
    #[inline(always)]
    pub fn medium_beyond(&self, s: &Surface, d: Vec3, now: Option<MediumId>) -> Option<MediumId> {
        match self.shapes[s.shape as usize].boundary {
            Some(boundary) if s.ng.dot(d) > 0.0 => boundary.outside,
            Some(boundary) => boundary.inside,
            None => now,
        }
    }

    /// The medium itself; `None` is vacuum.
    #[inline(always)]
    pub fn medium(&self, id: Option<MediumId>) -> Option<&Medium> {
        id.map(|MediumId(index)| &self.media[index as usize])
    }

    /// What lies at `p`: on the straight way to `from`, which stands in `medium`, what the first boundary says of its
    /// near side, and without a boundary what is there.
    pub fn medium_at(&self, p: Vec3, from: Vec3, medium: Option<MediumId>) -> Option<MediumId> {
        let mut ray = Ray { o: p, d: from - p, tmax: 1.0 };
        for _ in 0..MOST_LOOKED_THROUGH {
            let Some(hit) = self.geometry.closest(&ray) else { break };
            let s = self.surface(&ray, &hit);
            if let Some(boundary) = self.shapes[s.shape as usize].boundary {
                return if s.ng.dot(ray.d) > 0.0 { boundary.inside } else { boundary.outside };
            }
            let o = s.origin(ray.d);
            if (from - o).dot(ray.d) <= 0.0 {
                break;
            }
            ray = Ray { o, d: from - o, tmax: 1.0 };
        }
        medium
    }
}

impl Scene {
    /// Finds out what lamps stand in, seen from a camera in `medium`: those that are boundaries shine outwards.
    pub(super) fn place_lamps(&mut self, camera: Vec3, medium: Option<MediumId>) {
        for shape in 0..self.shapes.len() {
            let ShapeRecord { emitter: Some(lamp), boundary, .. } = self.shapes[shape] else {
                continue;
            };
            if let Some(boundary) = boundary {
                self.lamp_media[lamp as usize] = boundary.outside;
            } else if let Some(p) = self.emitters[lamp as usize].place(Vec2::splat(0.5)) {
                self.lamp_media[lamp as usize] = self.medium_at(p, camera, medium);
            }
        }
    }
}

/// Surfaces on a way that is looked along before rendering.
pub(super) const MOST_LOOKED_THROUGH: u32 = 64;
