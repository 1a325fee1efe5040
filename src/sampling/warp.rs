//! Maps from uniform points of the unit square to other domains, each with its density.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use crate::math::{Vec2, Vec3};

/// A point of the unit disk by the concentric map (Shirley and Chiu 1997); density 1/π per unit area.
#[inline]
pub fn disk(u: Vec2) -> Vec2 {
    let o = u * 2.0 - Vec2::ONE;
    let steep = o.x.abs() <= o.y.abs();
    let (r, other) = if steep { (o.y, o.x) } else { (o.x, o.y) };
    if r == 0.0 {
        return Vec2::ZERO;
    }
    let (sin, cos) = small_sin_cos(FRAC_PI_4 * (other / r));
    let (near, far) = (r * cos, r * sin);
    Vec2::new(if steep { far } else { near }, if steep { near } else { far })
}

/// Sine and cosine for |x| ≤ π/4, accurate to an ulp (polynomials of Cephes). Unlike the C library's, the result
/// has the same bits on every machine.
#[inline]
fn small_sin_cos(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = x + x * z * (-1.666_665_5e-1 + z * (8.332_161e-3 - z * 1.951_529_6e-4));
    let cos = 1.0 - 0.5 * z + z * z * (4.166_664_6e-2 + z * (-1.388_731_6e-3 + z * 2.443_315_7e-5));
    (sin, cos)
}

/// Sine and cosine of 2πu for u in 0..=1: a quarter turn at a time.
#[inline]
pub fn circle(u: f32) -> (f32, f32) {
    // Not `floor`, which is a call on machines that are not known to have an instruction for it.
    let quarter = (4.0 * u + 0.5) as u32;
    let (sin, cos) = small_sin_cos(FRAC_PI_2 * (4.0 * u - quarter as f32));
    // By bits, since a processor cannot foresee which quarter it is.
    let (sin, cos) = (sin.to_bits(), cos.to_bits());
    let swapped = (sin ^ cos) & (quarter & 1).wrapping_neg();
    let sign = |quarter: u32| (quarter & 2) << 30;
    (f32::from_bits(sin ^ swapped ^ sign(quarter)), f32::from_bits(cos ^ swapped ^ sign(quarter + 1)))
}

/// A cosine-distributed unit direction around +Z; density cosθ/π per steradian.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = disk(u);
    Vec3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}

/// A uniform unit direction; density 1/(4π) per steradian.
#[inline]
pub fn sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = circle(u.y);
    Vec3::new(r * cos, r * sin, z)
}

/// A uniform unit direction in the cone `cosθ ≥ 1 − one_minus_cos` around +Z; density 1/(2π·one_minus_cos) per
/// steradian. The cone is given by 1 − cos because that keeps its digits for narrow cones.
#[inline]
pub fn cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    cone_with_sine(u, one_minus_cos).0
}

/// The same, and the sine of the direction's angle to +Z.
#[inline]
pub fn cone_with_sine(u: Vec2, one_minus_cos: f32) -> (Vec3, f32) {
    let h = u.x * one_minus_cos;
    let r = (h * (2.0 - h)).max(0.0).sqrt();
    let (sin, cos) = circle(u.y);
    (Vec3::new(r * cos, r * sin, 1.0 - h), r)
}

/// Barycentric coordinates (b1, b2) of a uniform point of a triangle; density 1/area.
#[inline]
pub fn triangle(u: Vec2) -> Vec2 {
    let s = (1.0 - u.x).sqrt();
    Vec2::new(1.0 - s, u.y * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_sin_cos_matches_the_library() {
        for i in -1000..=1000 {
            let x = FRAC_PI_4 * i as f32 / 1000.0;
            let (sin, cos) = small_sin_cos(x);
            let (exact_sin, exact_cos) = f64::from(x).sin_cos();
            assert!((f64::from(sin) - exact_sin).abs() < 1e-7, "{x}");
            assert!((f64::from(cos) - exact_cos).abs() < 1e-7, "{x}");
        }
    }

    #[test]
    fn the_circle_matches_the_library() {
        for i in 0..=4000 {
            let u = i as f32 / 4000.0;
            let (sin, cos) = circle(u);
            let (exact_sin, exact_cos) = (std::f64::consts::TAU * f64::from(u)).sin_cos();
            // Two roundings: of the angle and of the result.
            assert!((f64::from(sin) - exact_sin).abs() < 2e-7, "{u}");
            assert!((f64::from(cos) - exact_cos).abs() < 2e-7, "{u}");
        }
    }

    #[test]
    fn the_disk_is_sampled_uniformly() {
        let n = 256;
        let at = |i: u32| (i as f32 + 0.5) / n as f32;
        let (mut inner, mut right) = (0, 0);
        for i in 0..n * n {
            let p = disk(Vec2::new(at(i % n), at(i / n)));
            assert!(p.length() < 1.0);
            inner += u32::from(p.length_squared() < 0.25);
            right += u32::from(p.x > 0.0);
        }
        assert_eq!((inner, right), (n * n / 4, n * n / 2));
    }
}
