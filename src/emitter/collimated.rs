use std::ops::Range;

use super::area::site;
use super::{DirectSample, Emission, EmissionBounds, Light, MeshTriangle, SceneSphere, Surface};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::{Density, Discrete};
use crate::shape::triangle;
use crate::texture::{OnMesh, Param, Site, Textures};

/// A flat-faced lamp that shines along its normals only (Mitsuba's `directionalarea`): each face sends
/// `radiance` W/m² straight ahead. No scattered ray can find that direction, but a point within a face's
/// beam knows it.
#[derive(Clone, Debug)]
pub struct Collimated {
    triangles: Vec<MeshTriangle>,
    by_area: Discrete,
    /// Runs of triangles with the same normal (and so the same direction), and their areas.
    faces: Vec<Range<usize>>,
    faces_by_area: Discrete,
    radiance: Param,
    lift: f32,
}

impl Collimated {
    /// Neighbouring triangles with the same normal become one face. `lift` is how far samples start off the surface.
    pub fn new(triangles: Vec<MeshTriangle>, radiance: Param, lift: f32) -> Self {
        let area = |t: &MeshTriangle| f64::from(triangle::cross_product(&t.v).length()) * 0.5;
        let by_area = Discrete::new(triangles.iter().map(area));
        let mut faces: Vec<Range<usize>> = Vec::new();
        for (i, t) in triangles.iter().enumerate() {
            match faces.last_mut() {
                Some(face) if triangles[face.start].normal.dot(t.normal) > PARALLEL => face.end = i + 1,
                _ => faces.push(i..i + 1),
            }
        }
        let areas = faces.iter().map(|f| triangles[f.clone()].iter().map(area).sum::<f64>());
        Self { faces_by_area: Discrete::new(areas), faces, by_area, triangles, radiance, lift }
    }

    /// World area in square scene units.
    pub fn area(&self) -> f32 {
        self.by_area.total() as f32
    }
}

impl Light for Collimated {
    /// One of the faces: its beam either holds `p` or not.
    fn sample_direct(&self, textures: &Textures, p: Vec3, u: Vec2) -> Option<DirectSample> {
        let (i, _) = self.faces_by_area.sample(u.x);
        let (t, b) = self.triangles[self.faces[i].clone()].iter().find_map(|t| Some((t, below(t, p)?)))?;
        let b0 = 1.0 - b.x - b.y;
        let [v0, v1, v2] = t.v.map(Vec3::from);
        let uv = t.uv[0] * b0 + t.uv[1] * b.x + t.uv[2] * b.y;
        let at = Site { uv, p: v0 * b0 + v1 * b.x + v2 * b.y, n: t.normal, on: OnMesh::NONE };
        let value = textures.eval(self.radiance, &at) / self.faces_by_area.probability(i);
        let target = Some(at.p + t.normal * self.lift);
        (value.max_element() > 0.0).then_some(DirectSample { dir: -t.normal, target, value, pdf: 0.0 })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        _bounds: &EmissionBounds<'_>,
        place: Vec2,
        _direction: Vec2,
    ) -> Option<Emission> {
        let s = Surface::sample_triangles(&self.triangles, &self.by_area, place);
        let flux = textures.eval(self.radiance, &site(&s)) * self.area();
        (flux.max_element() > 0.0).then_some(Emission {
            o: s.p + s.n * self.lift,
            d: s.n,
            cos: 1.0,
            flux,
            position: Density::Finite(1.0 / self.area()),
            direction: Density::Delta,
            weight: 1.0,
        })
    }

    fn power(&self, textures: &Textures, _scene: &SceneSphere) -> Color {
        textures.mean(self.radiance) * self.area()
    }
}

/// Normals closer than this (a milliradian) are the same.
const PARALLEL: f32 = 1.0 - 1e-6;

/// Barycentric place (b1, b2) on the triangle from which its beam meets `p`.
fn below(t: &MeshTriangle, p: Vec3) -> Option<Vec2> {
    let [v0, v1, v2] = t.v.map(Vec3::from);
    let (e1, e2, d) = (v1 - v0, v2 - v0, p - v0);
    let n = e1.cross(e2);
    let b = Vec2::new(d.cross(e2).dot(n), e1.cross(d).dot(n)) / n.length_squared();
    let inside = d.dot(t.normal) > 0.0 && b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.0;
    inside.then_some(b)
}
