//! What shines at the end of a camera ray, before anything is scattered there.

use super::direct::power_heuristic;
use crate::film::Radiance;
use crate::math::{Color, Ray, Vec3};
use crate::scene::{Hit, Scene, Surface};
use crate::transport::walk::{self, Lamps};
use crate::transport::{PathClass, Smallness};

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
    /// Lamps of this smallness as seen from there, and smaller ones, are left to photons.
    pub left: Option<Smallness>,
    /// Of the light of a lamp with a surface; the rest is brought by other samples of the pixel.
    pub share: f32,
}

/// What a camera path is when its next ray is traced.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    /// Of the path up to the ray.
    pub throughput: Color,
    /// Where the light belongs that it meets.
    pub class: PathClass,
}

impl Sight {
    /// Share of light that next event estimation finds with density `pdf_direct`.
    #[inline(always)]
    fn weight(&self, pdf_direct: f32) -> f32 {
        if self.pdf > 0.0 { power_heuristic(self.pdf, pdf_direct) } else { 1.0 }
    }

    /// Whether photons account for a lamp that next event estimation finds with density `pdf_direct`.
    #[inline(always)]
    fn leaves(&self, pdf_direct: f32) -> bool {
        self.left.is_some_and(|least| Smallness::of(pdf_direct) >= least)
    }

    /// What lamps are to the ray.
    #[inline(always)]
    fn of_lamps(&self) -> Lamps {
        if !self.lamps && self.through { Lamps::Transparent } else { Lamps::Solid }
    }

    /// Whether the ray passes the surface that it meets, see [`walk::passes`].
    #[inline(always)]
    pub fn passes(&self, scene: &Scene, ray: &mut Ray, hit: &Hit, s: &Surface) -> bool {
        walk::passes(scene, ray, hit, s, self.of_lamps())
    }

    /// Adds what shines from infinity at the end of a ray along the unit direction `d`.
    #[inline(always)]
    pub fn add_background(&self, scene: &Scene, d: Vec3, path: Carried, out: &mut Radiance) {
        if self.lamps {
            for (radiance, pdf) in scene.background(self.from, d).filter(|&(_, pdf)| !self.leaves(pdf)) {
                out.add(path.class.layer(), path.throughput * radiance * self.weight(pdf));
            }
        }
    }

    /// Adds what the surface at the end of a ray along the unit direction `d` emits, and marks the sample
    /// as covered.
    #[inline(always)]
    pub fn add_surface(&self, scene: &Scene, s: &Surface, d: Vec3, path: Carried, out: &mut Radiance) {
        out.alpha = 1.0;
        let emitted = scene.emitted(s, -d);
        if emitted.max_element() > 0.0 && self.lamps {
            let pdf = scene.pdf_direct_surface(self.from, d, s);
            if !self.leaves(pdf) {
                out.add(path.class.layer(), path.throughput * emitted * (self.weight(pdf) * self.share));
            }
        }
    }
}
