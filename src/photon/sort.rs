//! The order of photons by the cell of the grid that they lie in: a counting sort in two steps, first by ranges of cells,
//! then by the cells of each range. Photons of one cell keep their order, whatever the number of threads.

use std::ops::Range;

use rayon::prelude::*;

/// Photons of one unit of parallel work.
pub(super) const PART: usize = 1 << 16;

/// Ranges of cells, at most.
const RANGES: usize = 512;

/// Numbers of photons by cell, and where each cell begins among them, with their count at the end.
pub(super) fn by_cell(
    photons: usize,
    cells: usize,
    cell_of: impl Fn(usize) -> usize + Sync,
) -> (Vec<u32>, Vec<u32>) {
    let shift = cells.div_ceil(RANGES).next_power_of_two().trailing_zeros();
    let width = 1usize << shift;
    let ranges = cells.div_ceil(width);
    let parts: Vec<Part> = (0..photons.div_ceil(PART))
        .into_par_iter()
        .map(|part| Part::new(part * PART..((part + 1) * PART).min(photons), ranges, shift, &cell_of))
        .collect();
    let mut order = vec![0u32; photons];
    let mut starts = vec![0u32; cells + 1];
    starts[cells] = photons as u32;
    let mut slices = Vec::with_capacity(ranges);
    let (mut left, mut first) = (&mut order[..], 0u32);
    for range in 0..ranges {
        let count = parts.iter().map(|part| part.keys_of(range).len()).sum();
        let (mine, rest) = left.split_at_mut(count);
        slices.push((mine, first));
        (left, first) = (rest, first + count as u32);
    }
    slices.into_par_iter().zip(starts[..cells].par_chunks_mut(width)).enumerate().for_each(
        |(range, ((order, first), starts))| {
            let keys = || parts.iter().flat_map(|part| part.keys_of(range));
            let cell = |key: &u64| (key >> 32) as usize - range * width;
            keys().for_each(|key| starts[cell(key)] += 1);
            let mut next = 0;
            for start in starts.iter_mut() {
                next += std::mem::replace(start, next);
            }
            for key in keys() {
                let at = &mut starts[cell(key)];
                order[*at as usize] = *key as u32;
                *at += 1;
            }
            // Each cell has advanced to the end of its photons, which is where the next begins.
            starts.copy_within(..starts.len() - 1, 1);
            starts[0] = 0;
            starts.iter_mut().for_each(|start| *start += first);
        },
    );
    (order, starts)
}

/// Some photons in a row, by ranges of cells.
struct Part {
    /// Cell in the upper half, number of the photon in the lower.
    keys: Vec<u64>,
    /// End of each range among them.
    ends: Vec<u32>,
}

impl Part {
    fn new(photons: Range<usize>, ranges: usize, shift: u32, cell_of: impl Fn(usize) -> usize) -> Self {
        let unsorted: Vec<u64> = photons.map(|i| (cell_of(i) as u64) << 32 | i as u64).collect();
        let range = |key: u64| (key >> 32 >> shift) as usize;
        let mut ends = vec![0u32; ranges];
        unsorted.iter().for_each(|&key| ends[range(key)] += 1);
        let mut next = 0;
        for end in &mut ends {
            next += std::mem::replace(end, next);
        }
        let mut keys = vec![0; unsorted.len()];
        for key in unsorted {
            let at = &mut ends[range(key)];
            keys[*at as usize] = key;
            *at += 1;
        }
        Self { keys, ends }
    }

    fn keys_of(&self, range: usize) -> &[u64] {
        let first = if range == 0 { 0 } else { self.ends[range - 1] };
        &self.keys[first as usize..self.ends[range] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::mix;

    #[test]
    fn the_order_is_that_of_a_stable_sort() {
        for (photons, cells) in
            [(0, 1), (1, 1), (1000, 3), (300_000, 1), (300_000, 70_000), (70_000, 900_000)]
        {
            let cell_of = |i: usize| (mix(i as u64) % cells as u64) as usize;
            let (order, starts) = by_cell(photons, cells, cell_of);
            let mut expected: Vec<u32> = (0..photons as u32).collect();
            expected.sort_by_key(|&i| cell_of(i as usize));
            assert_eq!(order, expected, "{photons} photons, {cells} cells");
            let begins = |cell: usize| expected.partition_point(|&i| cell_of(i as usize) < cell) as u32;
            assert_eq!(starts.len(), cells + 1);
            for cell in (0..=cells).step_by(1 + cells / 1000) {
                assert_eq!(starts[cell], begins(cell), "{photons} photons, cell {cell} of {cells}");
            }
        }
    }
}
