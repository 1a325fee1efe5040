//! What lies between a surface and a lamp.

use crate::emitter::DirectSample;
use crate::math::{Color, Ray, Vec3};
use crate::scene::{Scene, Surface};

/// The share of the light along the unit direction `d` that passes straight through the surface: a mask, or
/// a boundary between media of one index.
#[inline(always)]
pub fn transparency(scene: &Scene, s: &Surface, d: Vec3) -> f32 {
    scene.closure(s, s.frame.to_local(-d)).transparency()
}

/// The same in a scene with media, where it may be tinted: by panes, if they let light pass.
#[inline(always)]
pub fn passage(scene: &Scene, s: &Surface, d: Vec3) -> Color {
    let wi = s.frame.to_local(-d);
    let closure = scene.closure(s, wi);
    if scene.panes_pass { closure.passage(wi) } else { Color::splat(closure.transparency()) }
}

/// The share of a direct sample's light that arrives at `s`: 1 when nothing is in the way, else 0, or with
/// `transparent` what masks and index-matched boundaries let through. `segments` is how many more path
/// segments may be used; a surface that is passed costs [`Scene::passage`].
#[inline(always)]
pub fn visibility(
    scene: &Scene,
    s: &Surface,
    sample: &DirectSample,
    transparent: bool,
    segments: u32,
) -> f32 {
    let ray = shadow_ray(s, sample);
    if !transparent {
        return if scene.geometry.occluded(&ray) { 0.0 } else { 1.0 };
    }
    transparency_along(scene, ray, sample, segments)
}

/// What masks and index-matched boundaries let through.
#[inline(never)]
fn transparency_along(scene: &Scene, mut ray: Ray, sample: &DirectSample, segments: u32) -> f32 {
    let mut through = 1.0;
    let mut left = segments;
    while let Some(hit) = scene.geometry.closest(&ray) {
        let at = scene.surface(&ray, &hit);
        through *= transparency(scene, &at, sample.dir);
        if through == 0.0 || left <= scene.passage {
            return 0.0;
        }
        left -= scene.passage;
        let end = sample.target.unwrap_or(Vec3::ZERO);
        let o = at.origin(sample.dir);
        ray = match sample.target {
            Some(_) if (end - o).dot(sample.dir) <= 0.0 => return through,
            Some(_) => Ray { o, d: end - o, tmax: 1.0 },
            None => Ray::new(o, sample.dir),
        };
    }
    through
}

/// The ray that decides whether a direct sample is visible from `s`.
#[inline(always)]
pub fn shadow_ray(s: &Surface, sample: &DirectSample) -> Ray {
    sample.ray_from(s.origin(sample.dir))
}
