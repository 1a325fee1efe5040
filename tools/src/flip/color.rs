//! Colour spaces of FLIP and the colour difference after filtering.

/// Linear Rec.709 to CIE XYZ (D65), from the rational primaries of the 2020 paper's supplement.
const RGB_TO_XYZ: [[f32; 3]; 3] = [
    [10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0],
    [2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0],
    [1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0],
];

/// Inverse of [`RGB_TO_XYZ`].
const XYZ_TO_RGB: [[f32; 3]; 3] = [
    [3.241003275, -1.537398934, -0.498615861],
    [-0.969224334, 1.875930071, 0.041554224],
    [0.055639423, -0.204011202, 1.057148933],
];

/// XYZ of linear (1, 1, 1), and its reciprocal.
const WHITE: [f32; 3] = [0.950428545, 1.0, 1.088900371];
const INVERSE_WHITE: [f32; 3] = [1.052156925, 1.0, 0.918357670];

/// Exponent that compresses colour differences.
const Q_C: f32 = 0.7;
/// Differences below this share of the largest one are stretched …
const P_C: f32 = 0.4;
/// … to this share of the range of errors.
const P_T: f32 = 0.95;

#[inline(always)]
fn multiply(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    [
        m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
        m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
        m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2],
    ]
}

/// Linear RGB to the opponent space YCxCz (linearised CIELAB), in which the eye's filters are defined.
#[inline(always)]
pub fn rgb_to_ycxcz(rgb: [f32; 3]) -> [f32; 3] {
    let xyz = multiply(&RGB_TO_XYZ, rgb);
    let [x, y, z] = [xyz[0] * INVERSE_WHITE[0], xyz[1] * INVERSE_WHITE[1], xyz[2] * INVERSE_WHITE[2]];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// YCxCz to linear RGB, clamped to the display's [0, 1].
#[inline(always)]
fn ycxcz_to_rgb(v: [f32; 3]) -> [f32; 3] {
    let y = (v[0] + 16.0) / 116.0;
    let xyz = [(y + v[1] / 500.0) * WHITE[0], y * WHITE[1], (y - v[2] / 200.0) * WHITE[2]];
    let rgb = multiply(&XYZ_TO_RGB, xyz);
    [rgb[0].clamp(0.0, 1.0), rgb[1].clamp(0.0, 1.0), rgb[2].clamp(0.0, 1.0)]
}

/// Linear RGB in [0, 1] to CIELAB with the Hunt effect: chroma counts more in brighter colours.
#[inline(always)]
fn rgb_to_hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let xyz = multiply(&RGB_TO_XYZ, rgb);
    let f = |t: f32| {
        let root = fast_cbrt(t);
        let line = t * (1.0 / (3.0 * DELTA * DELTA)) + 4.0 / 29.0;
        if t > DELTA * DELTA * DELTA { root } else { line }
    };
    let [x, y, z] =
        [f(xyz[0] * INVERSE_WHITE[0]), f(xyz[1] * INVERSE_WHITE[1]), f(xyz[2] * INVERSE_WHITE[2])];
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// Cube root of a number in (0, 2): the exponent divided by three, then two steps of Halley's method (cubic
/// convergence, from 5 % to below one unit of f32). Branch-free, so that the compiler can vectorise it.
#[inline(always)]
fn fast_cbrt(t: f32) -> f32 {
    let t = t.max(1e-9);
    let mut r = f32::from_bits((t.to_bits() / 3).wrapping_add(0x2A51_19F2));
    for _ in 0..2 {
        let c = r * r * r;
        r = r * (c + t + t) / (c + c + t);
    }
    r
}

/// `x^p` for x in [0, 1000] and p in [0, 1], relative error below 3e-6; 0^p is 0 except for p = 0.
///
/// `2^(p log2 x)` with the logarithm as the series of `artanh` and the exponential as its Taylor polynomial,
/// both on reduced arguments. Branch-free and wrapping, so that the compiler can vectorise it even with
/// overflow checks.
#[inline(always)]
pub fn power(x: f32, p: f32) -> f32 {
    use std::f32::consts::{LN_2, SQRT_2};
    // x = m 2^e with m in [√½, √2).
    let bits = x.max(1e-30).to_bits() as i32;
    let above = i32::from(bits & 0x007F_FFFF > (SQRT_2.to_bits() & 0x007F_FFFF) as i32);
    let e = (bits >> 23).wrapping_sub(127).wrapping_add(above);
    let m = f32::from_bits(((bits & 0x007F_FFFF) | (127i32.wrapping_sub(above) << 23)) as u32);
    // ln m = 2 artanh((m − 1) / (m + 1)); the first term left out is below 2e-9.
    let t = (m - 1.0) / (m + 1.0);
    let t2 = t * t;
    let series = 1.0 + t2 * (1.0 / 3.0 + t2 * (1.0 / 5.0 + t2 * (1.0 / 7.0 + t2 * (1.0 / 9.0))));
    let exponent = p * (e as f32 + 2.0 / LN_2 * t * series);
    // 2^exponent = 2^whole e^rest with |rest| ≤ ½ ln 2.
    let whole = ((exponent + 512.5) as i32).wrapping_sub(512);
    let r = (exponent - whole as f32) * LN_2;
    let exp =
        1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r / 720.0)))));
    let value = exp * f32::from_bits((whole.wrapping_add(127) << 23) as u32);
    if x > 0.0 || p == 0.0 { value } else { 0.0 }
}

/// HyAB distance (Abasi et al. 2020): city block in lightness, Euclidean in chroma.
#[inline(always)]
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    let (da, db) = (a[1] - b[1], a[2] - b[2]);
    (a[0] - b[0]).abs() + (da * da + db * db).sqrt()
}

/// The largest colour difference, raised to `q_c`: green against blue.
#[derive(Clone, Copy, Debug)]
pub struct ColorScale {
    max: f32,
}

impl ColorScale {
    pub fn new() -> Self {
        let green = rgb_to_hunt_lab([0.0, 1.0, 0.0]);
        let blue = rgb_to_hunt_lab([0.0, 0.0, 1.0]);
        Self { max: hyab(green, blue).powf(Q_C) }
    }

    /// HyAB distance of two filtered colours in YCxCz.
    #[inline(always)]
    pub fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
        hyab(rgb_to_hunt_lab(ycxcz_to_rgb(a)), rgb_to_hunt_lab(ycxcz_to_rgb(b)))
    }

    /// Distance to colour error in [0, 1] (2020, §4.1.3).
    #[inline(always)]
    pub fn error(&self, distance: f32) -> f32 {
        let compressed = power(distance, Q_C);
        let knee = P_C * self.max;
        if compressed < knee {
            P_T / knee * compressed
        } else {
            P_T + (compressed - knee) / (self.max - knee) * (1.0 - P_T)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_root_is_exact_to_a_few_units() {
        for i in 1..200_000 {
            let t = i as f32 * 1e-5;
            let exact = f64::from(t).cbrt();
            assert!((f64::from(fast_cbrt(t)) / exact - 1.0).abs() < 3e-7, "{t}");
        }
    }

    #[test]
    fn power_is_exact_to_a_few_millionths() {
        for i in 1..2000 {
            let x = (i as f32 / 2000.0).powi(4) * 300.0;
            for p in [0.0, 0.01, 0.3, 0.5, 0.7, 1.0] {
                let exact = f64::from(x).powf(f64::from(p));
                assert!((f64::from(power(x, p)) / exact - 1.0).abs() < 3e-6, "{x} {p} {}", power(x, p));
            }
        }
        assert_eq!((power(0.0, 0.7), power(0.0, 0.0), power(1.0, 0.3)), (0.0, 1.0, 1.0));
    }

    #[test]
    fn opponent_space_and_back() {
        for rgb in [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.2, 0.5, 0.9]] {
            let back = ycxcz_to_rgb(rgb_to_ycxcz(rgb));
            for c in 0..3 {
                assert!((back[c] - rgb[c]).abs() < 1e-5, "{rgb:?} {back:?}");
            }
        }
        assert!(rgb_to_ycxcz([1.0; 3])[1].abs() < 1e-3);
    }

    #[test]
    fn green_against_blue_is_the_largest_error() {
        let s = ColorScale::new();
        let d = ColorScale::distance(rgb_to_ycxcz([0.0, 1.0, 0.0]), rgb_to_ycxcz([0.0, 0.0, 1.0]));
        assert!((s.error(d) - 1.0).abs() < 1e-5);
        assert_eq!(s.error(0.0), 0.0);
    }
}
