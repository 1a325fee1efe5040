//! The extra samples of pixels that see lamps smaller than a pixel, see [`images`](crate::integrator::images).

use crate::film::{Layer, Radiance};
use crate::integrator::Task;
use crate::integrator::images::{PixelImages, shine};
use crate::math::Vec2;
use crate::sampling::{Sampler, mix};
use crate::scene::View;

/// Tells the numbers of extra samples from those of the others.
const EXTRA: u64 = 0x05ee_ab1e_1a39_5eed;

/// A pixel that sees images, and how it is sampled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pixel<'a> {
    pub task: Task<'a>,
    pub images: PixelImages<'a>,
    /// Column and row on the full film.
    pub at: [usize; 2],
    pub pass: u32,
    /// Samples of a pass: of the filter, and on average of the images.
    pub counts: [f32; 2],
}

impl Pixel<'_> {
    /// Of a sample at a film position (pixels): its weight of the filter, and the density of the samples of the images
    /// over that of the samples of the filter.
    pub fn weight(&self, place: Vec2) -> (f32, f32) {
        let (density, weight) = self.task.view.filter.density(place - self.centre());
        let images =
            if self.images.is_empty() { density } else { self.images.density(place) } * self.counts[1];
        // Outside of the filter the weight is nothing.
        (weight, if density > 0.0 { images / (density * self.counts[0]) } else { 0.0 })
    }

    fn centre(&self) -> Vec2 {
        Vec2::new(self.at[0] as f32 + 0.5, self.at[1] as f32 + 0.5)
    }

    /// The extra samples, each with its weight. Counts rays.
    pub fn samples(&self, rays: &mut u64) -> Vec<(Radiance, f32)> {
        let [x, y] = self.at.map(|v| v as u64);
        let key = mix(self.task.settings.seed ^ mix(EXTRA ^ y << 32 ^ x));
        let most = self.counts[1].ceil() as u32;
        // As many on average as were asked for.
        let part = Sampler::new(mix(key), self.pass).random();
        let more = (self.counts[1] + part).floor() as u32;
        let sample = |number| {
            let index = self.pass.wrapping_mul(most).wrapping_add(number);
            let mut sampler = Sampler::new(key, index).stratified(2);
            let u = sampler.next_2d();
            let pick = sampler.next_2d().x;
            let place = if self.images.is_empty() {
                self.centre() + self.task.view.filter.sample(u).0
            } else {
                self.images.sample(pick, u)
            };
            // Either kind is worth f/(n p c + m q): of n samples of the filter f, which is their density p times a weight,
            // and m of the images, of density q, which follow all ways and not one, chosen by chance c.
            let (weight, rivals) = self.weight(place);
            let View { sensor, film, .. } = self.task.view;
            let ray = sensor.ray(place / film.size(), Vec2::ZERO);
            let mut out = Radiance::default();
            let shine = shine(self.task, ray, &mut sampler, |chance| 1.0 / (chance + rivals));
            *rays += shine.rays;
            out.add(Layer::Emission, shine.light);
            (out, weight)
        };
        (0..more).map(sample).collect()
    }
}
