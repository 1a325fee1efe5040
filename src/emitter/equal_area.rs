//! The equal-area map between the unit square and the sphere through an octahedron (Clarberg 2008), with
//! +Z in the middle of the square and −Z in its corners.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_4};

use crate::math::{Vec2, Vec3};

/// Unit direction of a point of the unit square.
pub fn to_direction(u: Vec2) -> Vec3 {
    let p = u * 2.0 - Vec2::ONE;
    let (ax, ay) = (p.x.abs(), p.y.abs());
    // Signed distance from the diamond that holds the upper half.
    let inside = 1.0 - (ax + ay);
    let r = 1.0 - inside.abs();
    let phi = if r == 0.0 { 1.0 } else { (ay - ax) / r + 1.0 } * FRAC_PI_4;
    let (sin, cos) = phi.sin_cos();
    let flat = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new((flat * cos).copysign(p.x), (flat * sin).copysign(p.y), (1.0 - r * r).copysign(inside))
}

/// Of a unit vector.
pub fn to_square(d: Vec3) -> Vec2 {
    let (ax, ay) = (d.x.abs(), d.y.abs());
    // √(1 − |z|) without cancellation near the poles.
    let r = ((ax * ax + ay * ay) / (1.0 + d.z.abs())).sqrt();
    let share = ay.atan2(ax) * FRAC_2_PI;
    let (mut x, mut y) = (r * (1.0 - share), r * share);
    if d.z < 0.0 {
        (x, y) = (1.0 - y, 1.0 - x);
    }
    Vec2::new(x.copysign(d.x), y.copysign(d.y)) * 0.5 + Vec2::splat(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::warp;

    #[test]
    fn the_two_maps_undo_each_other() {
        for i in 0..64 {
            for j in 0..64 {
                let d = warp::sphere(Vec2::new((i as f32 + 0.3) / 64.0, (j as f32 + 0.7) / 64.0));
                assert!((to_direction(to_square(d)) - d).length() < 2e-6, "{d}");
            }
        }
        assert_eq!(to_direction(Vec2::splat(0.5)), Vec3::Z);
        assert!((to_direction(Vec2::new(1.0, 0.5)) - Vec3::X).length() < 1e-6);
        assert!((to_direction(Vec2::new(0.5, 1.0)) - Vec3::Y).length() < 1e-6);
        assert!((to_direction(Vec2::ZERO) + Vec3::Z).length() < 1e-6);
    }

    /// Equal area: z is uniform in [−1, 1], so its mean is 0 and that of z² is 1/3; so are those of x, y.
    /// A regular grid of n² points misses integrals of functions with kinks by less than 1/n.
    #[test]
    fn areas_are_kept() {
        let n = 128;
        let mut square = Vec3::ZERO;
        for i in 0..n * n {
            let at = |k: i32| (k as f32 + 0.5) / n as f32;
            let d = to_direction(Vec2::new(at(i % n), at(i / n)));
            square += d * d / (n * n) as f32;
        }
        assert!((square - Vec3::splat(1.0 / 3.0)).abs().max_element() < 1e-3, "{square}");
    }
}
