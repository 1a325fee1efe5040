//! Rays side by side, for tests of many rays against one shape.

use super::Sphere;
use crate::math::simd::Wide;
use crate::math::{LIFT, Ray};

/// Rays, one in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Lines<const N: usize, W: Wide<N>> {
    pub(super) o: [W; 3],
    pub(super) d: [W; 3],
    pub(super) tmax: W,
}

/// Below this squared length of a direction, products lose digits.
const SHORT: f32 = 1e-30;

impl<const N: usize, W: Wide<N>> Lines<N, W> {
    /// Unused lanes must repeat a ray.
    #[inline(always)]
    pub fn new(rays: [&Ray; N], isa: W::Isa) -> Self {
        let (mut o, mut d, mut tmax) = ([[0.0; N]; 3], [[0.0; N]; 3], [0.0; N]);
        for (lane, ray) in rays.into_iter().enumerate() {
            let (from, along) = (ray.o.to_array(), ray.d.to_array());
            for axis in 0..3 {
                o[axis][lane] = from[axis];
                d[axis][lane] = along[axis];
            }
            tmax[lane] = ray.tmax;
        }
        Self {
            o: [W::load(isa, &o[0]), W::load(isa, &o[1]), W::load(isa, &o[2])],
            d: [W::load(isa, &d[0]), W::load(isa, &d[1]), W::load(isa, &d[2])],
            tmax: W::load(isa, &tmax),
        }
    }

    /// The rays, as bits, that come so near to the sphere that they may meet it: none that does is missing.
    #[inline(always)]
    pub fn near(&self, sphere: &Sphere) -> u32 {
        let isa = self.tmax.isa();
        let zero = W::splat(isa, 0.0);
        let [cx, cy, cz] = sphere.center.as_vec3().to_array();
        let o = [self.o[0] - W::splat(isa, cx), self.o[1] - W::splat(isa, cy), self.o[2] - W::splat(isa, cz)];
        let d = self.d;
        let toward = zero - (o[0] * d[0] + o[1] * d[1] + o[2] * d[2]);
        let length2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        // The nearest point of the segment. What is not a number stays so, and counts as near.
        let t = toward / length2;
        let t = zero.select(t.less(zero), t);
        let t = self.tmax.select(self.tmax.less(t), t);
        let p = [o[0] + d[0] * t, o[1] + d[1] * t, o[2] + d[2] * t];
        let distance2 = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
        // The error of the distance is below nine roundings of the numbers it was made from; 32 are allowed.
        let size = |x: W| x.max(zero - x);
        let from = size(self.o[0]) + size(self.o[1]) + size(self.o[2]);
        let radius = sphere.radius as f32;
        let own = radius + (cx.abs() + cy.abs() + cz.abs() + radius) * LIFT;
        let reach = W::splat(isa, own) + from * W::splat(isa, LIFT);
        let far = (reach * reach).less(distance2);
        W::bits(W::and_not(W::and(far, W::splat(isa, SHORT).less(length2)), zero.equal(zero)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd::{Portable, WIDTH};
    use crate::math::{Frame, Vec3};
    use crate::sampling::{CounterRng, warp};
    use crate::shape::Shape;

    /// Every ray that meets a sphere is named, at any scale, and few that miss it widely are.
    #[test]
    fn no_ray_that_meets_the_sphere_is_missing() {
        let mut rng = CounterRng::new(7, 0);
        let mut unit = || warp::sphere(rng.next_2d().into());
        let scales = [1e-12f32, 1e-3, 1.0, 1e4, 1e12];
        for (i, scale) in scales.iter().cycle().take(20_000).enumerate() {
            let center = unit() * *scale;
            let radius = scale * [1e-4, 0.1, 1.0, 10.0][i / 5 % 4];
            let sphere = Sphere {
                center: center.as_dvec3(),
                radius: f64::from(radius),
                to_object: Frame::from_normal(Vec3::Z),
                inward: false,
            };
            let rays: [Ray; WIDTH] = std::array::from_fn(|l| {
                let o = center + unit() * radius * [0.5, 1.0, 1.0001, 2.0][l % 4];
                // Aimed at the rim and beyond; every other ray ends near the sphere.
                let d = center + unit() * radius * 1.0002 - o;
                let tmax = if l < 4 { f32::INFINITY } else { 1.0 };
                Ray { o, d, tmax }
            });
            let near = Lines::<WIDTH, Portable>::new(std::array::from_fn(|l| &rays[l]), ()).near(&sphere);
            for (l, ray) in rays.iter().enumerate() {
                let meets = sphere.intersect(ray, ray.tmax).is_some();
                assert!(!meets || near >> l & 1 == 1, "{scale} {radius} {ray:?}");
            }
            let away = Ray::new(center + Vec3::X * radius * 3.0, Vec3::X * *scale);
            let clear = Lines::<WIDTH, Portable>::new([&away; WIDTH], ()).near(&sphere);
            assert!(*scale < 1e-9 || clear == 0 || radius < scale * 0.01, "{scale} {radius}");
        }
    }
}
