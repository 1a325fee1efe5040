//! Compares means of blocks of a picture with its reference: noise averages out over a block, a wrong BSDF does
//! not.

use super::manifest::Limits;
use caustica_tools::pixels::Pixels;

/// Blocks per row and column, also the size of `NAME.density.exr`.
pub const BLOCKS: usize = 8;
/// Standard errors by which a mean may be off. If every picture were as noisy as Mitsuba's, the 192 means of
/// each of 20 trials would together give a false alarm with probability 2.6 %.
const SIGMAS: f64 = 4.5;
/// Tolerance for single precision, relative to the block's mean.
const PRECISION: f64 = 0.002;

/// A block and how far its mean is off in one channel.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Difference over tolerance.
    pub share: f64,
    /// First and last pixel.
    pub columns: [usize; 2],
    pub rows: [usize; 2],
    pub channel: char,
    /// Difference and tolerance, relative to the reference.
    pub difference: f64,
    pub tolerance: f64,
}

/// A reference and what is known of its error.
#[derive(Debug)]
pub struct Truth<'a> {
    pub reference: &'a Pixels,
    pub variance: &'a Pixels,
    /// Bias allowed to a density estimate, one pixel per block; `None` for a path tracer.
    pub density: Option<&'a Pixels>,
    /// Samples per pixel of the reference.
    pub spp: f64,
}

/// The block of largest `share` in a picture rendered under `limits`; `None` if it has no pixels.
pub fn worst(image: &Pixels, truth: &Truth<'_>, limits: &Limits) -> Option<Block> {
    let mut worst: Option<Block> = None;
    for row in 0..BLOCKS {
        for column in 0..BLOCKS {
            let (columns, rows) = (part(column, image.width), part(row, image.height));
            let [mean, reference, variance] =
                [image, truth.reference, truth.variance].map(|p| means(p, columns, rows));
            let pixels = ((columns[1] - columns[0] + 1) * (rows[1] - rows[0] + 1)) as f64;
            for (c, channel) in ['R', 'G', 'B'].into_iter().enumerate() {
                let density = truth.density.map_or(0.0, |d| f64::from(d.at(column, row)[c]));
                let sigma =
                    (variance[c] * (1.0 + limits.noise * truth.spp / f64::from(limits.spp)) / pixels).sqrt();
                let tolerance = SIGMAS * sigma + PRECISION * reference[c] + density;
                let difference = mean[c] - reference[c];
                // A block that is black in the reference has no tolerance and no scale.
                let share = if difference == 0.0 { 0.0 } else { difference.abs() / tolerance };
                if worst.is_none_or(|w| share > w.share) {
                    let scale = reference[c].max(f64::MIN_POSITIVE);
                    let (difference, tolerance) = (difference / scale, tolerance / scale);
                    worst = Some(Block { share, columns, rows, channel, difference, tolerance });
                }
            }
        }
    }
    worst
}

/// First and last pixel of block `number` along an edge of `side` pixels.
fn part(number: usize, side: usize) -> [usize; 2] {
    [number * side / BLOCKS, ((number + 1) * side / BLOCKS).max(1) - 1]
}

fn means(pixels: &Pixels, columns: [usize; 2], rows: [usize; 2]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for y in rows[0]..=rows[1] {
        for x in columns[0]..=columns[1] {
            let p = pixels.at(x, y);
            (0..3).for_each(|c| sum[c] += f64::from(p[c]));
            count += 1.0;
        }
    }
    sum.map(|s| s / count)
}
