use std::f32::consts::PI;

use super::{AreaSample, Local, Shape};
use crate::math::{Bounds, Frame, Ray, Vec2, Vec3};

/// Open circular cylinder along `axis.n` from `p0`.
#[derive(Clone, Debug)]
pub struct Cylinder {
    /// Middle of the circle at v = 0.
    pub p0: Vec3,
    /// `n` is the axis; u begins at `s`.
    pub axis: Frame,
    /// In world units.
    pub length: f32,
    /// In world units.
    pub radius: f32,
    /// Normals point at the axis.
    pub inward: bool,
}

impl Shape for Cylinder {
    fn intersect(&self, ray: &Ray, tmax: f32) -> Option<f32> {
        let o = self.axis.to_local(ray.o - self.p0).as_dvec3();
        let d = self.axis.to_local(ray.d).as_dvec3();
        let (o2, d2) = (o.truncate(), d.truncate());
        let a = d2.length_squared();
        if a == 0.0 {
            return None;
        }
        let tc = -o2.dot(d2) / a;
        let gap = f64::from(self.radius).powi(2) - (o2 + d2 * tc).length_squared();
        if gap < 0.0 {
            return None;
        }
        let h = (gap / a).sqrt();
        [tc - h, tc + h]
            .into_iter()
            .find(|&t| {
                let z = o.z + t * d.z;
                t > 0.0 && t < f64::from(tmax) && z >= 0.0 && z <= f64::from(self.length)
            })
            .map(|t| t as f32)
    }

    fn local(&self, p: Vec3) -> Local {
        let l = self.axis.to_local(p - self.p0);
        let phi = l.y.atan2(l.x);
        let z = l.z.clamp(0.0, self.length);
        let n = self.axis.to_world(Vec3::new(phi.cos(), phi.sin(), 0.0));
        Local { p: self.p0 + self.axis.n * z + n * self.radius, n: if self.inward { -n } else { n } }
    }

    fn uv(&self, p: Vec3) -> Vec2 {
        let l = self.axis.to_local(p - self.p0);
        let u = l.y.atan2(l.x) / (2.0 * PI);
        Vec2::new(if u < 0.0 { u + 1.0 } else { u }, l.z.clamp(0.0, self.length) / self.length)
    }

    fn partials(&self, p: Vec3) -> [Vec3; 2] {
        let l = self.axis.to_local(p - self.p0);
        let du = Vec3::new(-l.y, l.x, 0.0) * (2.0 * PI);
        [self.axis.to_world(du), self.axis.n * self.length]
    }

    fn area(&self) -> f32 {
        2.0 * PI * self.radius * self.length
    }

    fn sample_area(&self, u: Vec2) -> AreaSample {
        let (sin, cos) = (2.0 * PI * u.x).sin_cos();
        let p =
            self.p0 + self.axis.to_world(Vec3::new(cos * self.radius, sin * self.radius, u.y * self.length));
        let local = self.local(p);
        AreaSample { p: local.p, n: local.n, uv: self.uv(local.p) }
    }

    fn magnitude(&self, _p: Vec3) -> f32 {
        self.bounds().magnitude()
    }

    fn bounds(&self) -> Bounds {
        let n = self.axis.n;
        let e = (Vec3::ONE - n * n).max(Vec3::ZERO).map(f32::sqrt) * self.radius;
        let p1 = self.p0 + n * self.length;
        Bounds { min: self.p0.min(p1) - e, max: self.p0.max(p1) + e }
    }
}
