//! Russian roulette (Arvo and Kirk 1990): a path of little promise is ended with a probability, and one
//! that survives carries more, so that the mean stays what it was.

use crate::math::Color;
use crate::sampling::Sampler;
use crate::settings::Roulette;

/// The greatest probability of survival of a path that nothing else would end.
const MOST: f32 = 0.98;

/// Segments after which such a path may end: those of a path that loses no light, between perfect mirrors or
/// inside glass, have no limit but this. A lower one, or a smaller [`MOST`], would make the few survivors of
/// long paths through glass heavy: 0.95 from the fifth segment on is a weight of 1800 after 150.
const FORCED: u32 = 128;

/// The same for paths through media, of which scattering in milk may take thousands of segments.
const FORCED_IN_MEDIA: u32 = 4096;

/// How long a path may become.
#[derive(Clone, Copy, Debug)]
pub struct Length {
    /// Segments so far.
    pub segments: u32,
    /// Segments at most; `u32::MAX` is no limit.
    pub most: u32,
}

impl Length {
    /// `survival` as a probability, below 1 where nothing else ends the path.
    #[inline(always)]
    fn cap(self, survival: f32, forced: u32) -> f32 {
        survival.min(if self.most == u32::MAX && self.segments >= forced { MOST } else { 1.0 })
    }
}

/// Probability that a camera path goes on, from its throughput and the product of its relative indices of
/// refraction: radiance is smaller by their square inside glass, and comes out again as it went in.
#[inline(always)]
pub fn camera_survival(throughput: Color, eta: f32, length: Length) -> f32 {
    length.cap(throughput.max_element() * eta * eta, FORCED)
}

/// The same in a scene with media.
#[inline(always)]
pub fn camera_survival_in_media(throughput: Color, eta: f32, length: Length) -> f32 {
    length.cap(throughput.max_element() * eta * eta, FORCED_IN_MEDIA)
}

/// Probability that a light path goes on, from its flux before and after it scattered: survivors keep the
/// flux that they had, so that stored photons stay alike.
#[inline(always)]
pub fn light_survival(before: Color, after: Color, length: Length) -> f32 {
    length.cap(after.max_element() / before.max_element(), FORCED)
}

/// The same in a scene with media.
#[inline(always)]
pub fn light_survival_in_media(before: Color, after: Color, length: Length) -> f32 {
    length.cap(after.max_element() / before.max_element(), FORCED_IN_MEDIA)
}

/// What a path carries if it goes on, which it does with probability `survival`; `None` when it ends.
#[inline(always)]
pub fn survivor(carried: Color, survival: f32, sampler: &mut Sampler) -> Option<Color> {
    // Drawn always: whether rounding makes a probability 1 must not move the numbers that follow.
    if sampler.random() >= survival {
        return None;
    }
    Some(carried / survival.min(1.0))
}

/// A random choice among lobes.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// A lobe that reflects the share a of the light is chosen with probability a·`scale`.
    pub scale: f32,
    /// Uniform over [0, 1): lobes take their probabilities of it one after another, and none is chosen
    /// where it lies beyond all of them.
    pub u: f32,
}

/// The choice among lobes that reflect `total` of the light together: what becomes of the rest of it, which
/// is absorbed, is up to the `policy`.
#[inline(always)]
pub fn choice(policy: Roulette, total: f32, mut u: f32, sampler: &mut Sampler) -> Choice {
    match policy {
        Roulette::Renormalise => Choice { scale: 1.0 / total, u },
        Roulette::Absorb => Choice { scale: 1.0 / total.max(1.0), u },
        Roulette::Retry => {
            let absorbed = (1.0 - total).max(0.0);
            let full = total.max(1.0);
            // Draw until something else than absorption comes up.
            while u >= 1.0 - absorbed / full {
                u = sampler.random();
            }
            Choice { scale: 1.0 / total, u: u * (full / total) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of what 10⁵ paths carry on is what they carried: its relative deviation is
    /// √((1 − q)/q/10⁵), and the bound 4.5 of them.
    #[test]
    fn roulette_keeps_the_mean() {
        let n = 100_000;
        for q in [0.1f32, 0.5, 0.95, 1.0, 3.0] {
            let mut sum = 0.0f64;
            for i in 0..n {
                let mut sampler = Sampler::new(9, i);
                let after = survivor(Color::splat(2.0), q, &mut sampler);
                sum += after.map_or(0.0, |c| f64::from(c.lanes()[0]));
            }
            let probability = f64::from(q.min(1.0));
            let sigma = ((1.0 - probability) / probability / f64::from(n)).sqrt();
            let mean = sum / f64::from(n) / 2.0;
            assert!((mean - 1.0).abs() <= 4.5 * sigma, "{q}: {mean}");
        }
    }

    #[test]
    fn survival_follows_what_is_carried_and_ends_every_path() {
        let gray = Color::splat;
        let endless = |segments| Length { segments, most: u32::MAX };
        let bounded = |segments| Length { segments, most: 100_000 };
        assert_eq!(camera_survival(gray(0.25), 1.0, endless(5)), 0.25);
        assert_eq!(camera_survival(gray(0.25), 1.5, endless(5)), 0.5625);
        assert_eq!(light_survival(gray(4.0), gray(1.0), endless(1)), 0.25);
        // What loses nothing goes on, unless nothing else would end it.
        let camera = |l| camera_survival(gray(1.0), 1.0, l);
        let light = |l| light_survival(gray(4.0), gray(4.0), l);
        for survival in [&camera as &dyn Fn(Length) -> f32, &light] {
            assert_eq!(survival(endless(FORCED - 1)), 1.0);
            assert_eq!(survival(endless(FORCED)), MOST);
            assert_eq!(survival(bounded(50_000)), 1.0);
        }
    }
}
