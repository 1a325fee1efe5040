//! LDR-FLIP of one tile of a picture, which one thread computes in a few small planes.

use super::color::{ColorScale, power, rgb_to_ycxcz};
use super::filter::{along_column, along_row};
use super::kernel::{Kernel, Kernels};
use crate::pixels::Pixels;
use std::ops::Range;

/// Columns of a tile: its planes fit into the second-level cache.
pub const TILE_WIDTH: usize = 192;

/// Planes after the horizontal pass, in the order of [`Planes::horizontal`].
const PLANES: usize = 7;
/// Planes after the vertical pass: A, RG, BY, edge x, edge y, point x, point y.
const RESULTS: usize = 7;

/// Working memory of one thread.
#[derive(Debug, Default)]
pub struct Scratch {
    row: [Vec<f32>; 3],
    planes: [Vec<f32>; PLANES],
    extra: Vec<f32>,
    results: [[Vec<f32>; RESULTS]; 2],
    distance: Vec<f32>,
    feature: Vec<f32>,
}

/// What all tiles share.
#[derive(Debug)]
pub struct Evaluator {
    pub kernels: Kernels,
    scale: ColorScale,
}

impl Evaluator {
    pub fn new(ppd: f64) -> Self {
        Self { kernels: Kernels::new(ppd), scale: ColorScale::new() }
    }

    /// Computes LDR-FLIP of a tile's pixels and hands it over row by row, with `put(y, x0, values)`.
    /// `display` turns a linear pixel into what the display shows, linear in [0, 1]. Outside of the picture
    /// its border pixels repeat.
    pub fn tile(
        &self,
        images: [&Pixels; 2],
        columns: Range<usize>,
        rows: Range<usize>,
        display: impl Fn([f32; 3]) -> [f32; 3] + Copy,
        scratch: &mut Scratch,
        put: impl FnMut(usize, usize, &[f32]),
    ) {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the feature was detected on the line above.
            unsafe { self.tile_avx2(images, columns, rows, display, scratch, put) };
            return;
        }
        self.tile_generic(images, columns, rows, display, scratch, put);
    }

    /// The same code compiled for 8 lanes. Without FMA, so that results are the same bits on every machine.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn tile_avx2(
        &self,
        images: [&Pixels; 2],
        columns: Range<usize>,
        rows: Range<usize>,
        display: impl Fn([f32; 3]) -> [f32; 3] + Copy,
        scratch: &mut Scratch,
        put: impl FnMut(usize, usize, &[f32]),
    ) {
        self.tile_generic(images, columns, rows, display, scratch, put);
    }

    #[inline(always)]
    fn tile_generic(
        &self,
        images: [&Pixels; 2],
        columns: Range<usize>,
        rows: Range<usize>,
        display: impl Fn([f32; 3]) -> [f32; 3] + Copy,
        scratch: &mut Scratch,
        mut put: impl FnMut(usize, usize, &[f32]),
    ) {
        for (i, image) in images.into_iter().enumerate() {
            self.horizontal(image, &columns, &rows, display, scratch);
            self.vertical(columns.len(), rows.len(), i, scratch);
        }
        self.combine(scratch);
        let n = columns.len();
        for (i, y) in rows.enumerate() {
            put(y, columns.start, &scratch.distance[i * n..(i + 1) * n]);
        }
    }

    /// Converts colours and filters along rows, for the tile's rows and those its filters reach.
    #[inline(always)]
    fn horizontal(
        &self,
        image: &Pixels,
        columns: &Range<usize>,
        rows: &Range<usize>,
        display: impl Fn([f32; 3]) -> [f32; 3] + Copy,
        scratch: &mut Scratch,
    ) {
        let k = &self.kernels;
        let reach = k.reach();
        let n = columns.len();
        let tall = rows.len() + 2 * reach;
        let wide = n + 2 * reach;
        scratch.row.iter_mut().for_each(|r| r.resize(wide, 0.0));
        scratch.planes.iter_mut().for_each(|p| p.resize(n * tall, 0.0));
        for j in 0..tall {
            let y = (rows.start + j).saturating_sub(reach).min(image.height - 1);
            let line = &image.rgb[y * image.width..(y + 1) * image.width];
            let [luma, red_green, blue_yellow] = &mut scratch.row;
            // Columns inside the picture, then its border pixels repeated on both sides.
            let inside = columns.start.saturating_sub(reach)..(columns.end + reach).min(image.width);
            let left = inside.start + reach - columns.start;
            let right = left + inside.len();
            let [r, g, b] =
                [&mut luma[left..right], &mut red_green[left..right], &mut blue_yellow[left..right]];
            // Into planes first: the compiler vectorises what follows only without interleaving.
            for (((r, g), b), rgb) in r.iter_mut().zip(&mut *g).zip(&mut *b).zip(&line[inside]) {
                [*r, *g, *b] = *rgb;
            }
            for ((r, g), b) in r.iter_mut().zip(g).zip(b) {
                [*r, *g, *b] = rgb_to_ycxcz(display([*r, *g, *b]));
            }
            for plane in [luma, red_green, blue_yellow] {
                let (first, last) = (plane[left], plane[right - 1]);
                plane[..left].fill(first);
                plane[right..].fill(last);
            }
            let out = j * n..(j + 1) * n;
            let [y, cx, cz] = &scratch.row;
            let passes: [(&[f32], &Kernel); PLANES] = [
                (y, &k.achromatic),
                (cx, &k.red_green),
                (cz, &k.blue_yellow[0]),
                (cz, &k.blue_yellow[1]),
                (y, &k.gauss),
                (y, &k.edge),
                (y, &k.point),
            ];
            for (plane, (row, kernel)) in scratch.planes.iter_mut().zip(passes) {
                along_row(&mut plane[out.clone()], row, reach, kernel);
            }
        }
    }

    /// Filters along columns: the opponent colours and features of image `index`, left in `results`.
    #[inline(always)]
    fn vertical(&self, n: usize, rows: usize, index: usize, scratch: &mut Scratch) {
        let k = &self.kernels;
        let reach = k.reach();
        let [a, rg, by0, by1, gauss, edge, point] = &scratch.planes;
        let passes: [(&[f32], &Kernel); RESULTS] = [
            (a, &k.achromatic),
            (rg, &k.red_green),
            (by0, &k.blue_yellow[0]),
            (edge, &k.gauss),
            (gauss, &k.edge),
            (point, &k.gauss),
            (gauss, &k.point),
        ];
        scratch.extra.resize(n, 0.0);
        for result in &mut scratch.results[index] {
            result.resize(n * rows, 0.0);
        }
        for y in 0..rows {
            let out = y * n..(y + 1) * n;
            for (result, (plane, kernel)) in scratch.results[index].iter_mut().zip(passes) {
                along_column(&mut result[out.clone()], plane, y + reach, kernel);
            }
            along_column(&mut scratch.extra, by1, y + reach, &k.blue_yellow[1]);
            let [w0, w1] = k.blue_yellow_weight;
            for (o, e) in scratch.results[index][2][out].iter_mut().zip(&scratch.extra) {
                *o = w0 * *o + w1 * e;
            }
        }
    }

    /// Colour and feature difference to FLIP (2020, eq. 1): `ΔE_c^(1 − ΔE_f)`, left in `distance`.
    #[inline(always)]
    fn combine(&self, scratch: &mut Scratch) {
        let count = scratch.results[0][0].len();
        scratch.distance.resize(count, 0.0);
        scratch.feature.resize(count, 0.0);
        // Slices of equal length, so that no index is checked and the loops can be vectorised.
        let [a, b] = scratch.results.each_ref().map(|r| r.each_ref().map(|plane| &plane[..count]));
        let distance = &mut scratch.distance[..count];
        let feature = &mut scratch.feature[..count];
        for i in 0..count {
            distance[i] = ColorScale::distance([a[0][i], a[1][i], a[2][i]], [b[0][i], b[1][i], b[2][i]]);
        }
        for i in 0..count {
            // Y of YCxCz to gray in [0, 1]; the filters have no mass, so the offset cancels.
            let length = |x: f32, y: f32| (x * x + y * y).sqrt() * (1.0 / 116.0);
            let edges = (length(a[3][i], a[4][i]) - length(b[3][i], b[4][i])).abs();
            let points = (length(a[5][i], a[6][i]) - length(b[5][i], b[6][i])).abs();
            // ΔE_f = (max / √2)^q_f with q_f = 0.5.
            feature[i] = (edges.max(points) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
        }
        for (d, f) in scratch.distance.iter_mut().zip(&scratch.feature) {
            *d = power(self.scale.error(*d), 1.0 - f).clamp(0.0, 1.0);
        }
    }
}
