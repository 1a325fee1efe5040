use std::f32::consts::PI;

use super::{DirectSample, Emission};
use crate::math::{Frame, Ray, Rgb, Vec2, Vec3};
use crate::sampling::{Discrete, warp};
use crate::shape::{Analytic, AreaSample, triangle};
use crate::texture::{Param, Textures};

/// The lamp's own copy of its geometry, for sampling.
#[derive(Clone, Debug)]
pub enum Surface {
    Mesh { triangles: Vec<MeshTriangle>, by_area: Discrete },
    Analytic(Analytic),
}

/// World-space triangle with uv; the normal is that of the emitting side.
#[derive(Clone, Copy, Debug)]
pub struct MeshTriangle {
    pub v: [[f32; 3]; 3],
    pub uv: [Vec2; 3],
    pub normal: Vec3,
}

impl Surface {
    pub fn mesh(triangles: Vec<MeshTriangle>) -> Self {
        let by_area =
            Discrete::new(triangles.iter().map(|t| f64::from(triangle::cross_product(&t.v).length()) * 0.5));
        Self::Mesh { triangles, by_area }
    }

    pub fn area(&self) -> f32 {
        match self {
            Self::Mesh { by_area, .. } => by_area.total() as f32,
            Self::Analytic(shape) => shape.area(),
        }
    }

    #[inline(always)]
    fn sample(&self, u: Vec2) -> AreaSample {
        match self {
            Self::Mesh { triangles, by_area } => {
                let (i, rest) = by_area.sample(u.x);
                let t = &triangles[i];
                let b = warp::triangle(Vec2::new(rest, u.y));
                let b0 = 1.0 - b.x - b.y;
                let (v0, v1, v2) = (Vec3::from(t.v[0]), Vec3::from(t.v[1]), Vec3::from(t.v[2]));
                AreaSample {
                    p: v0 * b0 + v1 * b.x + v2 * b.y,
                    n: t.normal,
                    uv: t.uv[0] * b0 + t.uv[1] * b.x + t.uv[2] * b.y,
                }
            }
            Self::Analytic(shape) => shape.sample_area(u),
        }
    }
}

/// A shape that emits from its front side with the same radiance in all directions.
#[derive(Clone, Debug)]
pub struct Area {
    pub surface: Surface,
    pub radiance: Param,
    /// Lift off the surface that rounding needs (see `Scene::offset`).
    pub lift: f32,
    area: f32,
}

impl Area {
    pub fn new(surface: Surface, radiance: Param, lift: f32) -> Self {
        let area = surface.area();
        Self { surface, radiance, lift, area }
    }

    #[inline(always)]
    pub fn sample_direct(&self, textures: &Textures, p: Vec3, u: Vec2) -> Option<DirectSample> {
        if let Some((sphere, gap)) = self.visible_cone(p) {
            return self.sample_cone(textures, p, sphere, gap, u);
        }
        let s = self.surface.sample(u);
        let d = s.p - p;
        let d2 = d.length_squared();
        let dir = d / d2.sqrt();
        let cos = -dir.dot(s.n);
        if !(cos > 0.0 && d2 > 0.0) {
            return None;
        }
        let pdf = d2 / (cos * self.area);
        let value = textures.eval(self.radiance, s.uv) / pdf;
        Some(DirectSample { dir, target: Some(s.p + s.n * self.lift), value, pdf })
    }

    /// A sphere seen from outside is sampled within its cone: no sample is wasted on its far side.
    #[inline]
    fn visible_cone(&self, p: Vec3) -> Option<(&crate::shape::Sphere, f32)> {
        match &self.surface {
            Surface::Analytic(Analytic::Sphere(s)) if !s.inward => s.cone(p).map(|gap| (s, gap)),
            _ => None,
        }
    }

    #[inline(never)]
    fn sample_cone(
        &self,
        textures: &Textures,
        p: Vec3,
        sphere: &crate::shape::Sphere,
        gap: f32,
        u: Vec2,
    ) -> Option<DirectSample> {
        let axis = Frame::from_normal((sphere.center - p).normalize());
        let dir = axis.to_world(warp::cone(u, gap));
        // A direction on the cone's rim may miss by rounding; the point nearest to it then serves.
        let ray = Ray::new(p, dir);
        let t = sphere.intersect(&ray, f32::INFINITY).unwrap_or_else(|| (sphere.center - p).dot(dir));
        let local = sphere.local(ray.at(t));
        let pdf = 1.0 / (2.0 * PI * gap);
        let value = textures.eval(self.radiance, local.uv) / pdf;
        Some(DirectSample { dir, target: Some(local.p + local.n * self.lift), value, pdf })
    }

    /// Density with which [`Area::sample_direct`] chooses the point `q` with geometric normal `n` seen
    /// from `p` along the unit direction `dir`.
    #[inline]
    pub fn pdf_direct(&self, p: Vec3, dir: Vec3, q: Vec3, n: Vec3) -> f32 {
        if let Some((_, gap)) = self.visible_cone(p) {
            return 1.0 / (2.0 * PI * gap);
        }
        let cos = dir.dot(n).abs();
        if cos > 0.0 { (q - p).length_squared() / (cos * self.area) } else { 0.0 }
    }

    pub fn sample_emission(&self, textures: &Textures, place: Vec2, direction: Vec2) -> Option<Emission> {
        let s = self.surface.sample(place);
        let d = Frame::from_normal(s.n).to_world(warp::cosine_hemisphere(direction));
        let flux = textures.eval(self.radiance, s.uv) * (PI * self.area);
        (flux.max_element() > 0.0).then_some(Emission { o: s.p + s.n * self.lift, d, flux })
    }

    pub fn power(&self, textures: &Textures) -> Rgb {
        textures.mean(self.radiance) * (PI * self.area)
    }

    /// World area in square scene units.
    pub fn area(&self) -> f32 {
        self.area
    }
}
