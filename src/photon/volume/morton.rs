//! Order along a Morton curve: neighbours in the list are near each other.

use rayon::prelude::*;

use crate::math::{Bounds, Vec3};

/// Bits of a coordinate; three fit into a key.
const BITS: u32 = 21;

/// Indices of the places sorted along the curve; equal places keep their order.
pub fn order(places: impl IndexedParallelIterator<Item = Vec3>, bounds: &Bounds) -> Vec<u32> {
    let most = ((1u32 << BITS) - 1) as f32;
    let scale = (Vec3::splat(most) / bounds.extent().max(Vec3::splat(f32::MIN_POSITIVE))).min(Vec3::MAX);
    let mut keys: Vec<(u64, u32)> = places
        .enumerate()
        .map(|(i, p)| {
            // The cast saturates.
            let [x, y, z] = ((p - bounds.min) * scale).min(Vec3::splat(most)).to_array().map(|v| v as u64);
            (spread(x) | spread(y) << 1 | spread(z) << 2, i as u32)
        })
        .collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, i)| i).collect()
}

/// Puts two zeros before each bit.
fn spread(x: u64) -> u64 {
    let mut x = x & ((1 << BITS) - 1);
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_by_three() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(u64::MAX), 0x1249_2492_4924_9249);
    }

    /// The eight corners of a cube, twice: the curve goes through each once, and equal corners keep their order.
    #[test]
    fn order_follows_the_curve() {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32);
        let places: Vec<Vec3> = (0..16).rev().map(corner).collect();
        let bounds = Bounds::of(places.iter().copied());
        let order = order(places.par_iter().copied(), &bounds);
        assert_eq!(order, [7, 15, 6, 14, 5, 13, 4, 12, 3, 11, 2, 10, 1, 9, 0, 8]);
    }
}
