//! From a ray to the next vertex of its path: the same for camera paths, light paths and pilots.
//!
//! What the ray meets first is a surface ([`Scene::surface`]); a hidden lamp lets the ray go on ([`passes`]). Masks and
//! index-matched boundaries are surfaces like others: whether light passes straight through is drawn with their other
//! lobes (`Event::Null`), and costs a segment. In scenes with media, [`super::media`] goes along.

use crate::math::Ray;
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
