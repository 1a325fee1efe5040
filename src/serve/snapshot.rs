//! The picture as it was after a pass, and the form in which the page gets it.

use std::sync::{Arc, Mutex, PoisonError};

use caustica_tools::flip::FlipMap;
use half::f16;
use half::slice::HalfFloatSliceExt;
use rayon::prelude::*;

use crate::session::{Content, Picture, Session};

/// Pixels of a tile, about: few enough for all threads to share the work on a small picture.
const TILE: usize = 1 << 12;

/// A layer that can be looked at.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Of the picture itself: `picture`.
    pub name: String,
    pub content: Content,
    /// The names of its numbers.
    pub channels: Vec<String>,
}

impl Shown {
    /// The picture, and what the session's EXR would hold beside it.
    pub fn all(session: &Session) -> Vec<Self> {
        let picture = Self {
            name: "picture".to_owned(),
            content: Content::Picture,
            channels: ["R", "G", "B", "A"].map(str::to_owned).to_vec(),
        };
        let others = session.layers().iter().map(|layer| {
            let name = if layer.name.is_empty() { "gbuffer" } else { &layer.name };
            Self { name: name.to_owned(), content: layer.content, channels: layer.channels.clone() }
        });
        std::iter::once(picture).chain(others).collect()
    }

    /// Whether it is the picture, which is in every snapshot. Others are in those made after somebody asked for them.
    pub fn is_picture(&self) -> bool {
        matches!(self.content, Content::Picture)
    }

    /// Whether it is the picture or a part of it: what tev gets, and every page at the end.
    pub fn is_light(&self) -> bool {
        matches!(self.content, Content::Picture | Content::Part(_))
    }
}

/// Rows of the picture.
#[derive(Debug)]
pub struct Tile {
    pub top: usize,
    pub rows: usize,
    /// The numbers of each layer, pixel by pixel; absent where it was not wanted.
    pub layers: Vec<Option<Vec<f32>>>,
}

/// All wanted layers after a pass.
#[derive(Debug)]
pub struct Snapshot {
    /// From 1.
    pub number: u64,
    pub passes: u32,
    pub seconds: f64,
    pub size: [usize; 2],
    pub tiles: Vec<Tile>,
    /// Each layer in the form for the page, once somebody has asked for it.
    coded: Mutex<Vec<Option<Arc<Vec<u8>>>>>,
}

impl Snapshot {
    /// Of a picture, with the layers that are wanted.
    pub fn of(picture: &Picture<'_>, layers: &[Shown], wanted: &[bool], stamp: (u64, u32, f64)) -> Self {
        let size @ [width, height] = picture.size();
        let rows = TILE.div_ceil(width.max(1)).max(1);
        let tops: Vec<usize> = (0..height).step_by(rows).collect();
        let tile = |&top: &usize| {
            let rows = rows.min(height - top);
            let range = top * width..(top + rows) * width;
            let numbers = |(layer, wanted): (&Shown, &bool)| {
                wanted.then(|| picture.channels(layer.content, range.clone()))
            };
            Tile { top, rows, layers: layers.iter().zip(wanted).map(numbers).collect() }
        };
        let tiles = tops.par_iter().map(tile).collect();
        let (number, passes, seconds) = stamp;
        Self { number, passes, seconds, size, tiles, coded: Mutex::new(vec![None; layers.len()]) }
    }

    /// Whether it has this layer.
    pub fn has(&self, layer: usize) -> bool {
        self.tiles.iter().all(|tile| tile.layers.get(layer).is_some_and(Option::is_some))
    }

    /// Red, green and blue of the picture, which is the first layer.
    pub fn rgb(&self) -> Vec<[f32; 3]> {
        let [width, height] = self.size;
        let mut rgb = Vec::with_capacity(width * height);
        for numbers in self.tiles.iter().filter_map(|tile| tile.layers.first()?.as_ref()) {
            rgb.extend(numbers.chunks_exact(4).map(|p| [p[0], p[1], p[2]]));
        }
        rgb
    }

    /// A layer for the page; `None` when the snapshot does not have it.
    pub fn coded(&self, layer: usize, channels: usize) -> Option<Arc<Vec<u8>>> {
        if !self.has(layer) {
            return None;
        }
        let mut coded = self.coded.lock().unwrap_or_else(PoisonError::into_inner);
        let place = coded.get_mut(layer)?;
        if let Some(done) = place {
            return Some(Arc::clone(done));
        }
        let [width, height] = self.size;
        let mut out = head(self.number, [width, height, 3]);
        for tile in &self.tiles {
            let numbers = tile.layers[layer].as_deref().unwrap_or_default();
            let mut colours = vec![[0.0; 3]; width * tile.rows];
            for (colour, numbers) in colours.iter_mut().zip(numbers.chunks_exact(channels)) {
                *colour = three(numbers).map(presentable);
            }
            let colours = colours.as_flattened();
            put_tile(&mut out, [0, tile.top, width, tile.rows], colours);
        }
        let done = Arc::new(out);
        *place = Some(Arc::clone(&done));
        Some(done)
    }
}

/// A picture that does not change, for the page.
pub fn coded_picture(width: usize, rgb: &[[f32; 3]]) -> Vec<u8> {
    coded_whole(width, rgb.as_flattened(), 3, 0)
}

/// An error map for the page.
pub fn coded_map(map: &FlipMap, number: u64) -> Vec<u8> {
    coded_whole(map.width, &map.values, 1, number)
}

fn coded_whole(width: usize, values: &[f32], channels: usize, number: u64) -> Vec<u8> {
    let row = width.max(1) * channels;
    let mut out = head(number, [width, values.len() / row, channels]);
    let rows = TILE.div_ceil(width.max(1)).max(1);
    for (i, part) in values.chunks(rows * row).enumerate() {
        let values: Vec<f32> = part.iter().map(|v| presentable(*v)).collect();
        put_tile(&mut out, [0, i * rows, width, part.len() / row], &values);
    }
    out
}

/// What precedes the tiles, each number in four bytes, the least first: number, width, height, channels.
fn head(number: u64, [width, height, channels]: [usize; 3]) -> Vec<u8> {
    let mut out = Vec::with_capacity(16 + 2 * width * height * channels);
    put(&mut out, number as usize);
    [width, height, channels].into_iter().for_each(|v| put(&mut out, v));
    out
}

/// A tile: column, row, width and height as four bytes each, then its values as half floats.
fn put_tile(out: &mut Vec<u8>, place: [usize; 4], values: &[f32]) {
    place.into_iter().for_each(|v| put(out, v));
    let mut halves = vec![f16::ZERO; values.len()];
    halves.convert_from_f32_slice(values);
    let first = out.len();
    out.resize(first + 2 * halves.len(), 0);
    for (bytes, half) in out[first..].chunks_exact_mut(2).zip(&halves) {
        bytes.copy_from_slice(&half.to_le_bytes());
    }
}

fn put(out: &mut Vec<u8>, value: usize) {
    out.extend((value as u32).to_le_bytes());
}

/// Three numbers to show as a colour: one is gray, the third of two is 0.
fn three(numbers: &[f32]) -> [f32; 3] {
    match *numbers {
        [r, g, b, ..] => [r, g, b],
        [a, b] => [a, b, 0.0],
        [a] => [a; 3],
        [] => [0.0; 3],
    }
}

/// Within what a half float holds.
fn presentable(v: f32) -> f32 {
    let limit = f16::MAX.to_f32();
    v.clamp(-limit, limit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_rows_with_their_place_in_front() {
        let rgb: Vec<[f32; 3]> = (0..5_000).map(|i| [i as f32, 0.5, 1e9]).collect();
        let coded = coded_picture(200, &rgb);
        let number = |at: usize| u32::from_le_bytes(coded[at..at + 4].try_into().unwrap());
        assert_eq!([0, 4, 8, 12].map(number), [0, 200, 25, 3]);
        // 21 rows of 200 pixels are the first that hold 2¹² of them.
        assert_eq!([16, 20, 24, 28].map(number), [0, 0, 200, 21]);
        let second = 32 + 21 * 200 * 3 * 2;
        assert_eq!([0, 4, 8, 12].map(|at| number(second + at)), [0, 21, 200, 4]);
        assert_eq!(coded.len(), second + 16 + 4 * 200 * 3 * 2);
        let half = |at: usize| f16::from_le_bytes([coded[at], coded[at + 1]]);
        assert_eq!([32 + 6, 32 + 8, 32 + 10].map(half), [f16::ONE, f16::from_f32(0.5), f16::MAX]);
    }

    #[test]
    fn fewer_than_three_numbers_make_a_colour_too() {
        assert_eq!(
            [three(&[1.0]), three(&[1.0, 2.0]), three(&[1.0, 2.0, 3.0, 4.0])],
            [[1.0; 3], [1.0, 2.0, 0.0], [1.0, 2.0, 3.0]]
        );
    }
}
