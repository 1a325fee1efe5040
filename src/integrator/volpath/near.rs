//! Light of near lamps: places along a ray by the angle under which the lamp sees them (equiangular sampling: Kulla
//! and Fajardo 2012), beside those that flights come to. Both are drawn for the same numbers of the lamp, and share
//! its light by the balance heuristic.
//!
//! In a grid the density of a flight is known together with its null collisions only. So a place that is drawn by the
//! angle gets null collisions too, by ratio tracking, which draws them as flights do (Miller, Georgiev, Jarosz 2019).

use super::connect::Scattering;
use super::{VolumePathTracer, Walk};
use crate::integrator::{CameraSample, Scratch};
use crate::math::{Ray, Vec2, Vec3};
use crate::medium::{Carried, Medium, Passage};
use crate::sampling::Sampler;

/// Farther away than so many mean free paths, what a lamp adds is smooth along a ray, and flights find it.
const NEAR: f32 = 4.0;

/// In a grid a place costs as much as a flight. It is drawn where the lamp sees the part of the ray in there under an angle
/// larger than this: otherwise it is as far from all of it.
const WIDE: f32 = 1.0;

/// How a lamp's place sees a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pivot {
    /// Along the ray, where it is nearest to the lamp.
    nearest: f32,
    /// From there to the lamp.
    distance: f32,
    /// Angles of the two ends of what of the ray is in the medium.
    angles: [f32; 2],
}

impl Pivot {
    /// For a ray of a unit direction through a medium. `None` where it is not worth while.
    pub fn new(medium: &Medium, part: &Ray, place: Vec3) -> Option<Self> {
        let (range, sigma, least) = match medium {
            Medium::Homogeneous(_) => ([0.0, part.tmax], medium.uniform()?.sigma_t, 0.0),
            Medium::Heterogeneous(m) => (m.majorants().along(part).range()?, medium.mean().sigma_t, WIDE),
        };
        let nearest = (place - part.o).dot(part.d);
        // A lamp on the ray itself must not make the angles meet.
        let small = 1e-6 * (place.abs() + part.o.abs()).max_element();
        let distance = (place - part.at(nearest)).length().max(small);
        let angles = range.map(|t| ((t - nearest) / distance).atan());
        let worth = distance * sigma.min_element() < NEAR && distance > 0.0 && angles[1] - angles[0] > least;
        worth.then_some(Self { nearest, distance, angles })
    }

    /// The distance for a uniform number.
    fn sample(&self, u: f32) -> f32 {
        let [a, b] = self.angles;
        self.nearest + self.distance * (a + (b - a) * u).tan()
    }

    /// Density of a distance.
    fn pdf(&self, t: f32) -> f32 {
        let x = t - self.nearest;
        self.distance / ((self.angles[1] - self.angles[0]) * (self.distance * self.distance + x * x))
    }

    /// Share of the light at the distance `t` of a ray that is left to the flight which came there, of a path as it was
    /// `before` and is `after`.
    pub fn share_of_flight(
        &self,
        (medium, part): (&Medium, &Ray),
        [before, after]: [&Carried; 2],
        t: f32,
    ) -> f32 {
        let flight = match medium {
            Medium::Homogeneous(m) => before.probability(m.collision(t).density),
            Medium::Heterogeneous(m) => after.reach / before.reach * m.rate(part, t),
        };
        self.share(flight, t)
    }

    /// The same with the density of the flight.
    fn share(&self, flight: f32, t: f32) -> f32 {
        if flight > 0.0 { flight / (flight + self.pdf(t)) } else { 0.0 }
    }
}

/// What a collision at the distance `t` makes of the light, and the density with which flights come to it.
fn collision(medium: &Medium, part: &Ray, t: f32, sampler: &mut Sampler) -> Passage {
    match medium {
        Medium::Homogeneous(m) => m.collision(t),
        Medium::Heterogeneous(_) => {
            let c = medium.at(part.at(t), part.d);
            let there = Passage { left: c.sigma_s, density: c.sigma_t };
            medium.pass(&Ray { tmax: t, ..*part }, sampler).then(there)
        }
    }
}

impl VolumePathTracer<'_> {
    /// Adds the lamp's light from a place drawn by the angle.
    pub(super) fn light_near(
        &self,
        medium: &Medium,
        part: &Ray,
        walk: &Walk,
        (pivot, lamp): (&Pivot, (f32, Vec2)),
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let t = pivot.sample(sample.sampler.next_1d());
        if !(t > 0.0 && t < part.tmax) {
            return;
        }
        let way = collision(medium, part, t, &mut sample.sampler);
        // The path as a flight would have brought it there; the light as the angle did.
        let share = pivot.share(walk.carried.probability(way.density), t);
        let mut carried = walk.carried;
        carried.take(way);
        carried.reach = 1.0;
        let layer = walk.class.after_camera_medium().layer();
        let scattering = Scattering { medium: walk.medium, carried, layer, share };
        self.light_medium(&scattering, medium.phase(), part.at(t), -part.d, lamp, sample, scratch);
    }
}
