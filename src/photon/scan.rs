//! The inner loop: distance, height and normal tests over runs of photons, sixteen at a time.
//!
//! Written as plain loops over fixed arrays that the compiler turns into SIMD, compiled once per
//! instruction set and chosen at run time. No fused operations are used, so every variant gives the
//! same bits.

use super::store::{HEIGHT, LANES, NORMAL_AGREEMENT, PhotonMap, Query};
use crate::math::Color;
use crate::math::kernel::Kernel;

/// Constants rather than shifts: the compiler then masks and folds whole vectors.
const BITS: [u32; LANES] = [
    1,
    1 << 1,
    1 << 2,
    1 << 3,
    1 << 4,
    1 << 5,
    1 << 6,
    1 << 7,
    1 << 8,
    1 << 9,
    1 << 10,
    1 << 11,
    1 << 12,
    1 << 13,
    1 << 14,
    1 << 15,
];

/// Squared distances of a block and which lanes are on the query's disc.
struct Block {
    d2: [f32; LANES],
    inside: [bool; LANES],
}

#[inline(always)]
fn block<T: Copy>(v: &[T], base: usize) -> &[T; LANES] {
    v[base..base + LANES].try_into().expect("arrays are padded by LANES")
}

#[inline(always)]
fn test(map: &PhotonMap, q: &Query, base: usize, end: usize) -> Block {
    let (x, y, z) =
        (block(&map.position[0], base), block(&map.position[1], base), block(&map.position[2], base));
    let (nx, ny, nz) =
        (block(&map.normal[0], base), block(&map.normal[1], base), block(&map.normal[2], base));
    let [px, py, pz] = q.p.to_array();
    let [qx, qy, qz] = q.n.to_array();
    let r2 = q.radius * q.radius;
    let lift2 = q.lift * q.lift;
    let (agreement, slope) = (NORMAL_AGREEMENT * 127.0, HEIGHT * HEIGHT);
    let left = (end - base) as i32;
    let mut b = Block { d2: [0.0; LANES], inside: [false; LANES] };
    for l in 0..LANES {
        let (dx, dy, dz) = (x[l] - px, y[l] - py, z[l] - pz);
        let d2 = dx * dx + dy * dy + dz * dz;
        let h = dx * qx + dy * qy + dz * qz;
        let n = f32::from(nx[l]) * qx + f32::from(ny[l]) * qy + f32::from(nz[l]) * qz;
        b.d2[l] = d2;
        b.inside[l] = (d2 < r2) & (h * h <= slope * d2 + lift2) & (n > agreement) & ((l as i32) < left);
    }
    b
}

#[inline(always)]
fn accumulate_body<K: Kernel>(map: &PhotonMap, q: &Query) -> (Color, u32) {
    let inv = 1.0 / (q.radius * q.radius);
    let mut sum = [[0.0f32; LANES]; 3];
    let mut count = [0u32; LANES];
    let mut runs = map.runs(q);
    while let Some((start, end)) = runs.next() {
        let mut base = start;
        while base < end {
            let b = test(map, q, base, end);
            let flux = [block(&map.flux[0], base), block(&map.flux[1], base), block(&map.flux[2], base)];
            for l in 0..LANES {
                let w = if b.inside[l] { K::shape(b.d2[l] * inv) } else { 0.0 };
                sum[0][l] += w * flux[0][l];
                sum[1][l] += w * flux[1][l];
                sum[2][l] += w * flux[2][l];
                count[l] += u32::from(b.inside[l]);
            }
            base += LANES;
        }
    }
    (Color::from_lanes(sum.map(|s| s.iter().sum())), count.iter().sum())
}

#[inline(always)]
fn visit_body(map: &PhotonMap, q: &Query, found: &mut impl FnMut(u32, f32)) {
    let mut runs = map.runs(q);
    while let Some((start, end)) = runs.next() {
        let mut base = start;
        while base < end {
            let b = test(map, q, base, end);
            let mut bits = [0u32; LANES];
            for l in 0..LANES {
                bits[l] = if b.inside[l] { BITS[l] } else { 0 };
            }
            let mut mask = bits.iter().fold(0, |m, b| m | b);
            while mask != 0 {
                let l = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                found((base + l) as u32, b.d2[l]);
            }
            base += LANES;
        }
    }
}

/// One copy of each loop per instruction set.
macro_rules! variants {
    ($($name:ident: $features:literal;)+) => {
        #[cfg(target_arch = "x86_64")]
        mod simd {
            use super::*;
            $(pub mod $name {
                use super::*;
                #[target_feature(enable = $features)]
                pub fn accumulate<K: Kernel>(map: &PhotonMap, q: &Query) -> (Color, u32) {
                    accumulate_body::<K>(map, q)
                }
                #[target_feature(enable = $features)]
                pub fn visit(map: &PhotonMap, q: &Query, found: &mut impl FnMut(u32, f32)) {
                    visit_body(map, q, found);
                }
            })+
        }
    };
}
variants! {
    avx2: "avx2";
    avx512: "avx512f,avx512bw,avx512dq,avx512vl";
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Σ shape(d²/r²)·flux over the disc (un-normalised), and how many photons it holds.
#[inline]
pub fn accumulate<K: Kernel>(map: &PhotonMap, q: &Query) -> (Color, u32) {
    #[cfg(target_arch = "x86_64")]
    {
        if has_avx512() {
            // SAFETY: the features were just detected.
            return unsafe { simd::avx512::accumulate::<K>(map, q) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the feature was just detected.
            return unsafe { simd::avx2::accumulate::<K>(map, q) };
        }
    }
    accumulate_body::<K>(map, q)
}

/// Calls `found(index, squared distance)` for every photon of the disc.
#[inline]
pub fn visit(map: &PhotonMap, q: &Query, found: &mut impl FnMut(u32, f32)) {
    #[cfg(target_arch = "x86_64")]
    {
        if has_avx512() {
            // SAFETY: the features were just detected.
            return unsafe { simd::avx512::visit(map, q, found) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the feature was just detected.
            return unsafe { simd::avx2::visit(map, q, found) };
        }
    }
    visit_body(map, q, found);
}
