use super::sobol::BATCH;
use super::{CounterRng, mix, sobol};
use crate::math::Vec2;

/// Pairs of dimensions that are drawn from Sobol points by default; later ones are independent random numbers.
const SOBOL_PAIRS: u32 = 16;

/// The random numbers of one path: padded 2-D Sobol points for the first dimensions, independent random
/// numbers for the rest.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    key: u64,
    index: u32,
    /// Pairs drawn so far.
    pair: u32,
    /// Pairs that are drawn from Sobol points.
    pairs: u32,
    /// The current batch of Sobol points, by coordinate; those before `pair` have been used.
    ready: [[f32; BATCH]; 2],
    rng: CounterRng,
}

impl Sampler {
    /// Point `index` of the sequence `key`. The points of one key are stratified with respect to each other.
    #[inline]
    pub fn new(key: u64, index: u32) -> Self {
        let rng = CounterRng::new(key, u64::from(index));
        Self { key, index, pair: 0, pairs: SOBOL_PAIRS, ready: [[0.0; BATCH]; 2], rng }
    }

    /// Draws only the first `pairs` pairs of dimensions from Sobol points, which are not computed beyond them.
    #[inline]
    pub fn stratified(self, pairs: u32) -> Self {
        Self { pairs, ..self }
    }

    /// Numbers for the rest of branch `number` of `branches` that a path splits into. The branches of all paths of a
    /// key are stratified with respect to each other.
    #[inline]
    pub fn branch(&self, number: u32, branches: u32) -> Self {
        let index = self.index.wrapping_mul(branches).wrapping_add(number);
        Self::new(mix(self.key ^ 0x5b_11f7 ^ u64::from(self.pair)), index).stratified(self.pairs)
    }

    /// Moves to the next pair. Returns its position in `ready`, or `None` if it is to be random.
    #[inline]
    fn advance(&mut self) -> Option<usize> {
        let pair = self.pair;
        self.pair += 1;
        if pair >= self.pairs {
            return None;
        }
        let place = pair as usize % BATCH;
        if place == 0 {
            sobol::batch(self.index, self.key, pair, &mut self.ready);
        }
        Some(place)
    }

    /// The next pair of numbers, in [0, 1)².
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        match self.advance() {
            Some(i) => Vec2::new(self.ready[0][i], self.ready[1][i]),
            None => Vec2::from(self.rng.next_2d()),
        }
    }

    /// The next number, in [0, 1). Like [`Self::next_2d`] it uses up a pair.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        match self.advance() {
            Some(i) => self.ready[0][i],
            None => self.rng.next_f32(),
        }
    }

    /// An independent random number in [0, 1) that uses up no pair, for decisions that not every path makes
    /// (Russian roulette).
    #[inline]
    pub fn random(&mut self) -> f32 {
        self.rng.next_f32()
    }
}
