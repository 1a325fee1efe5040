//! First two Sobol dimensions with nested uniform (Owen) scrambling by hashing.
//!
//! Burley, "Practical Hash-based Owen Scrambling", JCGT 2020. The second dimension's generator
//! matrix is Pascal's triangle modulo 2, which factors into five masked shifts.

use super::hash::unit_float;
use super::mix;
use crate::math::simd::widest;

/// The Laine–Karras permutation with Vegdahl's constants. Bit i of the result depends only on bits ≤ i, so on
/// reversed bits this is a nested uniform scramble.
#[inline(always)]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

/// Owen scrambling of the 32-bit fraction `x`.
#[inline(always)]
fn scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}

/// The second Sobol coordinate as a 32-bit fraction; the first is the bit-reversed index.
#[inline(always)]
fn second_dimension(index: u32) -> u32 {
    let mut x = index;
    x ^= (x >> 16) & 0x0000_ffff;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 1) & 0x5555_5555;
    x.reverse_bits()
}

/// Point `index` as 32-bit fractions: the index is shuffled with seed `order`, the coordinates are scrambled with
/// seeds `a` and `b`.
#[inline(always)]
fn scrambled(index: u32, order: u32, a: u32, b: u32) -> [u32; 2] {
    let order = scramble(index, order);
    [laine_karras(order, a).reverse_bits(), scramble(second_dimension(order), b)]
}

/// Derive the seeds of the two coordinates from that of the shuffle.
const FIRST: u64 = 0xa5a5_a5a5;
const SECOND: u64 = 0x5a5a_5a5a;

/// Points computed at once by [`batch`].
pub const BATCH: usize = 8;

/// Point `index` of each of the sequences `first..first + BATCH` of `key`, in [0, 1)², into `out` as all first
/// coordinates and all second ones. Computed one at a time, a point costs as much as tracing a ray.
pub fn batch(index: u32, key: u64, first: u32, out: &mut [[f32; BATCH]; 2]) {
    widest!(
        batch_body;
        index: u32 = index, key: u64 = key, first: u32 = first, out: &mut [[f32; BATCH]; 2] = out => ()
    );
}

#[inline(always)]
fn batch_body(index: u32, key: u64, first: u32, out: &mut [[f32; BATCH]; 2]) {
    let mut seeds = [[0u32; 3]; BATCH];
    for (s, pair) in seeds.iter_mut().zip(u64::from(first)..) {
        let seed = mix(key.wrapping_add(pair));
        *s = [seed as u32, mix(seed ^ FIRST) as u32, mix(seed ^ SECOND) as u32];
    }
    for (l, &[order, a, b]) in seeds.iter().enumerate() {
        let [x, y] = scrambled(index, order, a, b);
        (out[0][l], out[1][l]) = (unit_float(x), unit_float(y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_dimension_matches_the_sobol_matrix() {
        for i in 0..5000u32 {
            let (mut n, mut v, mut r) = (i, 1u32 << 31, 0u32);
            while n != 0 {
                if n & 1 == 1 {
                    r ^= v;
                }
                n >>= 1;
                v ^= v >> 1;
            }
            assert_eq!(second_dimension(i), r, "index {i}");
        }
    }

    #[test]
    fn every_power_of_two_prefix_is_a_0_2_net() {
        // Of the first 2^m points, every elementary interval of area 2^-m contains exactly one.
        for seed in 0..20u64 {
            for m in [4u32, 6, 7] {
                let point = |i: u32| {
                    let mut points = [[0.0; BATCH]; 2];
                    batch(i, seed, 0, &mut points);
                    points.map(|c| (c[3] * 16_777_216.0) as u32 * 256)
                };
                let points: Vec<[u32; 2]> = (0..1u32 << m).map(point).collect();
                for a in 0..=m {
                    let b = m - a;
                    let mut seen = vec![false; 1 << m];
                    for p in &points {
                        let x = (u64::from(p[0]) >> (32 - a)) as usize;
                        let y = (u64::from(p[1]) >> (32 - b)) as usize;
                        let cell = x << b | y;
                        assert!(!seen[cell], "seed {seed} m {m} split {a}/{b}");
                        seen[cell] = true;
                    }
                }
            }
        }
    }
}
