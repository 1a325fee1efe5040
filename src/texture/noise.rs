use super::{Pattern, Site, Textures, ToTexture};
use crate::math::{Color, Vec3};
use crate::spectrum::rgb;

/// Perlin's permutation of 0..256 (Perlin 2002, "Improving noise").
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99,
    37, 240, 21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27,
    166, 77, 146, 158, 231, 83, 111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244,
    102, 143, 54, 65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130,
    116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147,
    118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213, 119,
    248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129, 22, 39, 253, 19, 98, 108, 110,
    79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179,
    162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184, 84, 204, 176,
    115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78,
    66, 215, 61, 156, 180,
];

/// Slope of the noise along `d` at a lattice point: one of twelve edges of a cube, four of them twice.
fn slope(cell: [i32; 3], d: Vec3) -> f32 {
    let mixed = cell.iter().fold(0u8, |hash, &i| PERMUTATION[usize::from(hash.wrapping_add(i as u8))]);
    let hash = mixed & 15;
    let first = if hash < 8 || hash == 12 || hash == 13 { d.x } else { d.y };
    let second = if hash < 4 || hash == 12 || hash == 13 { d.y } else { d.z };
    let signed = |value: f32, bit: u8| if hash & bit == 0 { value } else { -value };
    signed(first, 1) + signed(second, 2)
}

/// Gradient noise in about (−1, 1), 0 on the lattice of whole numbers.
pub fn perlin(p: Vec3) -> f32 {
    // Beyond 2³⁰ a cell is smaller than the spacing of f32; what is not finite counts as 0. Not glam's remainder, which for
    // numbers below 0 is the one above 0: near 2³⁰ all fractions are lost.
    let p = if p.is_finite() { p.map(|x| x % (1u32 << 30) as f32) } else { Vec3::ZERO };
    let floor = p.floor();
    let (cell, d) = ([floor.x as i32, floor.y as i32, floor.z as i32], p - floor);
    let smooth = d * d * d * (d * (d * 6.0 - 15.0) + 10.0);
    let mut sum = 0.0;
    for corner in 0..8 {
        let offset = [corner & 1, corner >> 1 & 1, corner >> 2];
        let at = std::array::from_fn(|axis| cell[axis].wrapping_add(offset[axis]));
        let o = Vec3::from(offset.map(|x| x as f32));
        let weights = smooth * o + (Vec3::ONE - smooth) * (Vec3::ONE - o);
        sum += weights.x * weights.y * weights.z * slope(at, d - o);
    }
    sum
}

/// Ratio of the frequencies of two octaves: not 2, so that their lattices do not meet.
const LACUNARITY: f32 = 1.99;

/// Octaves of noise, each `roughness` times as strong as the one before.
fn octaves(p: Vec3, octaves: u32, roughness: f32, shape: fn(f32) -> f32) -> f32 {
    let (mut sum, mut frequency, mut strength) = (0.0, 1.0, 1.0);
    for _ in 0..octaves {
        sum += strength * shape(perlin(p * frequency));
        frequency *= LACUNARITY;
        strength *= roughness;
    }
    sum
}

fn fbm(p: Vec3, count: u32, roughness: f32) -> f32 {
    octaves(p, count, roughness, |x| x)
}

/// pbrt's patterns of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoiseKind {
    /// Sum of octaves.
    Fbm {
        /// How many octaves are added.
        octaves: u32,
        /// Amplitude of an octave over that of the one before.
        roughness: f32,
    },
    /// Sum of their absolute values.
    Wrinkled {
        /// How many octaves are added.
        octaves: u32,
        /// Amplitude of an octave over that of the one before.
        roughness: f32,
    },
    /// Waves on water.
    Windy,
    /// Veins that noise distorts.
    Marble {
        /// How many octaves are added.
        octaves: u32,
        /// Amplitude of an octave over that of the one before.
        roughness: f32,
        /// What positions are multiplied by.
        scale: f32,
        /// How far the noise moves the veins.
        variation: f32,
    },
}

/// Noise over space, with all its octaves: what is finer than a pixel is left to the film's samples.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Which pattern.
    pub kind: NoiseKind,
    /// From world space to that of the cells.
    pub to_texture: ToTexture,
}

impl Pattern for Noise {
    fn eval(&self, _textures: &Textures, at: &Site) -> Color {
        let p = self.to_texture.point(at.p);
        match self.kind {
            NoiseKind::Fbm { octaves, roughness } => Color::splat(fbm(p, octaves, roughness)),
            NoiseKind::Wrinkled { octaves: count, roughness } => {
                // pbrt stands in for the octave after the last by its mean.
                let rest = 0.2 * roughness.powi(count as i32);
                Color::splat(octaves(p, count, roughness, f32::abs) + rest)
            }
            NoiseKind::Windy => Color::splat(fbm(p * 0.1, 3, 0.5).abs() * fbm(p, 6, 0.5)),
            NoiseKind::Marble { octaves, roughness, scale, variation } => {
                let p = p * scale;
                vein(0.5 + 0.5 * (p.y + variation * fbm(p, octaves, roughness)).sin())
            }
        }
    }

    fn may_leave_unit(&self, _: &Textures) -> bool {
        true
    }
}

/// Colours across a vein of marble: runs of four are control points of Bézier curves.
const MARBLE: [[f32; 3]; 9] = [
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.5, 0.5, 0.5],
    [0.6, 0.59, 0.58],
    [0.58, 0.58, 0.6],
    [0.58, 0.58, 0.6],
    [0.2, 0.2, 0.33],
    [0.58, 0.58, 0.6],
];

fn vein(t: f32) -> Color {
    let curves = MARBLE.len() - 3;
    let along = t.clamp(0.0, 1.0) * curves as f32;
    let first = (along as usize).min(curves - 1);
    let t = along - first as f32;
    let s = 1.0 - t;
    let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
    let color: Color = weights.iter().zip(&MARBLE[first..]).map(|(w, c)| rgb(*c) * *w).sum();
    color * 1.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::to_rgb;

    #[test]
    fn the_table_is_a_permutation() {
        let mut sorted = PERMUTATION;
        sorted.sort_unstable();
        assert!(sorted.iter().enumerate().all(|(i, &x)| i == usize::from(x)));
    }

    /// Noise vanishes on its lattice, is continuous across cells and its slope there is that of the
    /// corner; its mean over many cells is 0 (8³ samples in 20³ cells: standard error below 0.005).
    #[test]
    fn noise_is_smooth_and_without_bias() {
        assert_eq!(perlin(Vec3::new(3.0, -7.0, 11.0)), 0.0);
        // Cells repeat after 256: below 0 there is the same noise as above.
        for i in 0..50 {
            let p = Vec3::new(0.37 * i as f32, 3.1, 0.6 * i as f32);
            let below = perlin(p - Vec3::splat(256.0));
            assert!((below - perlin(p)).abs() < 1e-3, "{below} below 0 at {p}");
        }
        for i in 0..50 {
            let p = Vec3::new(i as f32 - 25.0, 0.37 * i as f32, 1.7 * i as f32);
            let step = Vec3::X * 1e-3;
            assert!((perlin(p + step) - perlin(p - step)).abs() < 5e-3, "jump at {p}");
        }
        let n = 60;
        let mut sum = 0.0f64;
        for i in 0..n * n * n {
            let p = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32) * 0.337;
            sum += f64::from(perlin(p));
        }
        assert!((sum / f64::from(n * n * n)).abs() < 0.01);
    }

    #[test]
    fn what_is_no_number_is_no_noise() {
        for x in [f32::NAN, f32::INFINITY, 3e38] {
            assert!(perlin(Vec3::splat(x)).is_finite());
        }
    }

    #[test]
    fn veins_are_dark_between_pale_stone() {
        assert!((vein(0.0) - rgb([0.87, 0.87, 0.9])).abs().max_element() < 1e-5);
        let darkest = (0..=100).map(|i| to_rgb(vein(i as f32 / 100.0))[0]).fold(1.0, f32::min);
        assert!(darkest < 0.65, "{darkest}");
    }
}
