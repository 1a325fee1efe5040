use super::phase::Phase;
use super::{Carried, Coefficients, Participate, Passage};
use crate::math::{Color, Ray, Vec3};
use crate::sampling::Sampler;

/// A medium that is the same everywhere.
#[derive(Clone, Debug)]
pub struct Homogeneous {
    coefficients: Coefficients,
    phase: Phase,
    scatters: bool,
}

impl Homogeneous {
    /// From coefficients of 0 or more, σs no greater than σt.
    pub fn new(coefficients: Coefficients, phase: Phase) -> Self {
        Self { coefficients, phase, scatters: coefficients.sigma_s.max_element() > 0.0 }
    }

    /// What a collision after the distance `s` makes of the light, and its density.
    #[inline(always)]
    pub fn collision(&self, s: f32) -> Passage {
        let c = &self.coefficients;
        let left = left(c.sigma_t, s);
        Passage { left: c.sigma_s * left, density: c.sigma_t * left }
    }
}

/// e^−σs; 1 after an infinite distance where σ is 0.
#[inline(always)]
pub(super) fn left(sigma: Color, s: f32) -> Color {
    let depth = sigma * s;
    // 0·∞ is no number.
    if depth.is_nan() { sigma.map(|x| if x > 0.0 { (-x * s).exp() } else { 1.0 }) } else { exp(depth * -1.0) }
}

#[inline(always)]
fn exp(x: Color) -> Color {
    match x.uniform() {
        Some(x) => Color::splat(x.exp()),
        None => x.exp(),
    }
}

/// ∫e^−σt dt from 0 to `s`.
fn integral(sigma: Color, s: f32) -> Color {
    let whole = sigma.map(|x| {
        let depth = x * s;
        if depth > 0.0 { -(-depth).exp_m1() / x } else { s }
    });
    // A lane that nothing extinguishes has no end in an infinite medium; it must not spoil the others.
    whole.map(|x| if x.is_finite() { x } else { 0.0 })
}

/// A distance drawn for one lane, in units of length; infinite where nothing is extinguished.
#[inline(always)]
pub(super) fn draw(sigma: Color, carried: &Carried, sampler: &mut Sampler) -> f32 {
    let u = sampler.next_1d();
    let sigma = sigma.uniform().unwrap_or_else(|| sigma.lanes()[carried.lane(sampler.random())]);
    if sigma > 0.0 { -(-u).ln_1p() / sigma } else { f32::INFINITY }
}

impl Participate for Homogeneous {
    #[inline]
    fn at(&self, _: Vec3, _: Vec3) -> Coefficients {
        self.coefficients
    }

    #[inline]
    fn pass(&self, ray: &Ray, _: &mut Sampler) -> Passage {
        let left = left(self.coefficients.sigma_t, ray.tmax * ray.d.length());
        Passage { left, density: if self.scatters { left } else { Color::ONE } }
    }

    #[inline]
    fn fly(
        &self,
        ray: &Ray,
        carried: &mut Carried,
        emitted: &mut Color,
        sampler: &mut Sampler,
    ) -> Option<f32> {
        let unit = ray.d.length();
        let end = ray.tmax * unit;
        let c = &self.coefficients;
        if self.emits() {
            *emitted += carried.weight * c.emission * integral(c.sigma_t, end);
        }
        let s = if self.scatters { draw(c.sigma_t, carried, sampler) } else { f32::INFINITY };
        if s < end {
            carried.take(self.collision(s));
            return Some(s / unit);
        }
        carried.take(self.pass(ray, sampler));
        None
    }

    #[inline(always)]
    fn phase(&self) -> &Phase {
        &self.phase
    }

    fn scatters(&self) -> bool {
        self.scatters
    }

    fn emits(&self) -> bool {
        self.coefficients.emission.max_element() > 0.0
    }

    #[inline(always)]
    fn uniform(&self) -> Option<Coefficients> {
        Some(self.coefficients)
    }

    fn mean(&self) -> Coefficients {
        self.coefficients
    }
}
