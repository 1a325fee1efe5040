//! FLIP of whole pictures.

use super::exposure::{Exposures, Tonemapper, rational, reinhard};
use super::tile::{Evaluator, Scratch, TILE_WIDTH};
use crate::pixels::Pixels;
use rayon::prelude::*;

/// FLIP per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row from the top, 0 (no visible difference) to 1.
    pub values: Vec<f32>,
}

/// HDR-FLIP per pixel: the largest LDR-FLIP over the exposures.
#[derive(Clone, Debug, PartialEq)]
pub struct HdrFlipMap {
    /// The values.
    pub map: FlipMap,
    /// The exposures that were compared.
    pub exposures: Exposures,
    /// The tonemapper that was used.
    pub tonemapper: Tonemapper,
}

/// LDR-FLIP of two images of the same size, seen at `ppd` pixels per degree.
///
/// Linear values of any range are encoded with the sRGB curve, clamped to [0, 1] and compared as a display
/// shows them. They are not quantised to 8 bits.
pub fn ldr(image: &Pixels, reference: &Pixels, ppd: f64) -> FlipMap {
    let evaluator = Evaluator::new(ppd);
    // FLIP starts by decoding sRGB; decode(clamp(encode(x))) is clamp(x).
    let display = |[r, g, b]: [f32; 3]| [r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0)];
    let mut values = vec![0.0; image.rgb.len()];
    for_bands(image, &mut values, |band, rows, scratch| {
        tiles(image.width, |columns| {
            let pair = [reference, image];
            evaluator.tile(pair, columns, rows.clone(), display, scratch, |y, x, v| {
                let start = (y - rows.start) * image.width + x;
                band[start..start + v.len()].copy_from_slice(v);
            });
        });
    });
    FlipMap { width: image.width, height: image.height, values }
}

/// HDR-FLIP of two images of the same size, seen at `ppd` pixels per degree. Negative values count as black.
pub fn hdr(
    image: &Pixels,
    reference: &Pixels,
    ppd: f64,
    exposures: Exposures,
    tonemapper: Tonemapper,
) -> HdrFlipMap {
    // One instance of the loops per kind of curve, so that the inner loop has no branch.
    let map = match tonemapper {
        Tonemapper::Reinhard => worst_of(image, reference, ppd, &exposures, reinhard),
        Tonemapper::Aces | Tonemapper::Hable => {
            let c = tonemapper.coefficients();
            worst_of(image, reference, ppd, &exposures, move |rgb| rational(&c, rgb))
        }
    };
    HdrFlipMap { map, exposures, tonemapper }
}

/// The largest LDR-FLIP over the exposures.
fn worst_of(
    image: &Pixels,
    reference: &Pixels,
    ppd: f64,
    exposures: &Exposures,
    curve: impl Fn([f32; 3]) -> [f32; 3] + Copy + Sync,
) -> FlipMap {
    let evaluator = Evaluator::new(ppd);
    let factors: Vec<f32> = exposures.values().map(|e| e.exp2() as f32).collect();
    let mut values = vec![0.0f32; image.rgb.len()];
    for_bands(image, &mut values, |band, rows, scratch| {
        tiles(image.width, |columns| {
            for &factor in &factors {
                let display = |[r, g, b]: [f32; 3]| {
                    curve([r.max(0.0) * factor, g.max(0.0) * factor, b.max(0.0) * factor])
                };
                let (pair, columns) = ([reference, image], columns.clone());
                evaluator.tile(pair, columns, rows.clone(), display, scratch, |y, x, v| {
                    let start = (y - rows.start) * image.width + x;
                    let largest = &mut band[start..start + v.len()];
                    largest.iter_mut().zip(v).for_each(|(slot, &v)| *slot = slot.max(v));
                });
            }
        });
    });
    FlipMap { width: image.width, height: image.height, values }
}

/// Runs `work` on bands of rows in parallel. A pixel's value does not depend on its band, so the height of
/// bands may depend on the number of threads.
fn for_bands<T: Send>(
    image: &Pixels,
    out: &mut [T],
    work: impl Fn(&mut [T], std::ops::Range<usize>, &mut Scratch) + Sync,
) {
    if out.is_empty() {
        return;
    }
    let height = (image.height / (4 * rayon::current_num_threads())).clamp(16, 96);
    out.par_chunks_mut(height * image.width).enumerate().for_each_init(
        Scratch::default,
        |scratch, (i, band)| {
            let rows = i * height..i * height + band.len() / image.width;
            work(band, rows, scratch);
        },
    );
}

fn tiles(width: usize, mut work: impl FnMut(std::ops::Range<usize>)) {
    for start in (0..width).step_by(TILE_WIDTH) {
        work(start..(start + TILE_WIDTH).min(width));
    }
}
