//! Light of lamps that a medium scatters once into a ray: what photon mapping leaves to shadow rays.

use super::{Step, VolumePathTracer, Walk};
use crate::integrator::{CameraSample, Scratch, Task};
use crate::math::{Color, Ray};
use crate::medium::MediumId;

impl<'a> VolumePathTracer<'a> {
    /// For [`VolumePathTracer::scatter_once`]: after one scattering there is one ray left.
    pub fn once(task: Task<'a>) -> Self {
        Self { max_depth: 2, ..Self::new(task) }
    }

    /// Adds what comes along `part`, of a unit direction and in `medium` all along, times `throughput`. The medium does
    /// not shine: scenes whose media do are path traced.
    pub fn scatter_once(
        &self,
        part: &Ray,
        medium: MediumId,
        throughput: Color,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let mut walk = Walk::new(*part, Some(medium), throughput);
        let Some(medium) = self.scene.medium(walk.medium) else { return };
        if let Some(Step::On) = self.through(medium, part, &mut walk, sample, scratch) {
            self.go_on(&mut walk, sample, scratch);
        }
    }
}
