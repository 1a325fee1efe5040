//! From a ray to the next vertex of its path: the same for camera paths, light paths and pilots.
//!
//! What the ray meets first is a surface ([`Scene::surface`]); a hidden lamp lets the ray go on ([`passes`]). Masks and
//! index-matched boundaries are surfaces like others: whether light passes straight through is drawn with their other
//! lobes (`Event::Null`), and costs [`Scene::passage`] segments. In scenes with media, [`super::media`] goes along.

use super::visibility::transparency;
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::scene::{Hit, Scene, Surface};

/// What lamps are to a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamps {
    /// Surfaces like others.
    Solid,
    /// Not there.
    Transparent,
}

/// Whether the ray passes the surface `s` that it meets, which is a lamp that is not there. The ray has moved on behind
/// it then; that costs no segment.
#[inline(always)]
pub fn passes(scene: &Scene, ray: &mut Ray, hit: &Hit, s: &Surface, lamps: Lamps) -> bool {
    let passes = lamps == Lamps::Transparent && scene.is_lamp(s);
    if passes {
        *ray = Ray { tmax: ray.tmax - hit.t, ..s.leave(ray.d) };
    }
    passes
}

/// Whether a path that may have no further segment goes straight on through the surface `s`, where that costs none: drawn
/// by chance. The ray has moved on behind it then.
#[inline(always)]
pub fn slips_through(scene: &Scene, ray: &mut Ray, s: &Surface, sampler: &mut Sampler) -> bool {
    if scene.passage > 0 {
        return false;
    }
    let through = transparency(scene, s, ray.d);
    let passes = through > 0.0 && sampler.next_1d() < through;
    if passes {
        *ray = s.leave(ray.d);
    }
    passes
}
