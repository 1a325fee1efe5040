//! Warps of the unit square; each states its density.

use std::f32::consts::{FRAC_PI_4, PI};

use crate::math::{Vec2, Vec3};

/// Concentric map to the unit disk (Shirley and Chiu 1997); density 1/π per area.
#[inline]
pub fn disk(u: Vec2) -> Vec2 {
    let o = u * 2.0 - Vec2::ONE;
    if o == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, phi) = if o.x.abs() > o.y.abs() {
        (o.x, FRAC_PI_4 * (o.y / o.x))
    } else {
        (o.y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (o.x / o.y))
    };
    let (sin, cos) = phi.sin_cos();
    Vec2::new(r * cos, r * sin)
}

/// Cosine-weighted direction around +Z; density cosθ/π per solid angle.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = disk(u);
    Vec3::new(d.x, d.y, (1.0 - d.length_squared()).max(0.0).sqrt())
}

/// Uniform direction; density 1/(4π).
#[inline]
pub fn sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}

/// Uniform direction in the cone `cosθ ≥ 1 − one_minus_cos` around +Z; density 1/(2π·one_minus_cos).
/// Taking 1 − cos keeps precision for narrow cones.
#[inline]
pub fn cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let h = u.x * one_minus_cos;
    let r = (h * (2.0 - h)).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, 1.0 - h)
}

/// Uniform barycentric coordinates (b1, b2) in a triangle.
#[inline]
pub fn triangle(u: Vec2) -> Vec2 {
    let s = (1.0 - u.x).sqrt();
    Vec2::new(1.0 - s, u.y * s)
}
