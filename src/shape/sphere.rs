use std::f32::consts::PI;

use super::{AreaSample, Local, Shape};
use crate::math::{Bounds, DVec3, Frame, Ray, Vec2, Vec3};
use crate::sampling::warp;

/// World-space sphere. In f64: f32 loses small spheres far away, and where large ones begin.
#[derive(Clone, Debug)]
pub struct Sphere {
    /// In world space.
    pub center: DVec3,
    /// In world units.
    pub radius: f64,
    /// Rows take a world direction to object space, for uv.
    pub to_object: Frame,
    /// Normals point inwards (flipped, or placed by a mirroring transform).
    pub inward: bool,
}

impl Sphere {
    /// The point of the sphere in the unit direction `outward` from its middle.
    fn towards(&self, outward: DVec3) -> Local {
        let n = outward.as_vec3a();
        Local { p: (self.center + outward * self.radius).as_vec3a(), n: if self.inward { -n } else { n } }
    }

    /// From `p` to the middle.
    pub fn middle_from(&self, p: Vec3) -> Vec3 {
        (self.center - p.as_dvec3()).as_vec3a()
    }

    /// 1 − cos of the half-angle under which the sphere is seen from `p`; `None` inside or on it.
    pub fn cone(&self, p: Vec3) -> Option<f32> {
        let d2 = (self.center - p.as_dvec3()).length_squared();
        let sin2 = (self.radius * self.radius / d2) as f32;
        (sin2 < 0.9999).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }
}

impl Shape for Sphere {
    fn intersect(&self, ray: &Ray, tmax: f32) -> Option<f32> {
        let o = ray.o.as_dvec3() - self.center;
        let d = ray.d.as_dvec3();
        let a = d.length_squared();
        // Distance of closest approach measured from that point, not from the origin: no cancellation.
        let tc = -o.dot(d) / a;
        let gap = self.radius * self.radius - (o + d * tc).length_squared();
        if gap < 0.0 {
            return None;
        }
        let h = (gap / a).sqrt();
        let inside = |t: f64| t > 0.0 && t < f64::from(tmax);
        [tc - h, tc + h].into_iter().find(|&t| inside(t)).map(|t| t as f32)
    }

    fn local(&self, p: Vec3) -> Local {
        self.towards((p.as_dvec3() - self.center).normalize())
    }

    fn uv(&self, p: Vec3) -> Vec2 {
        let o = self.to_object.to_local((p.as_dvec3() - self.center).normalize().as_vec3a());
        let u = o.y.atan2(o.x) / (2.0 * PI);
        Vec2::new(if u < 0.0 { u + 1.0 } else { u }, o.z.clamp(-1.0, 1.0).acos() / PI)
    }

    fn partials(&self, p: Vec3) -> [Vec3; 2] {
        let o = self.to_object.to_local((p.as_dvec3() - self.center).normalize().as_vec3a());
        let r = (o.x * o.x + o.y * o.y).sqrt();
        let (cos, sin) = if r > 0.0 { (o.x / r, o.y / r) } else { (1.0, 0.0) };
        let du = Vec3::new(-o.y, o.x, 0.0) * (2.0 * PI * self.radius as f32);
        let dv = Vec3::new(o.z * cos, o.z * sin, -r) * (PI * self.radius as f32);
        [self.to_object.to_world(du), self.to_object.to_world(dv)]
    }

    fn area(&self) -> f32 {
        4.0 * PI * (self.radius * self.radius) as f32
    }

    fn sample_area(&self, u: Vec2) -> AreaSample {
        let local = self.towards(warp::sphere(u).as_dvec3().normalize());
        AreaSample { p: local.p, n: local.n, uv: self.uv(local.p) }
    }

    fn magnitude(&self, p: Vec3) -> f32 {
        // What its f64 loses of the radius, in roundings of f32.
        p.abs().max_element() + (self.radius * 2f64.powi(-29)) as f32
    }

    fn bounds(&self) -> Bounds {
        let r = DVec3::splat(self.radius);
        Bounds { min: (self.center - r).as_vec3a(), max: (self.center + r).as_vec3a() }
    }
}
