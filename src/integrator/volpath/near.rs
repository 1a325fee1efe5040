//! Light of near lamps: places along a ray by the angle under which the lamp sees them (equiangular sampling: Kulla
//! and Fajardo 2012), beside those that flights come to. Both are drawn for the same numbers of the lamp, and share
//! its light by the balance heuristic.

use super::connect::Scattering;
use super::{VolumePathTracer, Walk};
use crate::integrator::{CameraSample, Scratch};
use crate::math::{Ray, Vec2, Vec3};
use crate::medium::{Carried, Medium, Passage};

/// Farther away than so many mean free paths, what a lamp adds is smooth along a ray, and flights find it.
const NEAR: f32 = 4.0;

/// How a lamp's place sees a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pivot {
    /// Along the ray, where it is nearest to the lamp.
    nearest: f32,
    /// From there to the lamp.
    distance: f32,
    /// Angles of the ray's two ends.
    angles: [f32; 2],
}

impl Pivot {
    /// For a ray of a unit direction through a medium. `None` where it is not worth while.
    pub fn new(medium: &Medium, part: &Ray, place: Vec3) -> Option<Self> {
        let sigma = medium.uniform()?.sigma_t;
        let nearest = (place - part.o).dot(part.d);
        // A lamp on the ray itself must not make the angles meet.
        let least = 1e-6 * (place.abs() + part.o.abs()).max_element();
        let distance = (place - part.at(nearest)).length().max(least);
        let angle = |t: f32| ((t - nearest) / distance).atan();
        let angles = [angle(0.0), angle(part.tmax)];
        let worth = distance * sigma.min_element() < NEAR && distance > 0.0 && angles[1] > angles[0];
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

    /// Share of the light at the distance `t` that is left to flights of a path as it was before.
    pub fn share_of_flight(&self, medium: &Medium, before: &Carried, t: f32) -> f32 {
        let Some(way) = collision(medium, t) else { return 1.0 };
        let flight = before.probability(way.density);
        if flight > 0.0 { flight / (flight + self.pdf(t)) } else { 0.0 }
    }
}

/// What a collision makes of the light, and its density.
fn collision(medium: &Medium, t: f32) -> Option<Passage> {
    match medium {
        Medium::Homogeneous(m) => Some(m.collision(t)),
        Medium::Heterogeneous(_) => None,
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
        let Some(way) = collision(medium, t) else { return };
        // The path as a flight would have brought it there; the light as the angle did.
        let mut carried = walk.carried;
        carried.take(way);
        carried.reach = 1.0;
        let share = pivot.share_of_flight(medium, &walk.carried, t);
        let layer = walk.class.after_camera_medium().layer();
        let scattering = Scattering { medium: walk.medium, carried, layer, share };
        self.light_medium(&scattering, medium.phase(), part.at(t), -part.d, lamp, sample, scratch);
    }
}
