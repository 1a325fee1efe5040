//! The end of a camera ray, before anything is scattered there.

use super::direct::power_heuristic;
use crate::film::Radiance;
use crate::math::{Color, Ray, Vec3};
use crate::scene::{Hit, Scene};
use crate::transport::PathClass;
use crate::transport::walk::{self, Lamps, Next};

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

impl Sight {
    /// Share of light that next event estimation finds with density `pdf_direct`.
    #[inline(always)]
    fn weight(&self, pdf_direct: f32) -> f32 {
        if self.pdf > 0.0 { power_heuristic(self.pdf, pdf_direct) } else { 1.0 }
    }

    #[inline(always)]
    fn of_lamps(&self) -> Lamps {
        if !self.lamps && self.through { Lamps::Transparent } else { Lamps::Solid }
    }
}

/// What a camera path is when its next ray is traced.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    pub throughput: Color,
    /// Where the light belongs that it meets.
    pub class: PathClass,
}

/// Adds what shines at the end of `ray` to `out`.
#[inline(always)]
pub fn arrive(
    scene: &Scene,
    ray: &mut Ray,
    hit: Option<&Hit>,
    sight: Sight,
    path: Carried,
    out: &mut Radiance,
) -> Next {
    let next = walk::arrive(scene, ray, hit, sight.of_lamps());
    let layer = path.class.layer();
    match &next {
        Next::Escape if sight.lamps => {
            for (radiance, pdf) in scene.background(ray.d) {
                out.add(layer, path.throughput * radiance * sight.weight(pdf));
            }
        }
        Next::Escape | Next::Behind => {}
        Next::Surface(s) => {
            out.alpha = 1.0;
            let emitted = scene.emitted(s, -ray.d);
            if emitted.max_element() > 0.0 && sight.lamps {
                let weight = sight.weight(scene.pdf_direct_surface(sight.from, ray.d, s));
                out.add(layer, path.throughput * emitted * weight);
            }
        }
    }
    next
}
