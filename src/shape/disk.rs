use std::f32::consts::PI;

use super::{AreaSample, Local, Shape};
use crate::math::{Bounds, DVec3, Ray, Vec2, Vec3};
use crate::sampling::warp;

/// Flat ellipse `center + x·u + y·v`, x² + y² ≤ 1. Its plane is met in f64, so that a point of a vast disk
/// is as precise as those of what stands on it.
#[derive(Clone, Debug)]
pub struct Disk {
    /// In world space.
    pub center: DVec3,
    /// From the centre to the rim; uv begin here.
    pub u: Vec3,
    /// The other half-axis.
    pub v: Vec3,
    /// Unit normal of the side that faces local +Z (or −Z when flipped).
    pub normal: Vec3,
    /// Dual basis: `x = du·(p − center)`, `y = dv·(p − center)`.
    pub du: Vec3,
    /// See `du`.
    pub dv: Vec3,
}

impl Disk {
    /// From the half-axes and the unit normal of the front side.
    pub fn new(center: DVec3, u: Vec3, v: Vec3, normal: Vec3) -> Self {
        let n = u.cross(v);
        let inv = 1.0 / n.length_squared();
        Self { center, u, v, normal, du: v.cross(n) * inv, dv: n.cross(u) * inv }
    }

    fn coordinates(&self, p: Vec3) -> Vec2 {
        let d = (p.as_dvec3() - self.center).as_vec3a();
        Vec2::new(self.du.dot(d), self.dv.dot(d))
    }
}

impl Shape for Disk {
    fn intersect(&self, ray: &Ray, tmax: f32) -> Option<f32> {
        let n = self.normal.as_dvec3();
        let t = (n.dot(self.center - ray.o.as_dvec3()) / n.dot(ray.d.as_dvec3())) as f32;
        (t > 0.0 && t < tmax && self.coordinates(ray.at(t)).length_squared() <= 1.0).then_some(t)
    }

    fn local(&self, p: Vec3) -> Local {
        let n = self.normal.as_dvec3();
        let above = n.dot(p.as_dvec3() - self.center);
        Local { p: (p.as_dvec3() - n * above).as_vec3a(), n: self.normal }
    }

    fn uv(&self, p: Vec3) -> Vec2 {
        let c = self.coordinates(p);
        let phi = c.y.atan2(c.x) / (2.0 * PI);
        Vec2::new(c.length(), if phi < 0.0 { phi + 1.0 } else { phi })
    }

    fn partials(&self, p: Vec3) -> [Vec3; 2] {
        let c = self.coordinates(p);
        let d = c.normalize_or(Vec2::X);
        [self.u * d.x + self.v * d.y, (self.v * c.x - self.u * c.y) * (2.0 * PI)]
    }

    fn area(&self) -> f32 {
        PI * self.u.cross(self.v).length()
    }

    fn sample_area(&self, u: Vec2) -> AreaSample {
        let d = warp::disk(u);
        let local = self.local((self.center + (self.u * d.x + self.v * d.y).as_dvec3()).as_vec3a());
        AreaSample { p: local.p, n: local.n, uv: self.uv(local.p) }
    }

    fn magnitude(&self, p: Vec3) -> f32 {
        // Of the plane of a vast one, single precision keeps what it does of the point itself.
        p.abs().max_element()
    }

    fn bounds(&self) -> Bounds {
        let e = (self.u * self.u + self.v * self.v).map(f32::sqrt);
        let center = self.center.as_vec3a();
        Bounds { min: center - e, max: center + e }
    }
}
