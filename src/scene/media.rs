//! What fills the space between surfaces.
//!
//! What lies behind a boundary is what the boundary says, whatever the ray was in before: a scene whose boundaries
//! contradict each other has a picture, the same as in Mitsuba and pbrt.

use super::{Scene, ShapeRecord, Surface};
use crate::math::{Ray, Vec2, Vec3};
use crate::medium::{Medium, MediumId};
use crate::sampling::CounterRng;

/// What a lamp stands in.
#[derive(Clone, Copy, Debug)]
pub enum LampMedium {
    /// All of it.
    One(Option<MediumId>),
    /// Not every place of it stands in the same: what is there is found by looking towards a camera in `medium`.
    ByPlace {
        /// Where the camera is.
        camera: Vec3,
        /// What it stands in.
        medium: Option<MediumId>,
    },
    /// Light from infinity is in what the first boundary on its way says, and in `medium` without one.
    OnItsWay {
        /// What the camera stands in.
        medium: Option<MediumId>,
    },
}

/// Places of a lamp that are looked at, of a single one and of all together, at most.
const PLACES: usize = 256;
const PLACES_OF_ALL: usize = 1 << 18;

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
    /// Finds out what lamps stand in, seen from a camera in `medium`, whatever the file says of them: camera paths that look
    /// for them go by the boundaries. Shapes that are boundaries shine outwards.
    pub(super) fn place_lamps(&mut self, camera: Vec3, medium: Option<MediumId>) {
        let mut boundaries = vec![None; self.emitters.len()];
        for shape in &self.shapes {
            if let ShapeRecord { emitter: Some(lamp), boundary, .. } = *shape {
                boundaries[lamp as usize] = boundary;
            }
        }
        for (lamp, boundary) in boundaries.into_iter().enumerate() {
            self.lamp_media[lamp] = match boundary {
                Some(boundary) => LampMedium::One(boundary.outside),
                None => self.look_around(lamp, camera, medium),
            };
        }
    }

    /// What a lamp stands in that is no boundary.
    fn look_around(&self, lamp: usize, camera: Vec3, medium: Option<MediumId>) -> LampMedium {
        let emitter = &self.emitters[lamp];
        if emitter.is_infinite() {
            return match (medium, self.lamp_media[lamp]) {
                (None, LampMedium::One(None)) => LampMedium::One(None),
                _ => LampMedium::OnItsWay { medium },
            };
        }
        let count = (PLACES_OF_ALL / self.emitters.len().max(1)).clamp(1, PLACES);
        let mut rng = CounterRng::new(0x1a3b_3d1a, lamp as u64);
        let places = (0..count).filter_map(|_| emitter.place(Vec2::from(rng.next_2d())));
        let mut found = places.filter(|p| p.is_finite()).map(|p| self.medium_at(p, camera, medium));
        match found.next() {
            None => self.lamp_media[lamp],
            Some(first) if found.all(|other| other == first) => LampMedium::One(first),
            Some(_) => LampMedium::ByPlace { camera, medium },
        }
    }

    /// What light of a lamp is in where it starts, at `o` along the unit direction `d`.
    #[inline]
    pub fn lamp_medium(&self, lamp: usize, o: Vec3, d: Vec3) -> Option<MediumId> {
        match self.lamp_media[lamp] {
            LampMedium::One(medium) => medium,
            LampMedium::ByPlace { camera, medium } => self.medium_at(o, camera, medium),
            LampMedium::OnItsWay { medium } => self.medium_at(o, o + d * (4.0 * self.sphere.radius), medium),
        }
    }
}

/// Surfaces on a way that is looked along before rendering.
pub(super) const MOST_LOOKED_THROUGH: u32 = 64;
