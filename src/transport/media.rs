//! Rays through media. A medium changes where a surface is a boundary, whether light is refracted there or passes
//! straight through.
//!
//! [`Scene::medium_beyond`] says what lies behind one.

use super::shadow_ray;
use crate::emitter::DirectSample;
use crate::math::{Color, Ray};
use crate::medium::{MediumId, Passage};
use crate::sampling::Sampler;
use crate::scene::{Scene, Surface};

/// Surfaces that a ray may pass straight through before it counts as lost.
pub const MOST_PASSED: u32 = 1 << 20;

/// Straight from a place to a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// To the lamp, as [`shadow_ray`] makes it.
    pub ray: Ray,
    /// How far behind its start the surface lies that it comes from; see [`within`].
    pub gap: f32,
    /// What it starts in.
    pub medium: Option<MediumId>,
}

/// What of a ray up to `end` is in the medium it starts in: all of it, and the `gap` behind its start, since it starts
/// off a surface. Between many boundaries, and where a medium is dense, that gap counts. An eighth of it is left out:
/// rounding could put a place nearer to the surface on its other side.
#[inline(always)]
pub fn within(ray: &Ray, gap: f32, end: f32) -> Ray {
    let more = 0.875 * gap;
    Ray { o: ray.at(-more), d: ray.d, tmax: end + more }
}

impl Way {
    /// From a surface, to whose back a path in `medium` came.
    pub fn from_surface(scene: &Scene, s: &Surface, medium: Option<MediumId>, light: &DirectSample) -> Self {
        let ray = shadow_ray(s, light);
        Self { ray, gap: s.gap(ray.d), medium: scene.medium_beyond(s, light.dir, medium) }
    }

    /// What arrives of the light, and the density with which a scattered ray would have come as far: it passes
    /// through masks, index-matched boundaries and media. `rays` counts.
    pub fn passage(
        &self,
        scene: &Scene,
        light: &DirectSample,
        sampler: &mut Sampler,
        rays: &mut u64,
    ) -> Passage {
        const NOTHING: Passage = Passage { left: Color::ZERO, density: Color::ZERO };
        let Self { mut ray, mut gap, mut medium } = *self;
        let mut passage = Passage::FREE;
        for _ in 0..MOST_PASSED {
            *rays += 1;
            let hit = scene.geometry.closest(&ray);
            let at = hit.as_ref().map(|hit| scene.surface(&ray, hit));
            let through = at.as_ref().map_or(Color::ONE, |at| super::passage(scene, at, light.dir));
            if through.max_element() <= 0.0 {
                return NOTHING;
            }
            if let Some(m) = scene.medium(medium) {
                let end = hit.as_ref().map_or(ray.tmax, |hit| hit.t);
                passage = passage.then(m.pass(&within(&ray, gap, end), sampler));
            }
            passage.left *= through;
            let Some(at) = at.filter(|_| passage.left.max_element() > 0.0) else { return passage };
            medium = scene.medium_beyond(&at, light.dir, medium);
            match onward(&at, light) {
                Some(next) => (ray, gap) = (next, at.gap(next.d)),
                None => return passage,
            }
        }
        NOTHING
    }
}

/// The rest of a shadow ray behind a surface; `None` where the lamp is nearer than the lift.
fn onward(at: &Surface, light: &DirectSample) -> Option<Ray> {
    let ray = shadow_ray(at, light);
    match light.target {
        Some(_) if ray.d.dot(light.dir) <= 0.0 => None,
        _ => Some(ray),
    }
}
