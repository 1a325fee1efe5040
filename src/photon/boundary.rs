//! Density near edges: where part of the search disc lies off the surface no photon can land, and the
//! plain estimate is too dark (half of the light is missing at an edge, three quarters in a corner).
//!
//! The estimate is divided by the share c of the kernel's mass that lies on the surface. 1/c is drawn
//! without bias by inverse binomial sampling: points of the disc are drawn from the kernel until
//! [`WANTED`] of them are on the surface; n trials then have the mean WANTED/c. Far from edges two
//! trials always do.
//!
//! Photons lie on the surface even where the query cannot see it, behind a thin wall or across a corner:
//! where a trial met an obstacle, only photons in sight may be counted, by the same test.

use super::clearance::Clearance;
use super::store::{HEIGHT, Query};
use crate::math::kernel::KernelKind;
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Facts, Scene};

/// Points that must be found on the surface.
const WANTED: u32 = 2;
/// Most trials; reached only where less than a tenth of the disc is surface.
const MOST: u32 = 20;

/// What obstacles are looked for in.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Everything.
    pub scene: &'a Scene,
    /// Of the scene: without transmission all surfaces are opaque.
    pub facts: &'a Facts,
    /// Where no trials are needed, if that is known.
    pub clearance: Option<&'a Clearance>,
}

/// Surroundings and the random numbers for the trials.
#[derive(Debug)]
pub struct Boundary<'a> {
    /// Of the disc.
    pub around: Surroundings<'a>,
    /// Where the trials are drawn.
    pub sampler: &'a mut Sampler,
    /// Counts the rays of the trials.
    pub rays: &'a mut u64,
}

/// What the trials found.
#[derive(Clone, Copy, Debug)]
pub struct Correction {
    /// The estimate is multiplied by this.
    pub factor: f32,
    /// Something stands on the disc: photons count where [`Boundary::sees`] them.
    pub obstructed: bool,
}

/// The disc of a query, on the side of the unit normal `frame.n`.
struct Disc {
    p: Vec3,
    lift: f32,
    frame: Frame,
    radius: f32,
}

impl Disc {
    fn start(&self) -> Vec3 {
        self.p + self.frame.n * self.lift
    }

    /// Over the point at `aside`, as high as photons there may lie.
    fn above(&self, aside: Vec3) -> Vec3 {
        self.start() + aside + self.frame.n * (aside.length() * HEIGHT)
    }
}

impl Boundary<'_> {
    /// For an estimate within `radius` of the place of `q`.
    pub fn correction(&mut self, q: &Query, radius: f32, kernel: KernelKind) -> Correction {
        let Surroundings { scene, clearance, .. } = self.around;
        if clearance.is_some_and(|clearance| clearance.is_free(scene, q.p, q.lift, radius)) {
            // What follows is drawn from the same numbers as after trials.
            (0..WANTED).for_each(|_| _ = self.draw(kernel));
            return Correction { factor: 1.0, obstructed: false };
        }
        let disc = Disc { p: q.p, lift: q.lift, frame: Frame::from_normal(q.n), radius };
        let (mut found, mut trials, mut obstructed) = (0, 0, false);
        while found < WANTED && trials < MOST {
            trials += 1;
            let (x, y) = self.draw(kernel);
            let aside = (disc.frame.s * x + disc.frame.t * y) * radius;
            let hidden = !self.in_sight(&disc, aside);
            obstructed |= hidden;
            found += u32::from(!hidden && self.has_surface(&disc, aside));
        }
        Correction { factor: trials as f32 / WANTED as f32, obstructed }
    }

    /// Whether a photon at `p` counts for a query that is obstructed.
    pub fn sees(&mut self, q: &Query, radius: f32, p: Vec3) -> bool {
        let disc = Disc { p: q.p, lift: q.lift, frame: Frame::from_normal(q.n), radius };
        let offset = p - q.p;
        self.in_sight(&disc, offset - q.n * q.n.dot(offset))
    }

    /// Whether nothing stands between the centre and the point at `aside`: along the surface, which sees
    /// beneath things that touch it, or over a gentle rise, which sees across a hollow, or over whatever
    /// is lower than the disc is wide. Glass stands in nobody's way.
    fn in_sight(&mut self, disc: &Disc, aside: Vec3) -> bool {
        let (start, above) = (disc.start(), disc.above(aside));
        if !self.opaque(start, start + aside) || !self.opaque(start, above) {
            return true;
        }
        let high = start + disc.frame.n * disc.radius;
        !self.opaque(start, high) && !self.opaque(high, high + aside) && !self.opaque(high + aside, above)
    }

    /// Whether there is surface at `aside`, at a height at which photons count.
    fn has_surface(&mut self, disc: &Disc, aside: Vec3) -> bool {
        let above = disc.above(aside);
        let rise = aside.length() * HEIGHT + disc.lift;
        *self.rays += 1;
        self.around.scene.geometry.occluded(&between(above, above - disc.frame.n * (2.0 * rise)))
    }

    fn opaque(&mut self, from: Vec3, to: Vec3) -> bool {
        *self.rays += 1;
        let ray = between(from, to);
        if !self.around.scene.geometry.occluded(&ray) {
            return false;
        }
        !self.around.facts.transmission || self.opaque_beyond_glass(ray, to)
    }

    #[inline(never)]
    fn opaque_beyond_glass(&mut self, mut ray: Ray, to: Vec3) -> bool {
        // Each step passes a surface; what has more of them than this within a disc may as well be solid.
        for _ in 0..16 {
            *self.rays += 1;
            let Some(hit) = self.around.scene.geometry.closest(&ray) else { return false };
            let s = self.around.scene.surface(&ray, &hit);
            if !self.around.scene.material(&s).nature().transmits {
                return true;
            }
            let o = s.origin(ray.d);
            if (to - o).dot(ray.d) <= 0.0 {
                return false;
            }
            ray = between(o, to);
        }
        true
    }

    /// A point of the unit disc with the kernel's density, by rejection: no kernel rises outwards.
    fn draw(&mut self, kernel: KernelKind) -> (f32, f32) {
        let top = kernel.weight(0.0);
        loop {
            let x = 2.0 * self.sampler.random() - 1.0;
            let y = 2.0 * self.sampler.random() - 1.0;
            let u2 = x * x + y * y;
            if u2 < 1.0 && self.sampler.random() * top <= kernel.weight(u2) {
                return (x, y);
            }
        }
    }
}

fn between(from: Vec3, to: Vec3) -> Ray {
    Ray { o: from, d: to - from, tmax: 1.0 }
}
