use std::f32::consts::PI;

use super::{AreaSample, Local};
use crate::math::{Frame, Ray, Vec2, Vec3};
use crate::sampling::warp;

/// World-space sphere. Quadratics are solved in f64: f32 loses small spheres far away.
#[derive(Clone, Debug)]
pub struct Sphere {
    pub center: Vec3,
    pub radius: f32,
    /// Rows take a world direction to object space, for uv.
    pub to_object: Frame,
    /// Normals point inwards (flipped, or placed by a mirroring transform).
    pub inward: bool,
}

impl Sphere {
    pub fn intersect(&self, ray: &Ray, tmax: f32) -> Option<f32> {
        let o = ray.o.as_dvec3() - self.center.as_dvec3();
        let d = ray.d.as_dvec3();
        let r = f64::from(self.radius);
        let a = d.length_squared();
        // Distance of closest approach measured from that point, not from the origin: no cancellation.
        let tc = -o.dot(d) / a;
        let gap = r * r - (o + d * tc).length_squared();
        if gap < 0.0 {
            return None;
        }
        let h = (gap / a).sqrt();
        let inside = |t: f64| t > 0.0 && t < f64::from(tmax);
        [tc - h, tc + h].into_iter().find(|&t| inside(t)).map(|t| t as f32)
    }

    pub fn local(&self, p: Vec3) -> Local {
        // In f64: the point of a large ball is known as well as that of a small one beside it.
        let center = self.center.as_dvec3();
        let outward = (p.as_dvec3() - center).normalize();
        let n = outward.as_vec3a();
        let o = self.to_object.to_local(n);
        let u = o.y.atan2(o.x) / (2.0 * PI);
        Local {
            p: (center + outward * f64::from(self.radius)).as_vec3a(),
            n: if self.inward { -n } else { n },
            uv: Vec2::new(if u < 0.0 { u + 1.0 } else { u }, o.z.clamp(-1.0, 1.0).acos() / PI),
        }
    }

    pub fn partials(&self, p: Vec3) -> [Vec3; 2] {
        let o = self.to_object.to_local((p - self.center).normalize());
        let r = (o.x * o.x + o.y * o.y).sqrt();
        let (cos, sin) = if r > 0.0 { (o.x / r, o.y / r) } else { (1.0, 0.0) };
        let du = Vec3::new(-o.y, o.x, 0.0) * (2.0 * PI * self.radius);
        let dv = Vec3::new(o.z * cos, o.z * sin, -r) * (PI * self.radius);
        [self.to_object.to_world(du), self.to_object.to_world(dv)]
    }

    pub fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }

    pub fn sample_area(&self, u: Vec2) -> AreaSample {
        let local = self.local(self.center + warp::sphere(u) * self.radius);
        AreaSample { p: local.p, n: local.n, uv: local.uv }
    }

    /// 1 − cos of the half-angle under which the sphere is seen from `p`; `None` inside or on it.
    pub fn cone(&self, p: Vec3) -> Option<f32> {
        let d2 = (self.center - p).length_squared();
        let sin2 = self.radius * self.radius / d2;
        (sin2 < 0.9999).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }
}
