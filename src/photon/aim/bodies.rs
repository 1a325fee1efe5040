//! Things that light goes through before it leaves photons.

use super::pilot::Pilot;
use crate::emitter::SceneSphere;
use crate::math::Vec3;
use crate::scene::Scene;

/// Most things that are looked for.
pub(super) const MOST: usize = 64;

/// A thing that so many paths met is found.
const MET: usize = 32;

/// Spheres around shapes with lobes sharper than roughness `glossy`, which throw caustics.
pub(super) fn sharp_bodies(scene: &Scene, glossy: f32) -> Vec<SceneSphere> {
    let sharp = |shape: u32| {
        scene.materials[scene.shapes[shape as usize].material as usize].nature().sharper_than(glossy)
    };
    scene.geometry.extents(sharp)
}

/// Some of the `bodies` that few paths of the pilot met first.
pub(super) fn missed(bodies: &[SceneSphere], pilot: &Pilot) -> Vec<SceneSphere> {
    let points: Vec<Vec3> = pilot.first_points().collect();
    let few = |body: &&SceneSphere| {
        let near = |p: &&Vec3| p.distance(body.center) <= 1.01 * body.radius;
        points.iter().filter(near).take(MET).count() < MET
    };
    // Looking for all of a forest would take long.
    let some = bodies.iter().step_by(bodies.len().div_ceil(16 * MOST).max(1));
    let missed: Vec<SceneSphere> = some.filter(few).copied().collect();
    missed.iter().step_by(missed.len().div_ceil(MOST).max(1)).copied().collect()
}
