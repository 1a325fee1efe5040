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

    /// How the sphere looks from `p`; `None` inside or on it.
    #[inline]
    pub fn cone(&self, p: Vec3) -> Option<Cone> {
        let middle = self.center - p.as_dvec3();
        let sin2 = (self.radius * self.radius / middle.length_squared()) as f32;
        let cos = (1.0 - sin2).sqrt();
        (sin2 > 0.0 && sin2 < 0.9999).then(|| Cone {
            middle: middle.as_vec3a(),
            sin2,
            gap: sin2 / (1.0 + cos),
        })
    }

    /// A direction within the cone of the sphere, even over its solid angle, and the point that is seen there.
    #[inline]
    pub fn sample_cone(&self, cone: &Cone, u: Vec2) -> (Vec3, Local) {
        let axis = Frame::from_normal(cone.middle.normalize());
        let (w, sin) = warp::cone_with_sine(u, cone.gap);
        // In the triangle of the viewer, the point and the middle: sine and cosine of the angle at the point, by the
        // law of sines; then of that at the middle, over the sine of that at the viewer. Nothing cancels.
        let inverse = 1.0 / cone.sin2.sqrt();
        let sin_point = (sin * inverse).min(1.0);
        let cos_point = (1.0 - sin_point * sin_point).max(0.0).sqrt();
        let across = w.z * inverse - cos_point;
        let outward =
            axis.to_world(Vec3::new(w.x * across, w.y * across, -(cos_point * w.z + sin_point * sin)));
        let n = if self.inward { -outward } else { outward };
        let p = (self.center + outward.as_dvec3() * self.radius).as_vec3a();
        (axis.to_world(w), Local { p, n })
    }
}

/// A sphere as it looks from a point outside.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// From the point to the middle.
    middle: Vec3,
    /// Squared sine of the half-angle.
    sin2: f32,
    /// 1 − its cosine.
    pub gap: f32,
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
