use super::homogeneous::{draw, left};
use super::phase::Phase;
use super::{Carried, Coefficients, Majorants, Participate, Passage, Volume};
use crate::math::{Color, Ray, Vec3};
use crate::sampling::Sampler;

/// What is scattered of the extinction.
#[derive(Clone, Debug)]
pub enum Scattering {
    /// Share of the extinction; clamped to 0 … 1.
    Albedo(Volume),
    /// σs itself; no more than the extinction counts.
    Coefficient(Volume),
}

/// A medium that varies from place to place. Flights are drawn by null collisions (Woodcock et al. 1965): as if the
/// extinction were its bound everywhere, with collisions in which nothing happens in between.
#[derive(Clone, Debug)]
pub struct Heterogeneous {
    /// Per unit of length, for a phase function of area 1.
    extinction: Volume,
    scattering: Scattering,
    /// Radiance that what absorbs emits.
    radiance: Option<Volume>,
    phase: Phase,
    majorants: Majorants,
    /// The extinction, if it is the same everywhere and in all directions.
    constant: Option<Color>,
    scatters: bool,
    /// Kept, because rays ask for it and it takes a walk over all of the grid.
    mean: Coefficients,
}

/// Light left at which an estimate plays roulette, and the probability of going on.
const LITTLE: f32 = 0.05;
const KEEP: f32 = 0.25;

impl Heterogeneous {
    /// See the fields; all numbers are finite and none is negative.
    pub fn new(extinction: Volume, scattering: Scattering, radiance: Option<Volume>, phase: Phase) -> Self {
        let largest_area = phase.largest_area();
        let majorants = Majorants::new(&extinction, largest_area);
        let constant = match extinction {
            Volume::Constant(c) if !phase.has_area() => Some(c),
            _ => None,
        };
        let (Scattering::Albedo(volume) | Scattering::Coefficient(volume)) = &scattering;
        let scatters = volume.largest() > 0.0 && extinction.largest() > 0.0;
        let mean = mean(&extinction, &scattering, radiance.as_ref());
        Self { extinction, scattering, radiance, phase, majorants, constant, scatters, mean }
    }

    /// Bounds of the extinction, for walks of one's own.
    pub fn majorants(&self) -> &Majorants {
        &self.majorants
    }

    /// Density per length of a flight that came to a collision at the distance `t` of a ray of unit direction, over the
    /// probability of all that it drew on the way there and of the collision.
    pub fn rate(&self, ray: &Ray, t: f32) -> f32 {
        if self.constant.is_some() { 1.0 } else { self.majorants.at(ray, t) }
    }

    /// [`Participate::fly`] where the extinction is a constant.
    fn fly_evenly(
        &self,
        sigma: Color,
        ray: &Ray,
        carried: &mut Carried,
        emitted: &mut Color,
        sampler: &mut Sampler,
    ) -> Option<f32> {
        let unit = ray.d.length();
        let end = ray.tmax * unit;
        let s = draw(sigma, carried, sampler);
        if s >= end {
            let left = left(sigma, end);
            carried.take(Passage { left, density: left });
            return None;
        }
        let t = s / unit;
        let c = self.at(ray.at(t), ray.d / unit);
        let left = left(sigma, s);
        let density = sigma * left;
        let m = carried.probability(density);
        if m > 0.0 {
            *emitted += carried.weight * c.emission * left / m;
        }
        carried.take(Passage { left: c.sigma_s * left, density });
        Some(t)
    }

    /// A flight by null collisions. `real` decides about a collision in which less than all goes on.
    #[inline(always)]
    fn track(
        &self,
        ray: &Ray,
        sampler: &mut Sampler,
        mut real: impl FnMut(&Coefficients, f32, &mut Sampler) -> Collision,
    ) -> Option<f32> {
        let unit = ray.d.length();
        let d = ray.d / unit;
        for part in self.majorants.along(ray) {
            if part.majorant <= 0.0 {
                continue;
            }
            let rate = part.majorant * unit;
            let length = part.end - part.begin;
            let mut s = 0.0;
            loop {
                s -= (-sampler.random()).ln_1p() / rate;
                if s >= length {
                    break;
                }
                let t = part.begin + s;
                let c = self.at(ray.at(t), d);
                match real(&c, part.majorant, sampler) {
                    Collision::Null => {}
                    Collision::Real => return Some(t),
                    Collision::End => return None,
                }
            }
        }
        None
    }
}

/// What a collision of a flight comes to.
enum Collision {
    Null,
    Real,
    /// Nothing is left.
    End,
}

/// Probability for each lane that a collision is none.
#[inline(always)]
fn null(c: &Coefficients, majorant: f32) -> Color {
    // Rounding at the border of a cell may find a value of the next one.
    Color::ONE - (c.sigma_t / majorant).min(Color::ONE)
}

impl Participate for Heterogeneous {
    #[inline]
    fn at(&self, p: Vec3, d: Vec3) -> Coefficients {
        let area = self.phase.area(p, d);
        let sigma_t = self.extinction.color(p) * area;
        let sigma_s = match &self.scattering {
            Scattering::Albedo(albedo) => sigma_t * albedo.color(p).clamp(Color::ZERO, Color::ONE),
            Scattering::Coefficient(sigma_s) => (sigma_s.color(p) * area).min(sigma_t),
        };
        let emission = match &self.radiance {
            Some(radiance) => (sigma_t - sigma_s) * radiance.color(p),
            None => Color::ZERO,
        };
        Coefficients { sigma_t, sigma_s, emission }
    }

    #[inline]
    fn pass(&self, ray: &Ray, sampler: &mut Sampler) -> Passage {
        let mut whole = Color::ONE;
        let mut kept = 1.0;
        if let Some(sigma) = self.constant {
            whole = left(sigma, ray.tmax * ray.d.length());
        } else {
            self.track(ray, sampler, |c, majorant, sampler| {
                whole *= null(c, majorant);
                let most = whole.max_element() * kept;
                if most >= LITTLE {
                    return Collision::Null;
                }
                if most > 0.0 && sampler.random() < KEEP {
                    kept /= KEEP;
                    return Collision::Null;
                }
                kept = 0.0;
                Collision::End
            });
        }
        // The density of a flight has no part in the roulette of this one.
        Passage { left: whole * kept, density: if self.scatters { whole } else { Color::ONE } }
    }

    #[inline]
    fn fly(
        &self,
        ray: &Ray,
        carried: &mut Carried,
        emitted: &mut Color,
        sampler: &mut Sampler,
    ) -> Option<f32> {
        if let Some(sigma) = self.constant.filter(|_| self.scatters) {
            return self.fly_evenly(sigma, ray, carried, emitted, sampler);
        }
        self.track(ray, sampler, |c, majorant, sampler| {
            *emitted += carried.weight * c.emission / majorant;
            let null = null(c, majorant);
            if !self.scatters {
                carried.take(Passage { left: null, density: Color::ONE });
                return if carried.alive() { Collision::Null } else { Collision::End };
            }
            if sampler.random() < carried.probability(null) {
                carried.take(Passage { left: null, density: null });
                return Collision::Null;
            }
            carried.take(Passage { left: c.sigma_s / majorant, density: Color::ONE - null });
            Collision::Real
        })
    }

    #[inline(always)]
    fn phase(&self) -> &Phase {
        &self.phase
    }

    fn scatters(&self) -> bool {
        self.scatters
    }

    fn emits(&self) -> bool {
        self.radiance.is_some()
    }

    #[inline(always)]
    fn mean(&self) -> Coefficients {
        self.mean
    }
}

fn mean(extinction: &Volume, scattering: &Scattering, radiance: Option<&Volume>) -> Coefficients {
    let sigma_t = extinction.mean();
    let sigma_s = match scattering {
        Scattering::Albedo(albedo) => sigma_t * albedo.mean().clamp(Color::ZERO, Color::ONE),
        Scattering::Coefficient(sigma_s) => sigma_s.mean().min(sigma_t),
    };
    let emission = radiance.map_or(Color::ZERO, |r| (sigma_t - sigma_s) * r.mean());
    Coefficients { sigma_t, sigma_s, emission }
}
