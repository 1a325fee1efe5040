//! Metrics of linear RGB pixels. Sums are f64 over fixed chunks that are added in order, so that no result
//! depends on the number of threads.

mod bias;
mod error;
mod ztest;

pub use bias::{Bias, bias};
pub use error::{Errors, errors, main_errors};
pub use ztest::{Noise, Space, ZTest, ZTestOptions, rgb_to_xyz, z_test};

use crate::pixels::Pixels;
use rayon::prelude::*;

/// Pixels in one chunk of a sum.
const CHUNK: usize = 1 << 14;

/// Sums over all pixels of the `N` values that `f` returns for a pixel of the image and of the reference.
fn sum<const N: usize>(
    image: &Pixels,
    reference: &Pixels,
    f: impl Fn([f32; 3], [f32; 3]) -> [f64; N] + Sync,
) -> [f64; N] {
    let partial: Vec<[f64; N]> = image
        .rgb
        .par_chunks(CHUNK)
        .zip(reference.rgb.par_chunks(CHUNK))
        .map(|(a, b)| {
            let mut acc = [0.0; N];
            for (&x, &r) in a.iter().zip(b) {
                for (slot, v) in acc.iter_mut().zip(f(x, r)) {
                    *slot += v;
                }
            }
            acc
        })
        .collect();
    let mut total = [0.0; N];
    for part in partial {
        for (slot, v) in total.iter_mut().zip(part) {
            *slot += v;
        }
    }
    total
}
