//! How many camera samples each pixel takes in a pass. The first passes, which take as many in every pixel, tell how noisy
//! each one is; later ones sample the noisy pixels more often. A pass is the mean of its samples in every pixel and
//! counts as much as any other, so that the expected picture does not depend on what was found.

use super::bands::Bands;
use super::noise::{Noise, counts, even_passes};
use crate::film::{PassSums, Pixels};
use crate::integrator::{Integrator, Task};
use crate::photon::trace::Halt;

/// Tells the noise in the first passes of a render, and how many samples pixels take in the others.
pub(super) struct Effort<'a, I: Integrator> {
    task: Task<'a>,
    integrator: &'a I,
    /// Passes that take as many samples in every pixel.
    even: u32,
    /// Passes whose noise is known.
    seen: u32,
    noise: Vec<Noise>,
}

impl<'a, I: Integrator> Effort<'a, I> {
    /// Of a render whose sums are in `pixels`.
    pub fn new(task: Task<'a>, integrator: &'a I, pixels: &Pixels) -> Self {
        let even = even_passes(integrator);
        let wanted = even > 0 && pixels.counts().each.is_empty();
        let noise = vec![Noise::default(); if wanted { pixels.len() } else { 0 }];
        Self { task, integrator, even, seen: 0, noise }
    }

    /// To be called before a pass: of the first passes, makes those again that belong to another part of the render, and
    /// decides after them how many samples pixels take. False after a halt.
    pub fn settle(&mut self, pass: u32, pixels: &mut Pixels, halt: Halt<'_>) -> bool {
        if self.noise.is_empty() {
            return true;
        }
        if self.seen < pass.min(self.even) {
            let mut sums = PassSums::new(pixels.len(), pixels.numbers_of_aovs());
            for earlier in self.seen..pass.min(self.even) {
                let (shared, stats) = self.integrator.begin_pass(earlier);
                let bands = Bands::new(self.task, self.integrator, &shared, earlier, &[], halt);
                if stats.cut || bands.sample(&mut sums, self.noise_of(earlier)).iter().any(|band| !band.2) {
                    return false;
                }
            }
        }
        if pass >= self.even {
            let each = self.integrator.samples_a_pass();
            pixels.set_counts(counts(&self.noise, &self.task.view.film, each, self.task.settings.seed));
            self.noise = Vec::new();
        }
        true
    }

    /// Where the noise of a pass is kept that is made now; empty if it is not wanted.
    pub fn noise_of(&mut self, pass: u32) -> &mut [Noise] {
        self.seen = pass + 1;
        &mut self.noise
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.noise.as_slice())
    }
}
