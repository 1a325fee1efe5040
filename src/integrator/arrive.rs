//! The end of a camera ray, before anything is scattered there.

use super::direct::power_heuristic;
use crate::film::{Layer, Radiance};
use crate::math::{Color, Ray, Vec3};
use crate::scene::{Hit, Scene, Surface};

/// How a lamp at the end of the ray counts.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Lamps and environment are seen: always, but by camera rays of a scene that hides them.
    pub lamps: bool,
    /// Lamps that are not seen let the ray pass.
    pub through: bool,
    /// Density and place of the scattering that next event estimation shares its light with; 0 where
    /// nothing else finds the light.
    pub pdf: f32,
    pub from: Vec3,
}

/// What a ray came to.
#[derive(Debug)]
pub enum Arrival {
    /// It left the scene.
    Gone,
    /// It goes on behind a hidden lamp, which costs no segment.
    Behind,
    At(Surface),
}

impl Sight {
    /// Share of light that next event estimation finds with density `pdf_direct`.
    #[inline(always)]
    fn weight(&self, pdf_direct: f32) -> f32 {
        if self.pdf > 0.0 { power_heuristic(self.pdf, pdf_direct) } else { 1.0 }
    }
}

/// Adds what shines at the end of `ray` to `layer` of `out`.
#[inline(always)]
pub fn arrive(
    scene: &Scene,
    ray: &mut Ray,
    hit: Option<&Hit>,
    sight: Sight,
    throughput: Color,
    layer: Layer,
    out: &mut Radiance,
) -> Arrival {
    let Some(hit) = hit else {
        if sight.lamps {
            for (radiance, pdf) in scene.background(ray.d) {
                out.add(layer, throughput * radiance * sight.weight(pdf));
            }
        }
        return Arrival::Gone;
    };
    let s = scene.surface(ray, hit);
    if !sight.lamps && sight.through && scene.is_lamp(&s) {
        *ray = Ray { tmax: ray.tmax - hit.t, ..s.leave(ray.d) };
        return Arrival::Behind;
    }
    out.alpha = 1.0;
    let emitted = scene.emitted(&s, -ray.d);
    if emitted.max_element() > 0.0 && sight.lamps {
        let weight = sight.weight(scene.pdf_direct_surface(sight.from, ray.d, &s));
        out.add(layer, throughput * emitted * weight);
    }
    Arrival::At(s)
}
