//! What shines in a scene: emission met by rays, light sampled at a point, starts of light paths.

use super::{Scene, Surface};
use crate::emitter::{Aim, Arena, DirectSample, Emission, Emitter, SceneSphere, Sides};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::Discrete;
use crate::spectrum::luminance;
use crate::texture::Textures;

impl Scene {
    /// Radiance that the surface itself emits towards `w` (world).
    #[inline(always)]
    pub fn emitted(&self, s: &Surface, w: Vec3) -> Color {
        match self.shapes[s.shape as usize].emitter {
            Some(e) => match &self.emitters[e as usize] {
                Emitter::Area(a) if s.frame.n.dot(w) > 0.0 || a.sides == Sides::Both => {
                    self.textures.eval(a.radiance, &s.site())
                }
                _ => Color::ZERO,
            },
            None => Color::ZERO,
        }
    }

    /// Whether the shape emits.
    #[inline]
    pub fn is_lamp(&self, s: &Surface) -> bool {
        self.shapes[s.shape as usize].emitter.is_some()
    }

    /// Light from infinity seen along the unit direction `d`: for each environment, its radiance and the
    /// solid-angle density with which [`Scene::sample_direct`] samples that direction.
    #[inline]
    pub fn background(&self, d: Vec3) -> impl Iterator<Item = (Color, f32)> {
        self.environments.iter().map(move |&e| {
            let (radiance, pdf) = match &self.emitters[e as usize] {
                Emitter::Constant(c) => (c.radiance, c.pdf_direct()),
                Emitter::Environment(e) => (e.radiance(d), e.pdf_direct(d)),
                _ => (Color::ZERO, 0.0),
            };
            (radiance, pdf * self.direct.probability(e as usize))
        })
    }

    /// Solid-angle density with which [`Scene::sample_direct`] at `p` samples the lamp point `s` that a ray
    /// along `d` hit.
    #[inline]
    pub fn pdf_direct_surface(&self, p: Vec3, d: Vec3, s: &Surface) -> f32 {
        match self.shapes[s.shape as usize].emitter {
            Some(e) => match &self.emitters[e as usize] {
                Emitter::Area(a) => a.pdf_direct(p, d, s.p, s.ng) * self.direct.probability(e as usize),
                _ => 0.0,
            },
            None => 0.0,
        }
    }

    /// Light at `p` from one emitter, with the probability of choosing it divided out.
    #[inline(always)]
    pub fn sample_direct(&self, p: Vec3, pick: f32, u: Vec2) -> Option<DirectSample> {
        if self.emitters.is_empty() {
            return None;
        }
        if let [only] = self.emitters.as_slice() {
            return only.sample_direct(&self.textures, p, u);
        }
        let (i, _) = self.direct.sample(pick);
        let probability = self.direct.probability(i);
        let mut s = self.emitters[i].sample_direct(&self.textures, p, u)?;
        s.value /= probability;
        s.pdf *= probability;
        Some(s)
    }

    /// Start of a light path; the expected flux over all draws is the scene's power.
    pub fn sample_emission(&self, pick: f32, place: Vec2, direction: Vec2) -> Option<Emission> {
        self.sample_aimed(pick, place, direction, None).map(|(e, _)| e)
    }

    /// [`Scene::sample_emission`] with light from infinity aimed by `aim`; the flag is true for light from
    /// infinity.
    pub fn sample_aimed(
        &self,
        pick: f32,
        place: Vec2,
        direction: Vec2,
        aim: Option<&Aim>,
    ) -> Option<(Emission, bool)> {
        if self.emitters.is_empty() {
            return None;
        }
        let (i, _) = self.emission.sample(pick);
        let emitter = &self.emitters[i];
        let arena = Arena { sphere: self.sphere, aim };
        let mut e = emitter.sample_emission(&self.textures, &arena, place, direction)?;
        e.flux /= self.emission.probability(i);
        Some((e, emitter.is_infinite()))
    }

    /// Total emitted power, W per channel.
    pub fn power(&self) -> Color {
        self.emitters.iter().map(|e| e.power(&self.textures, &self.sphere)).sum()
    }
}

/// Weights for choosing an emitter.
pub(crate) fn emitter_distributions(
    emitters: &[Emitter],
    textures: &Textures,
    sphere: &SceneSphere,
) -> (Discrete, Discrete) {
    let power: Vec<f64> =
        emitters.iter().map(|e| f64::from(luminance(e.power(textures, sphere).max(Color::ZERO)))).collect();
    let total: f64 = power.iter().sum();
    let n = emitters.len() as f64;
    let direct = power.iter().map(|p| if total > 0.0 { 0.5 * p / total + 0.5 / n } else { 1.0 });
    (Discrete::new(direct), Discrete::new(power.iter().copied()))
}
