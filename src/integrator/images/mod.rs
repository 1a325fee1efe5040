//! Images of lamps that are smaller than a pixel: where on the film a lamp is seen in mirrors and through glass.
//!
//! Camera samples spread evenly over a pixel hardly ever find such an image, and the few that do are fireflies.
//! Nothing but camera rays can bring this light (every vertex between lens and lamp is specular), so the film position
//! itself is sampled: [`search`] finds the images before the first pass, and a pixel that has some takes extra
//! samples within parallelograms around them. Both kinds of samples share the light by the balance heuristic (Veach 1997,
//! section 9.2), for which the density of either at a film position is known. So whatever the search finds or misses
//! changes the noise, not the expected picture.
//!
//! [`borders`] adds what needs no search: lamps smaller than a pixel that are seen directly, and pixels on the border of a
//! larger lamp or of its image. A camera sample chooses one way at each surface of glass, an extra sample follows all of
//! them: the densities of both at a film position are weighed by the chance of the way, so that of a lamp that is
//! reflected faintly nearly all comes from extra samples. Pixels where no such lamp was found, though there might be one,
//! take a few.

mod borders;
mod search;
mod shine;

use crate::film::{FilmSize, Filter};
use crate::math::{Mat2, Vec2};

pub use search::search;
pub use shine::shine;

/// Extra samples of a picture: one in so many of all samples at most, unless pixels have a single one each.
const SHARE: u64 = 20;

/// Most segments of the paths that extra samples share with the others: between mirrors there is no end.
const LONGEST: u32 = 16;

/// Ways of less chance are not theirs either: each inner reflection in glass is one more.
const RAREST: f32 = 1e-4;

/// Extra samples of a pixel for each of its samples, at most.
const MOST: u64 = 32;

/// Extra samples for each sample of a pixel where only rare ways could see a lamp.
const IN_CASE: f32 = 1.0 / 4.0;

/// Share of an image's size that has to be within reach of a filter: a pixel that it only touches gains nothing by it.
const INSIDE: f32 = 0.999;

/// Of the light of a lamp at the end of a camera path of `depth` segments, what the path brings: the rest is that of extra
/// samples, whose density over its own is `rivals`. `chance` is that of its way, if specular surfaces alone led it there
/// (the balance heuristic).
#[inline(always)]
pub fn share(chance: Option<f32>, depth: u32, rivals: f32) -> f32 {
    match chance {
        Some(chance) if depth <= LONGEST && chance >= RAREST => chance / (chance + rivals),
        _ => 1.0,
    }
}

/// A parallelogram of the film around the image of a lamp. Film positions are in pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// Its middle.
    pub centre: Vec2,
    /// From (±1, ±1) to its corners as seen from the middle.
    sides: Mat2,
    inverse: Mat2,
}

impl Image {
    /// The place that `sides` makes of the square from (−1, −1) to (1, 1), around `centre`. `None` where it has no
    /// area that single precision can tell.
    pub fn new(centre: Vec2, sides: Mat2) -> Option<Self> {
        let inverse = sides.inverse();
        let sound = centre.is_finite() && sides.is_finite() && inverse.is_finite();
        (sound && sides.determinant() != 0.0).then_some(Self { centre, sides, inverse })
    }

    /// Half the size of the box around it.
    fn half(&self) -> Vec2 {
        self.sides.x_axis.abs() + self.sides.y_axis.abs()
    }

    /// In squared pixels.
    fn area(&self) -> f32 {
        4.0 * self.sides.determinant().abs()
    }

    fn contains(&self, at: Vec2) -> bool {
        (self.inverse * (at - self.centre)).abs().cmple(Vec2::ONE).all()
    }
}

/// The images of a picture, sorted by the pixels that see them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Images {
    /// For each rendered pixel, where its images begin in `images`; one more at the end.
    first: Vec<u32>,
    images: Vec<Image>,
    /// Of each rendered pixel: what its images are.
    kinds: Vec<Kind>,
    /// How many pixels see some.
    pixels: u64,
}

/// What a pixel sees of lamps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Nothing,
    /// Rare ways that could see one.
    InCase,
    /// Images.
    Seen,
}

impl Images {
    /// Gives each image to all pixels of the rendered part whose filter reaches it. `rare` are the numbers of pixels where
    /// there could be others.
    pub fn new(found: &[Image], rare: &[usize], film: &FilmSize, filter: &Filter) -> Self {
        let [x0, y0, width, height] = film.crop;
        let radius = filter.shapes().map(|shape| shape.radius() as f32);
        let reached = |low: f32, high: f32, radius: f32, first: u32, count: u32| {
            let clip = |x: f32| (x.max(0.0) as u32).clamp(first, first + count);
            clip((low - radius - 0.5).ceil())..clip((high + radius - 0.5).floor() + 1.0)
        };
        let mut seen = Vec::new();
        for (i, image) in found.iter().enumerate() {
            let half = image.half() * INSIDE;
            let (low, high) = (image.centre - half, image.centre + half);
            for y in reached(low.y, high.y, radius[1], y0, height) {
                let columns = reached(low.x, high.x, radius[0], x0, width);
                seen.extend(columns.map(|x| ((y - y0) * width + (x - x0), i)));
            }
        }
        seen.sort_unstable();
        let mut first = vec![0; film.pixel_count() + 1];
        seen.iter().for_each(|(pixel, _)| first[*pixel as usize + 1] += 1);
        (1..first.len()).for_each(|i| first[i] += first[i - 1]);
        let mut kinds = vec![Kind::Nothing; film.pixel_count()];
        rare.iter().for_each(|&pixel| kinds[pixel] = Kind::InCase);
        seen.iter().for_each(|(pixel, _)| kinds[*pixel as usize] = Kind::Seen);
        let pixels = kinds.iter().filter(|kind| **kind == Kind::Seen).count() as u64;
        Self { first, images: seen.iter().map(|(_, i)| found[*i]).collect(), kinds, pixels }
    }

    /// How many pixels see some.
    pub fn pixels(&self) -> u64 {
        self.pixels
    }

    /// Whether no pixel takes extra samples.
    pub fn is_empty(&self) -> bool {
        self.kinds.iter().all(|kind| *kind == Kind::Nothing)
    }

    /// Samples that a rendered pixel, by its number, takes on average beside `each` samples of every pixel: as many as
    /// cost little over all of the picture, since nothing but them finds these images well.
    pub fn samples(&self, pixel: usize, each: u32) -> f32 {
        match self.kinds[pixel] {
            Kind::Nothing => 0.0,
            Kind::InCase => IN_CASE * each as f32,
            Kind::Seen => {
                let all = self.kinds.len() as u64 * u64::from(each);
                let cheap = all / (SHARE * self.pixels.max(1));
                cheap.clamp(1, u64::from(each) * MOST) as f32
            }
        }
    }

    /// Those of a rendered pixel, by its number.
    #[inline]
    pub fn of(&self, pixel: usize) -> PixelImages<'_> {
        PixelImages(&self.images[self.first[pixel] as usize..self.first[pixel + 1] as usize])
    }
}

/// The images that one pixel sees. Film positions are in pixels of the full film.
#[derive(Clone, Copy, Debug)]
pub struct PixelImages<'a>(&'a [Image]);

impl PixelImages<'_> {
    /// Whether there are none: extra samples are then those of the filter.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// A film position in one of the images: each is chosen as often as the others, since what a lamp's image brings
    /// does not depend on its size alone.
    pub fn sample(&self, pick: f32, u: Vec2) -> Vec2 {
        let image = self.0[((pick * self.0.len() as f32) as usize).min(self.0.len() - 1)];
        image.centre + image.sides * (u * 2.0 - 1.0)
    }

    /// Density of [`PixelImages::sample`], per squared pixel.
    pub fn density(&self, at: Vec2) -> f32 {
        let sum: f32 = self.0.iter().filter(|image| image.contains(at)).map(|image| 1.0 / image.area()).sum();
        sum / self.0.len() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::filter::{Box, Gaussian, Shape};
    use crate::sampling::CounterRng;

    fn images() -> Vec<Image> {
        let at = |x: f32, y: f32, right: [f32; 2], down: [f32; 2]| {
            Image::new(Vec2::new(x, y), Mat2::from_cols(Vec2::from(right), Vec2::from(down))).unwrap()
        };
        vec![
            at(3.2, 4.1, [0.01, 0.0], [0.0, 0.02]),
            at(3.2, 4.11, [0.02, 0.02], [-0.03, 0.01]),
            at(6.0, 2.5, [0.02, 0.0], [0.0, 0.02]),
        ]
    }

    /// The mean over samples of what lies in a box, over the density, is the area of the box that the images cover.
    /// It is between 0 and the whole area, so that 400 000 samples leave less than 0.5 % (four standard deviations).
    #[test]
    fn samples_have_their_density() {
        let filter = Filter::new(Shape::Box(Box { radius: 0.5 }));
        let images = Images::new(&images(), &[], &FilmSize::full(8, 8), &filter);
        let pixel = images.of(4 * 8 + 3);
        assert_eq!(pixel.0.len(), 2);
        let mut rng = CounterRng::new(5, 0);
        let n = 400_000;
        let mean: f64 = (0..n)
            .map(|_| {
                let at = pixel.sample(rng.next_f32(), Vec2::from(rng.next_2d()));
                1.0 / f64::from(pixel.density(at)) / f64::from(n)
            })
            .sum();
        // By a fine grid, whose own error is that of its cells along the borders.
        let cells = 2000;
        let cell = |i: i32| (i as f32 + 0.5) / cells as f32 * 0.2 - 0.1;
        let covered = (0..cells * cells)
            .filter(|i| {
                let at = Vec2::new(3.2 + cell(i % cells), 4.1 + cell(i / cells));
                pixel.density(at) > 0.0
            })
            .count();
        let area = covered as f64 * (0.2 / f64::from(cells)).powi(2);
        assert!((mean / area - 1.0).abs() < 0.01, "{mean} {area}");
        assert_eq!(pixel.density(Vec2::new(3.5, 4.5)), 0.0);
    }

    /// An image on the border belongs to both pixels; a wide filter brings it to all that it reaches.
    #[test]
    fn images_belong_to_every_pixel_that_sees_them() {
        let film = FilmSize { width: 8, height: 8, crop: [4, 2, 3, 3] };
        let owners = |shape| {
            let images = Images::new(&images()[2..], &[], &film, &Filter::new(shape));
            (0..9).filter(|i| !images.of(*i).is_empty()).collect::<Vec<_>>()
        };
        assert_eq!(owners(Shape::Box(Box { radius: 0.5 })), [1, 2]);
        assert_eq!(owners(Shape::Gaussian(Gaussian { stddev: 0.5 })), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }
}
