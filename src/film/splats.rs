//! Light that paths from the lamps bring to the film: each splat falls where its path happens to meet the
//! sensor, not into a pixel that waits for it.
//!
//! Floating-point sums depend on their order, so splats are added in a fixed one, whatever thread found
//! them: light paths come in chunks of fixed size, every chunk keeps a list of its own, and the lists are
//! added one after another in the order of the chunks.

use rayon::prelude::*;

use super::filter::Shape;
use super::{FilmSize, Filter, Layer, Mean, Pixels, Radiance, Rejected, StoredMean};
use crate::math::{Color, Vec2};

/// Chunks whose lists are held at once: more cost memory, fewer leave threads without work.
const HELD: u64 = 64;

/// One path's light at one place of the film.
#[derive(Clone, Copy, Debug)]
struct Splat {
    /// In pixels of the full film, from its upper left corner.
    at: Vec2,
    layer: Layer,
    value: Color,
}

/// The splats of a chunk of light paths.
#[derive(Debug, Default)]
pub struct SplatList {
    splats: Vec<Splat>,
    size: Vec2,
    rejected: Rejected,
}

impl SplatList {
    /// Adds light at film position `s` in [0, 1]² (x right, y down, over the full film). `value` is what an
    /// estimate of the whole film's response (`Importance` integrates to 1 over it) comes to by one light path:
    /// its flux times what it scatters towards the sensor times the sensor's answer. What is not finite is
    /// counted and left out.
    pub fn add(&mut self, s: Vec2, layer: Layer, value: Color) {
        if value.is_finite() && s.is_finite() {
            self.splats.push(Splat { at: s * self.size, layer, value });
        } else {
            self.rejected.sample(layer, value.is_nan() || s.is_nan());
        }
    }
}

/// Sums of splats, by pixel.
#[derive(Clone, Debug)]
pub struct Splats {
    film: FilmSize,
    filter: Filter,
    /// What the values of the filter have to be divided by, so that it weighs 1 over all of the film.
    mass: f64,
    means: Vec<Mean>,
    rejected: Rejected,
}

impl Splats {
    /// An empty film, whose splats spread over the pixels that `filter` reaches from where they fall.
    pub fn new(film: FilmSize, filter: &Filter) -> Self {
        let mass = |shape: &Shape| {
            // The cells of the filter's own sampling table: both halves of the renderer have one mass.
            const CELLS: u32 = 512;
            let at = |i: u32| ((f64::from(i) + 0.5) / f64::from(CELLS) * 2.0 - 1.0) * shape.radius();
            (0..CELLS).map(|i| shape.weight(at(i))).sum::<f64>() * 2.0 * shape.radius() / f64::from(CELLS)
        };
        let mass = filter.shapes().iter().map(mass).product();
        let means = vec![Mean::default(); film.pixel_count()];
        Self { film, filter: filter.clone(), mass, means, rejected: Rejected::default() }
    }

    /// Lets `trace` fill the list of each of so many chunks, in parallel, and adds the lists in order. The sums
    /// do not depend on the number of threads, if what `trace` puts into a list depends on the number of the
    /// chunk alone.
    pub fn collect(&mut self, chunks: u64, trace: impl Fn(u64, &mut SplatList) + Sync) {
        let size = self.film.size();
        for first in (0..chunks).step_by(HELD as usize) {
            let lists: Vec<SplatList> = (first..(first + HELD).min(chunks))
                .into_par_iter()
                .map(|chunk| {
                    let mut list = SplatList { size, ..SplatList::default() };
                    trace(chunk, &mut list);
                    list
                })
                .collect();
            for list in lists {
                self.rejected.add(&list.rejected);
                list.splats.iter().for_each(|splat| self.spread(splat));
            }
        }
    }

    /// Adds a splat to all pixels that see it.
    fn spread(&mut self, splat: &Splat) {
        let [x0, y0, width, height] = self.film.crop;
        let [fx, fy] = self.filter.shapes();
        let columns = reached(splat.at.x, fx.radius(), x0, width);
        let rows = reached(splat.at.y, fy.radius(), y0, height);
        // A pixel is one of so many parts of the film, which responds with 1 as a whole.
        let share = f64::from(self.film.width) * f64::from(self.film.height) / self.mass;
        for y in rows {
            let wy = fy.weight(f64::from(y) + 0.5 - f64::from(splat.at.y)) * share;
            for x in columns.clone() {
                let weight = fx.weight(f64::from(x) + 0.5 - f64::from(splat.at.x)) * wy;
                let mut light = Radiance::default();
                light.add(splat.layer, splat.value);
                let pixel = ((y - y0) * width + (x - x0)) as usize;
                self.means[pixel].add(&light, weight as f32, &mut self.rejected);
            }
        }
    }

    /// Adds what `paths` light paths brought to the sums of a pass.
    pub fn add_to(&self, pixels: &mut Pixels, paths: u64) {
        let share = 1.0 / paths.max(1) as f64;
        let scaled: Vec<StoredMean> = self.means.iter().map(|mean| mean.stored(share)).collect();
        pixels.add_means(&[&scaled]);
    }

    /// Splats that were not finite, and were left out.
    pub fn rejected(&self) -> &Rejected {
        &self.rejected
    }
}

/// Pixels from `first` on, `count` of them, whose centres lie within `radius` of `at`; of two at its very ends
/// only the upper one, so that a box filter gives each splat to one pixel.
fn reached(at: f32, radius: f64, first: u32, count: u32) -> std::ops::Range<u32> {
    let low = (f64::from(at) - radius - 0.5).floor() + 1.0;
    let high = (f64::from(at) + radius - 0.5).floor() + 1.0;
    // The casts saturate: what is left of the film becomes 0.
    let clip = |x: f64| (x as u32).clamp(first, first + count);
    clip(low)..clip(high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::filter::{Box, Gaussian, Tent};
    use crate::sampling::CounterRng;

    fn film(splats: &Splats, paths: u64) -> Pixels {
        let mut pixels = Pixels::new(splats.film.pixel_count());
        splats.add_to(&mut pixels, paths);
        pixels
    }

    /// A chunk of random splats, some of them beyond f32.
    fn chunk(number: u64, list: &mut SplatList) {
        let mut rng = CounterRng::new(3, number);
        for i in 0..200 + number % 7 {
            let value = if i % 50 == 49 { f32::NAN } else { rng.next_f32() * 10f32.powi(i as i32 % 9 - 4) };
            let layer = if i % 2 == 0 { Layer::Caustic } else { Layer::Indirect };
            list.add(Vec2::from(rng.next_2d()), layer, Color::splat(value));
        }
    }

    #[test]
    fn sums_have_the_same_bytes_on_any_number_of_threads() {
        let size = FilmSize { width: 9, height: 7, crop: [1, 2, 6, 4] };
        let filter = Filter::new(Shape::Gaussian(Gaussian { stddev: 0.5 }));
        let sums = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            let mut splats = Splats::new(size, &filter);
            pool.install(|| splats.collect(500, chunk));
            assert_eq!(splats.rejected().total(), 500 * 4);
            film(&splats, 100_000)
        };
        let one = sums(1);
        assert!(one.mean_luminance(1) > 0.0);
        assert_eq!(one, sums(2));
        assert_eq!(one, sums(7));
    }

    /// Splats of value 1 all over the film are a picture of 1 everywhere: one in each of 16² parts of a pixel,
    /// which a filter without kinks there integrates to (1/16)².
    #[test]
    fn an_evenly_lit_film_is_even() {
        let size = FilmSize { width: 12, height: 10, crop: [3, 3, 6, 4] };
        for shape in [
            Shape::Box(Box { radius: 0.5 }),
            Shape::Tent(Tent { radius: 1.0 }),
            Shape::Gaussian(Gaussian { stddev: 0.5 }),
        ] {
            let mut splats = Splats::new(size, &Filter::new(shape));
            let (columns, rows) = (12 * 16u32, 10 * 16u32);
            splats.collect(u64::from(rows), |row, list| {
                for column in 0..columns {
                    let s =
                        Vec2::new((column as f32 + 0.5) / columns as f32, (row as f32 + 0.5) / rows as f32);
                    list.add(s, Layer::Direct, Color::ONE);
                }
            });
            let pixels = film(&splats, u64::from(columns * rows));
            for pixel in 0..pixels.len() {
                for value in pixels.layer(pixel, Layer::Direct, 1) {
                    assert!((value - 1.0).abs() < 5e-3, "{shape:?}: {value}");
                }
                assert_eq!(pixels.beauty(pixel, 1), pixels.layer(pixel, Layer::Direct, 1));
            }
        }
    }

    /// With a box filter every splat belongs to one pixel, also on the line between two.
    #[test]
    fn a_box_gives_a_splat_to_one_pixel() {
        let size = FilmSize::full(4, 4);
        for (at, pixel) in [([0.5, 0.5], 10), ([0.0, 0.0], 0), ([0.25, 0.7], 9), ([0.999, 0.2], 3)] {
            let mut splats = Splats::new(size, &Filter::new(Shape::Box(Box { radius: 0.5 })));
            splats.collect(1, |_, list| list.add(Vec2::from(at), Layer::Direct, Color::ONE));
            let pixels = film(&splats, 16);
            let lit: Vec<usize> = (0..16).filter(|&i| pixels.beauty(i, 1)[0] > 0.0).collect();
            assert_eq!(lit, [pixel], "{at:?}");
            assert_eq!(pixels.beauty(pixel, 1), [1.0; 3]);
        }
    }
}
