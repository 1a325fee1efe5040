//! From a ray to the next vertex of its path: the same for camera paths, light paths and pilots.
//!
//! A hidden lamp lets the ray go on. Masks and index-matched boundaries are surfaces like others: whether
//! light passes straight through is drawn with their other lobes (`Event::Null`), and costs a segment.
//! In scenes with media, [`super::media`] goes along.

use crate::math::Ray;
use crate::scene::{Hit, Scene, Surface};

/// What a ray comes to.
#[derive(Debug)]
pub enum Next {
    /// It leaves the scene.
    Escape,
    /// It goes on behind a lamp that is not seen; that costs no segment.
    Behind,
    /// A surface.
    Surface(Surface),
}

/// What lamps are to a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamps {
    /// Surfaces like others.
    Solid,
    /// Not there.
    Transparent,
}

/// Traces `ray` and says what it comes to. Behind a lamp that is not there the ray has moved on.
#[inline(always)]
pub fn next(scene: &Scene, ray: &mut Ray, lamps: Lamps) -> Next {
    let hit = scene.geometry.closest(ray);
    arrive(scene, ray, hit.as_ref(), lamps)
}

/// The same for a ray of a bundle, whose closest `hit` was found with those of the others.
#[inline(always)]
pub fn arrive(scene: &Scene, ray: &mut Ray, hit: Option<&Hit>, lamps: Lamps) -> Next {
    let Some(hit) = hit else { return Next::Escape };
    let s = scene.surface(ray, hit);
    if lamps == Lamps::Transparent && scene.is_lamp(&s) {
        *ray = Ray { tmax: ray.tmax - hit.t, ..s.leave(ray.d) };
        return Next::Behind;
    }
    Next::Surface(s)
}
