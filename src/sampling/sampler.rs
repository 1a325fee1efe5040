use super::sobol::BATCH;
use super::{CounterRng, sobol};
use crate::math::Vec2;

/// Dimensions (pairs) that are worth low-discrepancy points; later ones are plain random.
const SOBOL_PAIRS: u32 = 16;

/// Supplies the numbers of one path: padded 2-D Sobol points first, random numbers after.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    key: u64,
    index: u32,
    pair: u32,
    pairs: u32,
    /// Pairs made together; those before `pair` are used up.
    ready: [[f32; BATCH]; 2],
    rng: CounterRng,
}

impl Sampler {
    /// Point `index` of the sequence `key`. Points of one key are stratified among themselves.
    #[inline]
    pub fn new(key: u64, index: u32) -> Self {
        let rng = CounterRng::new(key, u64::from(index));
        Self { key, index, pair: 0, pairs: SOBOL_PAIRS, ready: [[0.0; BATCH]; 2], rng }
    }

    /// With low-discrepancy points in the first `pairs` only: those that are never made cost nothing.
    #[inline]
    pub fn stratified(self, pairs: u32) -> Self {
        Self { pairs, ..self }
    }

    /// The next pair is low-discrepancy and ready at the place returned.
    #[inline]
    fn advance(&mut self) -> Option<usize> {
        let pair = self.pair;
        self.pair += 1;
        if pair >= self.pairs {
            return None;
        }
        let place = pair as usize % BATCH;
        if place == 0 {
            self.ready = sobol::batch(self.index, self.key, pair);
        }
        Some(place)
    }

    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        match self.advance() {
            Some(i) => Vec2::new(self.ready[0][i], self.ready[1][i]),
            None => Vec2::from(self.rng.next_2d()),
        }
    }

    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        match self.advance() {
            Some(i) => self.ready[0][i],
            None => self.rng.next_f32(),
        }
    }

    /// A number outside the stratified dimensions, for decisions that may be skipped (roulette).
    #[inline]
    pub fn random(&mut self) -> f32 {
        self.rng.next_f32()
    }
}
