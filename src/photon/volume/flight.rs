//! How far light gets in a medium, by null collisions (Woodcock et al. 1965).
//!
//! At each collision with the bound of the extinction the light scatters, passes, or is absorbed, with probabilities
//! that follow the largest lane of what it would carry on: so photons stay alike. Where all lanes are extinguished
//! alike a flight carries the same flux all along; elsewhere it changes at null collisions, and nowhere between them.

use crate::math::{Color, Ray, Vec3};
use crate::medium::{Majorants, Medium};
use crate::sampling::Sampler;

/// What a flight comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// The end of the ray.
    Passed,
    /// A collision at this distance after which it goes on elsewhere.
    Scattered(f32),
    /// It ends on the way.
    Absorbed,
}

/// Flies along a ray of unit direction, and changes the flux by what happens: at a collision to what is scattered. Calls
/// `way(from, to, flux)` for each part of the way, in order, that is covered with one flux, where the medium scatters.
pub fn fly(
    medium: &Medium,
    ray: &Ray,
    flux: &mut Color,
    sampler: &mut Sampler,
    way: &mut impl FnMut(f32, f32, Color),
) -> Flight {
    if !medium.scatters() {
        *flux *= medium.pass(ray, sampler).left;
        return if flux.max_element() > 0.0 { Flight::Passed } else { Flight::Absorbed };
    }
    let mut course = Course { medium, ray, flux, way, from: 0.0 };
    let end = match medium {
        Medium::Homogeneous(_) => {
            let majorant = medium.mean().sigma_t.max_element();
            let end = course.part(0.0, ray.tmax, majorant, sampler);
            if end.is_none() {
                course.covered(Some(ray.tmax));
            }
            end
        }
        Medium::Heterogeneous(m) => course.parts(m.majorants(), sampler),
    };
    end.unwrap_or(Flight::Passed)
}

struct Course<'a, F> {
    medium: &'a Medium,
    ray: &'a Ray,
    flux: &'a mut Color,
    way: &'a mut F,
    /// Where the present flux began.
    from: f32,
}

impl<F: FnMut(f32, f32, Color)> Course<'_, F> {
    fn parts(&mut self, majorants: &Majorants, sampler: &mut Sampler) -> Option<Flight> {
        let mut reached = None;
        for part in majorants.along(self.ray) {
            if part.majorant <= 0.0 {
                continue;
            }
            if reached != Some(part.begin) {
                self.covered(reached);
                self.from = part.begin;
            }
            let end = self.part(part.begin, part.end, part.majorant, sampler);
            if end.is_some() {
                return end;
            }
            reached = Some(part.end);
        }
        self.covered(reached);
        None
    }

    /// The way is covered with the present flux up to here.
    fn covered(&mut self, to: Option<f32>) {
        if let Some(to) = to {
            (self.way)(self.from, to, *self.flux);
        }
    }

    /// A part with one bound; `None` at its end.
    fn part(&mut self, begin: f32, end: f32, majorant: f32, sampler: &mut Sampler) -> Option<Flight> {
        let mut t = begin;
        // The first of the numbers is stratified.
        let mut u = if begin == 0.0 { sampler.next_1d() } else { sampler.random() };
        loop {
            t -= (-u).ln_1p() / majorant;
            if t >= end {
                return None;
            }
            if let Some(flight) = self.collide(t, majorant, sampler) {
                return Some(flight);
            }
            u = sampler.random();
        }
    }

    /// A collision with the bound; `None` if the flight goes on.
    fn collide(&mut self, t: f32, majorant: f32, sampler: &mut Sampler) -> Option<Flight> {
        let p: Vec3 = self.ray.at(t);
        let c = self.medium.at(p, self.ray.d);
        let before = *self.flux;
        let most = before.max_element();
        // Rounding at the border of a cell may find a value of the next one.
        let null = before * (Color::ONE - (c.sigma_t / majorant).min(Color::ONE));
        let scattered = before * (c.sigma_s / majorant);
        let (q_null, q_scattered) = (null.max_element() / most, scattered.max_element() / most);
        let scale = 1.0 / (q_null + q_scattered).max(1.0);
        let u = sampler.random();
        if u < q_scattered * scale {
            (self.way)(self.from, t, before);
            *self.flux = scattered / (q_scattered * scale);
            return Some(Flight::Scattered(t));
        }
        if u >= (q_null + q_scattered) * scale {
            (self.way)(self.from, t, before);
            return Some(Flight::Absorbed);
        }
        if c.sigma_t.uniform().is_none() {
            (self.way)(self.from, t, before);
            self.from = t;
            *self.flux = null / (q_null * scale);
        }
        None
    }
}
