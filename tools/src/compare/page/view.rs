//! The pixels of a comparison as the page holds them.

use super::worst::{self, Place};
use crate::compare::comparison::Compared;
use crate::flip::{FlipMap, magma};
use crate::html::base64;
use crate::pixels::{Pixels, linear_to_srgb};
use caustica_formats::image::encode_png;
use half::f16;
use serde::Serialize;

/// Most pixels of a picture on the page; larger pictures are shown as means of square blocks.
const MAX_PIXELS: usize = 1 << 20;
/// Longer side of the pictures in the list.
const THUMBNAIL: usize = 128;

/// What the page shows of one comparison besides its numbers. Pixels are little-endian half floats in base64,
/// small pictures PNG in base64.
#[derive(Debug, Serialize)]
pub struct View {
    width: usize,
    height: usize,
    /// Side in pixels of the blocks whose means are shown; 1 shows the pixels themselves.
    reduced: usize,
    image: String,
    reference: String,
    flip: String,
    hdr_flip: Option<String>,
    histogram: Vec<f64>,
    crops: Vec<Crop>,
    thumbnail: String,
}

#[derive(Debug, Serialize)]
struct Crop {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
    mean: f64,
    image: String,
    reference: String,
    flip: String,
}

impl View {
    pub fn new(compared: &Compared, image: &Pixels, reference: &Pixels) -> Self {
        let reduced = block_for(image.width, image.height, |w, h| w * h <= MAX_PIXELS);
        let map = |m: &FlipMap| halves(&reduce(m.width, &m.values, reduced, |v| [*v]).1);
        let rgb = |p: &Pixels| reduce(p.width, &p.rgb, reduced, |v| *v);
        let (width, small) = rgb(image);
        let small_side = block_for(image.width, image.height, |w, h| w.max(h) <= THUMBNAIL);
        let (thumb_width, thumb) = reduce(image.width, &image.rgb, small_side, |v| *v);
        let factor = compared.comparison.flip_ldr.exposure.exp2() as f32;
        Self {
            width,
            height: small.len() / width.max(1),
            reduced,
            image: halves(&small),
            reference: halves(&rgb(reference).1),
            flip: map(&compared.ldr),
            hdr_flip: compared.hdr.as_ref().map(|h| map(&h.map)),
            histogram: worst::histogram(&compared.ldr),
            crops: (worst::places(&compared.ldr).into_iter())
                .map(|place| Crop::new(place, &compared.ldr, image, reference, factor))
                .collect(),
            thumbnail: png(thumb_width, &display(&thumb, factor)),
        }
    }
}

impl Crop {
    fn new(place: Place, map: &FlipMap, image: &Pixels, reference: &Pixels, factor: f32) -> Self {
        let Place { x, y, width, height, mean } = place;
        let picture = |p: &Pixels| png(width, &display(&cut(&p.rgb, p.width, place), factor));
        let colours: Vec<u8> = cut(&map.values, map.width, place).iter().flat_map(|v| magma(*v)).collect();
        let (image, reference) = (picture(image), picture(reference));
        Self { x, y, width, height, mean, image, reference, flip: png(width, &colours) }
    }
}

/// Side of the smallest blocks with which a picture of the given size fits.
fn block_for(width: usize, height: usize, fits: impl Fn(usize, usize) -> bool) -> usize {
    (1..).find(|b| fits(width.div_ceil(*b), height.div_ceil(*b))).unwrap_or(1)
}

/// Number of columns, and means of blocks of `side` × `side` values (fewer at the right and lower edge).
fn reduce<T, const N: usize>(
    width: usize,
    values: &[T],
    side: usize,
    channels: impl Fn(&T) -> [f32; N],
) -> (usize, Vec<[f32; N]>) {
    if side == 1 {
        return (width, values.iter().map(channels).collect());
    }
    let columns = width.div_ceil(side);
    let mut out = Vec::new();
    for band in values.chunks(width * side) {
        let mut sums = vec![([0.0f64; N], 0.0f64); columns];
        for row in band.chunks_exact(width) {
            for (x, value) in row.iter().enumerate() {
                let (sum, count) = &mut sums[x / side];
                *count += 1.0;
                for (s, v) in sum.iter_mut().zip(channels(value)) {
                    *s += f64::from(v);
                }
            }
        }
        out.extend(sums.into_iter().map(|(sum, count)| sum.map(|s| (s / count) as f32)));
    }
    (columns, out)
}

fn halves<const N: usize>(values: &[[f32; N]]) -> String {
    let limit = f16::MAX.to_f32();
    let half = |v: &f32| f16::from_f32(v.clamp(-limit, limit)).to_le_bytes();
    base64(&values.iter().flatten().flat_map(half).collect::<Vec<u8>>())
}

fn cut<T: Copy>(values: &[T], width: usize, place: Place) -> Vec<T> {
    let rows = values.chunks_exact(width).skip(place.y).take(place.height);
    rows.flat_map(|row| row[place.x..place.x + place.width].iter().copied()).collect()
}

fn display(rgb: &[[f32; 3]], factor: f32) -> Vec<u8> {
    let byte = |v: &f32| (255.0 * linear_to_srgb((v * factor).clamp(0.0, 1.0)) + 0.5) as u8;
    rgb.iter().flatten().map(byte).collect()
}

fn png(width: usize, rgb: &[u8]) -> String {
    let bytes = encode_png(width, rgb.len() / (3 * width.max(1)), rgb);
    base64(&bytes.expect("whole rows of RGB can be encoded"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_means_up_to_the_border() {
        let values: Vec<f32> = (0..15).map(|v| v as f32).collect();
        let (width, means) = reduce(5, &values, 2, |v| [*v]);
        assert_eq!(width, 3);
        assert_eq!(means.concat(), [3.0, 5.0, 6.5, 10.5, 12.5, 14.0]);
        assert_eq!(block_for(4096, 4096, |w, h| w * h <= MAX_PIXELS), 4);
    }
}
