//! Direct light at a surface point: next event estimation, and lamps met by scattered rays, weighed by
//! the power heuristic (Veach 1997, §9.2).

use crate::bsdf::{Range, Transport};
use crate::emitter::DirectSample;
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Facts, LampChoice, Scene};
use crate::transport::{Vertex, transparency, visibility};

/// The power heuristic with β = 2: the weight of a sample of density `a` that another strategy finds with density `b`.
#[inline]
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    // Ratios first: squares of densities near a small lamp overflow f32.
    // No branch: which one is larger cannot be predicted.
    let r = a.min(b) / a.max(b);
    let larger = 1.0 / (1.0 + r * r);
    if a >= b { larger } else { r * r * larger }
}

/// Light of a sampled emitter point, before visibility.
#[derive(Clone, Copy, Debug)]
pub struct Proposal {
    /// Scattered towards the viewer.
    pub value: Color,
    /// Where it comes from.
    pub light: DirectSample,
}

/// What scatters the light of lamps back along a path.
pub trait Receiver {
    /// Where.
    fn place(&self) -> Vec3;

    /// f · cos of what comes from the lamp, and the density with which a scattered ray goes there: 0 where nobody
    /// compares. `None` if nothing is scattered.
    fn receive(&self, light: &DirectSample) -> Option<(Color, f32)>;
}

/// Some lobes of a surface.
#[derive(Clone, Copy, Debug)]
pub struct AtSurface<'a> {
    /// The surface.
    pub vertex: &'a Vertex<'a>,
    /// Which of its lobes.
    pub lobes: Range,
    /// Scattered rays share the light.
    pub mis: bool,
}

impl Receiver for AtSurface<'_> {
    #[inline(always)]
    fn place(&self) -> Vec3 {
        self.vertex.surface.p
    }

    #[inline(always)]
    fn receive(&self, light: &DirectSample) -> Option<(Color, f32)> {
        let Vertex { surface: s, wi, ref closure, .. } = *self.vertex;
        let wo = s.frame.to_local(light.dir);
        let (f, pdf) = if self.mis && light.pdf > 0.0 {
            closure.eval_pdf(wi, wo, Transport::Radiance, self.lobes)
        } else {
            (closure.eval(wi, wo, Transport::Radiance, self.lobes), 0.0)
        };
        let f = f * wo.z.abs();
        (f.max_element() > 0.0).then_some((f, pdf))
    }
}

/// A sampled emitter point as a receiver sees it.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The probability of the emitter is divided out of its value.
    pub light: DirectSample,
    /// See [`Receiver::receive`].
    pub f: Color,
    pub pdf: f32,
}

impl Candidate {
    #[inline(always)]
    fn new(light: DirectSample, receiver: &impl Receiver) -> Option<Self> {
        let (f, pdf) = receiver.receive(&light)?;
        Some(Self { light, f, pdf })
    }

    /// Against a scattered ray that comes to the same place.
    #[inline(always)]
    fn weight(&self) -> f32 {
        if self.pdf > 0.0 && self.light.pdf > 0.0 { power_heuristic(self.light.pdf, self.pdf) } else { 1.0 }
    }

    /// Of one emitter. Of few, a point of each is looked at, and one is drawn in proportion to what it would bring were
    /// nothing in its way (resampled importance sampling: Talbot et al. 2005), times the share of that which arrives where
    /// the camera looks.
    #[inline(always)]
    pub fn choose(scene: &Scene, receiver: &impl Receiver, (pick, u): (f32, Vec2)) -> Option<Self> {
        let p = receiver.place();
        if !scene.direct.few() {
            return Self::new(scene.sample_direct(p, pick, u)?, receiver);
        }
        // First all, then the choice, which a processor cannot foresee: it would wait for it lamp by lamp.
        let (mut found, mut total, mut count) = ([None; LampChoice::FEW], 0.0, 0.0);
        for (lamp, found) in found.iter_mut().enumerate().take(scene.emitters.len()) {
            let Some(light) = scene.sample_lamp(lamp, p, u) else { continue };
            let Some(one) = Self::new(light, receiver) else { continue };
            let worth = (one.f * light.value).max_element() * one.weight();
            if worth > 0.0 {
                let arriving = worth * scene.direct.arriving(lamp);
                total += arriving;
                count += 1.0;
                *found = Some((one, arriving));
            }
        }
        let even = if total > 0.0 { scene.direct.even() } else { 1.0 };
        let probability =
            |arriving: f32| even / count + if even < 1.0 { (1.0 - even) * arriving / total } else { 0.0 };
        let mut rest = pick;
        let mut chosen = None;
        for (one, arriving) in found.iter().flatten() {
            // Rounding goes to the last.
            let probability = probability(*arriving);
            if probability > 0.0 {
                chosen = Some((one, probability));
            }
            if rest < probability {
                break;
            }
            rest -= probability;
        }
        let (one, probability) = chosen?;
        let light = DirectSample { value: one.light.value / probability, ..one.light };
        Some(Self { light, ..*one })
    }
}

/// Light from one sampled emitter point, scattered by `lobes` back along the path. With `mis` the sample
/// shares its weight with scattered rays. `segments` is how many path segments may follow.
#[inline(always)]
pub fn propose(
    scene: &Scene,
    facts: &Facts,
    vertex: &Vertex<'_>,
    lobes: Range,
    mis: bool,
    segments: u32,
    sampler: &mut Sampler,
) -> Option<Proposal> {
    let pick = if facts.many_lamps { sampler.next_1d() } else { 0.0 };
    let u = sampler.next_2d();
    if segments == 0 || !vertex.closure.has_smooth(vertex.wi, lobes) {
        return None;
    }
    let one = Candidate::choose(scene, &AtSurface { vertex, lobes, mis }, (pick, u))?;
    Some(Proposal { value: one.f * one.light.value * one.weight(), light: one.light })
}

/// [`propose`] times visibility.
#[inline(always)]
pub fn next_event(
    scene: &Scene,
    facts: &Facts,
    vertex: &Vertex<'_>,
    lobes: Range,
    mis: bool,
    segments: u32,
    sampler: &mut Sampler,
    rays: &mut u64,
) -> Color {
    let Some(p) = propose(scene, facts, vertex, lobes, mis, segments, sampler) else {
        return Color::ZERO;
    };
    *rays += 1;
    p.value * visibility(scene, vertex.surface, &p.light, facts.transparent_shadows, segments)
}

/// The other half of multiple importance sampling: light of the lamp that a direction drawn from `lobes` of the BSDF
/// meets.
pub fn scattered_lamp(
    scene: &Scene,
    vertex: &Vertex<'_>,
    lobes: Range,
    segments: u32,
    sampler: &mut Sampler,
    rays: &mut u64,
) -> Color {
    let Vertex { surface: s, wi, ref closure, .. } = *vertex;
    let (u, u_lobe) = (sampler.next_2d(), sampler.next_1d());
    if segments == 0 {
        return Color::ZERO;
    }
    let sample = closure.sample_smooth(wi, u_lobe, u, Transport::Radiance, lobes);
    let Some(sample) = sample else { return Color::ZERO };
    // The density that next_event compares with includes the choice of the lobes.
    let pdf = closure.pdf(wi, sample.wo, Transport::Radiance, lobes);
    let d = s.frame.to_world(sample.wo);
    let mut ray = s.leave(d);
    let mut through = 1.0;
    for _ in 0..segments {
        *rays += 1;
        let Some(hit) = scene.geometry.closest(&ray) else {
            let mut seen = Color::ZERO;
            for (radiance, direct) in scene.background(s.p, d) {
                seen += radiance * power_heuristic(pdf, direct);
            }
            return sample.weight * seen * through;
        };
        let at = scene.surface(&ray, &hit);
        let emitted = scene.emitted(&at, -d);
        if emitted.max_element() > 0.0 {
            let weight = power_heuristic(pdf, scene.pdf_direct_surface(s.p, d, &at));
            return sample.weight * emitted * (through * weight);
        }
        through *= transparency(scene, &at, d);
        if through == 0.0 {
            break;
        }
        ray = at.leave(d);
    }
    Color::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heuristic_weights_sum_to_one_even_for_extreme_densities() {
        for (a, b) in [(1.0, 1.0), (1e30, 1.0), (1e-30, 1e30), (0.0, 2.0)] {
            assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-6);
        }
    }
}
