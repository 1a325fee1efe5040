//! First two Sobol dimensions with nested uniform (Owen) scrambling by hashing.
//!
//! Burley, "Practical Hash-based Owen Scrambling", JCGT 2020. The second dimension's generator
//! matrix is Pascal's triangle modulo 2, which factors into five masked shifts.

/// Laine–Karras permutation with Vegdahl's constants: bit i of the result depends on bits ≤ i only,
/// which on reversed bits is a nested uniform scramble.
#[inline]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

/// Owen scramble of the base-2 fraction `x`.
#[inline]
pub fn scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}

/// Second Sobol dimension as a 32-bit fraction; the first is the reversed index.
#[inline]
fn second_dimension(index: u32) -> u32 {
    let mut x = index;
    x ^= (x >> 16) & 0x0000_ffff;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 1) & 0x5555_5555;
    x.reverse_bits()
}

/// Point `index` of the sequence belonging to `seed`, as two 32-bit fractions. Different seeds give
/// independently shuffled and scrambled copies, so they may be padded into higher dimensions.
#[inline]
pub fn point(index: u32, seed: u64) -> [u32; 2] {
    let order = scramble(index, seed as u32);
    let (a, b) = (super::mix(seed ^ 0xa5a5_a5a5), super::mix(seed ^ 0x5a5a_5a5a));
    [laine_karras(order, a as u32).reverse_bits(), scramble(second_dimension(order), b as u32)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_dimension_is_the_sobol_matrix() {
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
        // 2^m points put exactly one point into every elementary interval of area 2^-m.
        for seed in 0..20u64 {
            for m in [4u32, 6, 7] {
                let points: Vec<[u32; 2]> =
                    (0..1u32 << m).map(|i| point(i, crate::sampling::mix(seed))).collect();
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
