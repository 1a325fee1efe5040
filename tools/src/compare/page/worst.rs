//! Where a picture is worst, and how its errors are distributed.

use crate::flip::FlipMap;

/// Bins of the histogram.
const BINS: usize = 100;
/// Places shown.
const PLACES: usize = 4;

/// Share of the pixels per hundredth of FLIP; the last bin includes 1.
pub fn histogram(map: &FlipMap) -> Vec<f64> {
    let mut counts = [0usize; BINS];
    for v in &map.values {
        counts[((v * BINS as f32) as usize).min(BINS - 1)] += 1;
    }
    counts.iter().map(|n| *n as f64 / map.values.len().max(1) as f64).collect()
}

/// A rectangle of pixels and its mean FLIP.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
    pub mean: f64,
}

/// The places with the largest mean FLIP, worst first: squares of an eighth of the shorter side (16 to 64
/// pixels) on a grid of half a square, none overlapping another. Places without an error are left out.
pub fn places(map: &FlipMap) -> Vec<Place> {
    let side = (map.width.min(map.height) / 8).clamp(16, 64);
    let (width, height) = (side.min(map.width), side.min(map.height));
    let mut all = Vec::new();
    for y in starts(map.height, height) {
        for x in starts(map.width, width) {
            let rows = map.values.chunks_exact(map.width).skip(y).take(height);
            let sum: f64 = rows.flat_map(|row| &row[x..x + width]).map(|v| f64::from(*v)).sum();
            all.push(Place { x, y, width, height, mean: sum / (width * height) as f64 });
        }
    }
    all.sort_by(|a, b| b.mean.total_cmp(&a.mean));
    let mut chosen: Vec<Place> = Vec::new();
    for place in all.into_iter().filter(|p| p.mean > 0.0) {
        let apart = |c: &Place| place.x.abs_diff(c.x) >= width || place.y.abs_diff(c.y) >= height;
        if chosen.iter().all(apart) {
            chosen.push(place);
        }
        if chosen.len() == PLACES {
            break;
        }
    }
    chosen
}

/// Where windows of length `size` start, half of that apart; the last one ends with the picture.
fn starts(length: usize, size: usize) -> Vec<usize> {
    let last = length - size;
    let mut all: Vec<usize> = (0..last).step_by((size / 2).max(1)).collect();
    all.push(last);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_place_comes_first_and_none_overlap() {
        let mut values = vec![0.0; 200 * 150];
        for y in 100..110 {
            for x in 60..70 {
                values[y * 200 + x] = 0.5;
            }
        }
        values[3] = 1.0;
        let found = places(&FlipMap { width: 200, height: 150, values });
        assert!((found[0].x..found[0].x + found[0].width).contains(&65));
        assert!((found[0].y..found[0].y + found[0].height).contains(&105));
        assert!(found.len() >= 2 && found.windows(2).all(|w| w[0].mean >= w[1].mean));
    }

    #[test]
    fn small_and_equal_pictures_have_places_and_none() {
        let small = FlipMap { width: 5, height: 3, values: vec![0.1; 15] };
        assert_eq!(places(&small).len(), 1);
        assert!(places(&FlipMap { values: vec![0.0; 15], ..small }).is_empty());
    }

    #[test]
    fn shares_add_up() {
        let map = FlipMap { width: 2, height: 2, values: vec![0.0, 0.005, 0.999, 1.0] };
        let h = histogram(&map);
        assert_eq!((h[0], h[99], h.iter().sum::<f64>()), (0.5, 0.5, 1.0));
    }
}
