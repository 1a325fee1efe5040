//! What shines in a scene: emission met by rays, light sampled at a point, starts of light paths.

use super::lamp_choice::LampChoice;
use super::{Scene, Surface};
use crate::emitter::{Aim, DirectSample, Emission, EmissionBounds, Emitter, SceneSphere, Start, Starts};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::Discrete;
use crate::spectrum::luminance;
use crate::texture::Textures;

/// The start of a light path from one emitter of the scene.
#[derive(Clone, Copy, Debug)]
pub struct LightStart {
    /// Its flux is that of the emitter over `probability` and over the density of its numbers where these are not
    /// even; its densities are the emitter's own.
    pub emission: Emission,
    /// With which the emitter was chosen, if by power.
    pub probability: f32,
    /// What the emission was made of.
    pub start: Start,
    /// The light comes from outside of the scene.
    pub from_infinity: bool,
}

impl Scene {
    /// Radiance that the surface itself emits towards `w` (world).
    #[inline(always)]
    pub fn emitted(&self, s: &Surface, w: Vec3) -> Color {
        match self.shapes[s.shape as usize].emitter {
            Some(e) => self.emitters[e as usize].emitted(&self.textures, &s.site(), s.frame.n.dot(w) > 0.0),
            None => Color::ZERO,
        }
    }

    /// Whether the shape emits.
    #[inline]
    pub fn is_lamp(&self, s: &Surface) -> bool {
        self.shapes[s.shape as usize].emitter.is_some()
    }

    /// Light from infinity seen from `p` along the unit direction `d`: for each environment, its radiance and the
    /// solid-angle density with which [`Scene::sample_direct`] at `p` samples that direction.
    #[inline]
    pub fn background(&self, p: Vec3, d: Vec3) -> impl Iterator<Item = (Color, f32)> {
        self.environments.iter().map(move |&e| {
            let (radiance, pdf) = self.emitters[e as usize].background(d);
            (radiance, pdf * self.direct.counted(p, e as usize))
        })
    }

    /// Solid-angle density with which [`Scene::sample_direct`] at `p` samples the lamp point `s` that a ray
    /// along `d` hit.
    #[inline]
    pub fn pdf_direct_surface(&self, p: Vec3, d: Vec3, s: &Surface) -> f32 {
        match self.shapes[s.shape as usize].emitter {
            Some(e) => {
                let pdf = self.emitters[e as usize].pdf_direct_surface(p, d, s.p, s.ng);
                pdf * self.direct.counted(p, e as usize)
            }
            None => 0.0,
        }
    }

    /// The same of the lamp point where a light path starts that comes to `p` first, against the unit direction `d`; 0 if
    /// scattered rays cannot hit the lamp.
    pub fn pdf_direct_start(&self, p: Vec3, d: Vec3, start: &LightStart) -> f32 {
        let (lamp, at) = (start.start.lamp, &start.emission);
        let emitter = &self.emitters[lamp];
        // Of the normal of the lamp only its cosine to the path counts.
        let pdf = if emitter.is_infinite() {
            emitter.background(d).1
        } else {
            emitter.pdf_direct_surface(p, d, at.o, d * at.cos)
        };
        pdf * self.direct.counted(p, lamp)
    }

    /// Light at `p` from one emitter, with the probability of choosing it divided out. Its density is the one that
    /// [`LampChoice::counted`] tells.
    #[inline(always)]
    pub fn sample_direct(&self, p: Vec3, pick: f32, u: Vec2) -> Option<DirectSample> {
        if self.emitters.is_empty() {
            return None;
        }
        if let [only] = self.emitters.as_slice() {
            return only.sample_direct(&self.textures, p, u);
        }
        let i = self.direct.sample(p, pick);
        let probability = self.direct.probability(p, i);
        let mut s = self.emitters[i].sample_direct(&self.textures, p, u)?;
        s.value /= probability;
        s.pdf *= self.direct.counted(p, i);
        Some(s)
    }

    /// Light at `p` from one of few emitters, for numbers that are the same for all of them.
    #[inline(always)]
    pub fn sample_lamp(&self, lamp: usize, p: Vec3, u: Vec2) -> Option<DirectSample> {
        self.emitters[lamp].sample_direct(&self.textures, p, turned(u, lamp))
    }

    /// A place of a lamp, chosen as [`Scene::sample_direct`] does where it is not known yet for which point. Of few lamps,
    /// it is the place that [`Scene::sample_lamp`] takes for the same numbers.
    pub fn lamp_place(&self, pick: f32, u: Vec2) -> Option<Vec3> {
        match self.emitters.as_slice() {
            [] => None,
            [only] => only.place(u),
            all => {
                let lamp = self.direct.sample_anywhere(pick);
                all[lamp].place(if self.direct.few() { turned(u, lamp) } else { u })
            }
        }
    }

    /// Start of a light path; the expected flux over all draws is the scene's power. `None` where the sample
    /// carries no light, and in a scene without any.
    pub fn sample_emission(&self, pick: f32, place: Vec2, direction: Vec2) -> Option<LightStart> {
        self.sample_aimed(pick, place, direction, None)
    }

    /// [`Scene::sample_emission`] aimed by `aim`.
    #[inline]
    pub fn sample_aimed(
        &self,
        pick: f32,
        place: Vec2,
        direction: Vec2,
        aim: Option<&Aim>,
    ) -> Option<LightStart> {
        let start = self.start(pick, place, direction, aim.and_then(|aim| aim.starts.as_ref()))?;
        let bounds = aim.map_or(EmissionBounds::even(self.sphere), |aim| aim.bounds(self.sphere));
        self.emission_of(start, &bounds)
    }

    /// The lamp that uniform numbers select, and the numbers for its emission. `None` without lamps.
    #[inline]
    pub fn start(&self, pick: f32, place: Vec2, direction: Vec2, starts: Option<&Starts>) -> Option<Start> {
        if self.emitters.is_empty() {
            return None;
        }
        Some(match starts {
            Some(starts) => starts.sample(&self.emission, pick, place, direction),
            None => {
                let at = [place.x, place.y, direction.x, direction.y];
                Start { lamp: self.emission.sample(pick).0, at, density: 1.0 }
            }
        })
    }

    /// What a lamp makes of the numbers of a start.
    #[inline]
    pub fn emission_of(&self, start: Start, bounds: &EmissionBounds<'_>) -> Option<LightStart> {
        let emitter = &self.emitters[start.lamp];
        let mut emission =
            emitter.sample_emission(&self.textures, bounds, start.place(), start.direction())?;
        let probability = self.emission.probability(start.lamp);
        emission.flux /= probability * start.density;
        Some(LightStart { emission, probability, start, from_infinity: emitter.is_infinite() })
    }

    /// Total emitted power, W per channel.
    pub fn power(&self) -> Color {
        self.emitters.iter().map(|e| e.power(&self.textures, &self.sphere)).sum()
    }
}

/// Numbers for one of few lamps: turned by another amount for each (by the R2 sequence of Roberts 2018), so that their
/// samples are even together.
#[inline(always)]
fn turned(u: Vec2, lamp: usize) -> Vec2 {
    let turned = u + Vec2::new(0.754_877_7, 0.569_840_3) * lamp as f32;
    // Whole numbers are cut off; `floor` may be a call.
    turned - turned.map(|x| x as i32 as f32)
}

/// Weights for choosing an emitter.
pub(crate) fn emitter_distributions(
    emitters: &[Emitter],
    textures: &Textures,
    sphere: &SceneSphere,
) -> (LampChoice, Discrete) {
    let power: Vec<f64> =
        emitters.iter().map(|e| f64::from(luminance(e.power(textures, sphere).max(Color::ZERO)))).collect();
    let total: f64 = power.iter().sum();
    let n = emitters.len() as f64;
    let direct = power.iter().map(|p| if total > 0.0 { 0.5 * p / total + 0.5 / n } else { 1.0 });
    let choice = LampChoice::new(Discrete::new(direct), emitters, &power, sphere);
    (choice, Discrete::new(power.iter().copied()))
}
