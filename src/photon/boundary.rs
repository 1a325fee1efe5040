//! Density near edges: where part of the search disc lies off the surface no photon can land, and the
//! plain estimate is too dark (half of the light is missing at an edge, three quarters in a corner).
//!
//! The estimate is divided by the share c of the kernel's mass that lies on the surface. 1/c is drawn
//! without bias by inverse binomial sampling: points of the disc are drawn from the kernel until
//! [`WANTED`] of them are on the surface; n trials then have the mean WANTED/c. Far from edges two
//! trials always do.

use super::kernel::KernelKind;
use super::store::HEIGHT;
use crate::math::{Frame, Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Scene, Surface};

/// Points that must be found on the surface.
const WANTED: u32 = 2;
/// Trials at most; reached only where less than a tenth of the disc is surface.
const MOST: u32 = 20;

/// What the trials need.
#[derive(Debug)]
pub struct Boundary<'a> {
    pub scene: &'a Scene,
    pub sampler: &'a mut Sampler,
    pub rays: &'a mut u64,
}

impl Boundary<'_> {
    /// Factor for an estimate at `s`, on the side of the unit normal `n`.
    pub fn correction(&mut self, s: &Surface, n: Vec3, radius: f32, kernel: KernelKind) -> f32 {
        let frame = Frame::from_normal(n);
        let mut found = 0;
        let mut trials = 0;
        while found < WANTED && trials < MOST {
            trials += 1;
            found += u32::from(self.on_surface(s, &frame, radius, kernel));
        }
        trials as f32 / WANTED as f32
    }

    /// Draws a point of the disc and looks for the surface there. The point must be in sight of the
    /// centre: along the surface, which sees beneath things that touch it, or over a gentle rise, which
    /// sees across a hollow. And there must be surface below it at a height at which photons count.
    fn on_surface(&mut self, s: &Surface, frame: &Frame, radius: f32, kernel: KernelKind) -> bool {
        let (x, y) = self.draw(kernel);
        let aside = (frame.s * x + frame.t * y) * radius;
        let rise = aside.length() * HEIGHT;
        let start = s.p + frame.n * s.lift;
        let above = start + aside + frame.n * rise;
        let blocked = self.blocked(start, start + aside) && self.blocked(start, above);
        !blocked && self.blocked(above, above - frame.n * (2.0 * (rise + s.lift)))
    }

    fn blocked(&mut self, from: Vec3, to: Vec3) -> bool {
        *self.rays += 1;
        self.scene.geometry.occluded(&Ray { o: from, d: to - from, tmax: 1.0 })
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
