//! Light of lamps that a medium scatters once into a ray: what photon mapping leaves to shadow rays.

use super::{Step, VolumePathTracer, Walk};
use crate::integrator::{CameraSample, Scratch, Task};
use crate::math::{Color, Ray};
use crate::medium::{Carried, MediumId};
use crate::transport::PathClass;
use crate::transport::media::MOST_PASSED;

impl<'a> VolumePathTracer<'a> {
    /// For [`VolumePathTracer::scatter_once`]: after one scattering there is one ray left.
    pub fn once(task: Task<'a>) -> Self {
        Self { max_depth: 2, ..Self::new(task) }
    }

    /// Adds what comes along `part`, of a unit direction and in `medium` all along, times `throughput`.
    pub fn scatter_once(
        &self,
        part: &Ray,
        medium: MediumId,
        throughput: Color,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let mut walk = Walk {
            ray: *part,
            medium: Some(medium),
            carried: Carried::new(throughput),
            eta: 1.0,
            class: PathClass::FROM_CAMERA,
            pdf: 0.0,
            from: part.o,
            depth: 0,
            passed: 0,
        };
        let MediumId(index) = medium;
        let medium = &self.scene.media[index as usize];
        let lamp = self.lamp_numbers(&mut sample.sampler);
        let pivot = self.pivot(medium, part, &walk, lamp);
        if let Some(pivot) = &pivot {
            self.light_near(medium, part, &walk, (pivot, lamp), sample, scratch);
        }
        let before = walk.carried;
        let mut emitted = Color::ZERO;
        let t = medium.fly(part, &mut walk.carried, &mut emitted, &mut sample.sampler);
        let Some(t) = t else { return };
        let share = pivot.map_or(1.0, |pivot| pivot.share_of_flight(medium, &before, t));
        let mut step = self.scatter_in(medium, &mut walk, t, (lamp, share), sample, scratch);
        while matches!(step, Step::On)
            && walk.depth < self.max_depth
            && walk.passed < MOST_PASSED
            && walk.carried.alive()
        {
            scratch.rays += 1;
            let hit = self.scene.geometry.closest(&walk.ray);
            step = self.step(&mut walk, hit.as_ref(), sample, scratch);
        }
    }
}
