//! Passes that are whole and wait to be added to the sums of a picture: several at once, so that the sums, which take
//! several times the bytes of a pass, are read and written seldom.

use std::cell::{OnceCell, RefCell};
use std::ops::Deref;

use super::pass::PassSums;
use super::pixels::Pixels;

/// Most passes that wait.
const MOST: usize = 4;

/// Most bytes of them beyond the first.
pub const WAITING_BYTES: usize = 48 << 20;

/// Passes that wait.
#[derive(Debug)]
pub struct Waiting {
    /// Those from `whole` on are to be overwritten.
    passes: Vec<PassSums>,
    whole: usize,
    most: usize,
    /// Of a pass.
    pixels: usize,
    aovs: usize,
}

impl Waiting {
    /// Passes of so many pixels, with so many sums for their surfaces in all.
    pub fn new(pixels: usize, aovs: usize) -> Self {
        let first = PassSums::new(pixels, aovs);
        let most = (1 + WAITING_BYTES / first.bytes().max(1)).min(MOST);
        Self { passes: vec![first], whole: 0, most, pixels, aovs }
    }

    /// Where the running pass goes. It waits only once [`Waiting::keep`] is called.
    pub fn running(&mut self) -> &mut PassSums {
        if self.whole == self.passes.len() {
            self.passes.push(PassSums::new(self.pixels, self.aovs));
        }
        &mut self.passes[self.whole]
    }

    /// The pass of [`Waiting::running`] is whole.
    pub fn keep(&mut self) {
        self.whole += 1;
    }

    /// Whether no further pass may wait.
    pub fn is_full(&self) -> bool {
        self.whole >= self.most
    }

    /// Adds all that wait.
    pub fn add_to(&mut self, pixels: &mut Pixels) {
        pixels.add(&self.passes[..self.whole]);
        self.whole = 0;
    }

    /// Shows the sums with all that wait to `look`. They are added only if it looks.
    pub fn show(&mut self, pixels: &mut Pixels, look: impl FnOnce(&SoFar<'_>)) {
        let before = RefCell::new(Some(std::mem::replace(pixels, Pixels::new(0))));
        let so_far = SoFar { waiting: &self.passes[..self.whole], before, now: OnceCell::new() };
        look(&so_far);
        let SoFar { before, now, .. } = so_far;
        if now.get().is_some() {
            self.whole = 0;
        }
        if let Some(sums) = now.into_inner().or_else(|| before.into_inner()) {
            *pixels = sums;
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.passes.iter().map(PassSums::bytes).sum()
    }
}

/// The sums of all passes so far, as [`Pixels`]: what waits is added when they are looked at.
#[derive(Debug)]
pub struct SoFar<'a> {
    waiting: &'a [PassSums],
    /// Without what waits; gone once that is added.
    before: RefCell<Option<Pixels>>,
    now: OnceCell<Pixels>,
}

impl Deref for SoFar<'_> {
    type Target = Pixels;

    fn deref(&self) -> &Pixels {
        self.now.get_or_init(|| {
            let mut pixels = self.before.take().expect("they are there until they are looked at");
            pixels.add(self.waiting);
            pixels
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Layer, Mean, Radiance, Rejected};
    use crate::math::Color;

    const PIXELS: usize = 200;

    /// Fills a pass with numbers of its own.
    fn fill(pass: &mut PassSums, number: usize) {
        for (i, mean) in pass.means.iter_mut().enumerate() {
            let mut sample = Radiance { alpha: 1.0, ..Radiance::default() };
            sample.add(Layer::Direct, Color::splat((1 + number * i) as f32 / 7.0));
            let mut sum = Mean::default();
            sum.add(&sample, 1.0, &mut Rejected::default());
            *mean = sum.stored(1.0);
        }
    }

    /// However many wait, and whoever looks in between, the sums are those of one pass after another.
    #[test]
    fn passes_that_wait_are_added_as_they_come() {
        let mut plain = Pixels::new(PIXELS);
        let mut pixels = Pixels::new(PIXELS);
        let mut waiting = Waiting::new(PIXELS, 0);
        for number in 0..11 {
            let mut pass = PassSums::new(PIXELS, 0);
            fill(&mut pass, number);
            plain.add(&[pass]);
            fill(waiting.running(), number);
            waiting.keep();
            waiting.show(&mut pixels, |so_far| {
                if number % 3 == 1 {
                    assert_eq!(**so_far, plain);
                }
            });
            if waiting.is_full() {
                waiting.add_to(&mut pixels);
                assert_eq!(pixels, plain);
            }
        }
        // What was begun and is not whole.
        fill(waiting.running(), 99);
        waiting.add_to(&mut pixels);
        assert_eq!(pixels, plain);
    }
}
