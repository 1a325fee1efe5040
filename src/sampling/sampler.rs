use super::hash::unit_float;
use super::{CounterRng, mix, sobol};
use crate::math::Vec2;

/// Dimensions (pairs) that are worth low-discrepancy points; later ones are plain random.
const SOBOL_PAIRS: u32 = 16;

/// Supplies the numbers of one path: padded 2-D Sobol points first, random numbers after.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    key: u64,
    index: u32,
    pair: u32,
    rng: CounterRng,
}

impl Sampler {
    /// Point `index` of the sequence `key`. Points of one key are stratified among themselves.
    #[inline]
    pub fn new(key: u64, index: u32) -> Self {
        Self { key, index, pair: 0, rng: CounterRng::new(key, u64::from(index)) }
    }

    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        let pair = self.pair;
        self.pair += 1;
        if pair < SOBOL_PAIRS {
            let p = sobol::point(self.index, mix(self.key.wrapping_add(u64::from(pair))));
            Vec2::new(unit_float(p[0]), unit_float(p[1]))
        } else {
            Vec2::from(self.rng.next_2d())
        }
    }

    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        let pair = self.pair;
        self.pair += 1;
        if pair < SOBOL_PAIRS {
            unit_float(sobol::point(self.index, mix(self.key.wrapping_add(u64::from(pair))))[0])
        } else {
            self.rng.next_f32()
        }
    }

    /// A number outside the stratified dimensions, for decisions that may be skipped (roulette).
    #[inline]
    pub fn random(&mut self) -> f32 {
        self.rng.next_f32()
    }
}
