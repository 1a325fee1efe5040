use std::f32::consts::PI;

use super::table::Table;
use super::{DirectSample, Emission, EmissionBounds, Light, SceneSphere};
use crate::math::{Color, Frame, LIFT, Vec2, Vec3};
use crate::sampling::{Density, Discrete, warp};
use crate::shape::{Analytic, AreaSample, Cone, Shape, Sphere, triangle};
use crate::spectrum::luminance;
use crate::texture::{OnMesh, Param, Site, Textures};

/// The lamp's own copy of its geometry, for sampling.
#[derive(Clone, Debug)]
pub enum Surface {
    /// A mesh.
    Mesh {
        /// In world space.
        triangles: Vec<MeshTriangle>,
        /// Chooses a triangle by its area.
        by_area: Discrete,
    },
    /// A sphere, disk or cylinder, chosen from evenly.
    Analytic(Analytic),
}

/// World-space triangle with uv; the normal is that of the emitting side.
#[derive(Clone, Copy, Debug)]
pub struct MeshTriangle {
    /// Corners.
    pub v: [[f32; 3]; 3],
    /// Texture coordinates of the corners.
    pub uv: [Vec2; 3],
    /// Unit.
    pub normal: Vec3,
}

impl Surface {
    /// From world-space triangles; triangles without area are never chosen.
    pub fn mesh(triangles: Vec<MeshTriangle>) -> Self {
        let by_area =
            Discrete::new(triangles.iter().map(|t| f64::from(triangle::cross_product(&t.v).length()) * 0.5));
        Self::Mesh { triangles, by_area }
    }

    /// World area in square scene units.
    pub fn area(&self) -> f32 {
        match self {
            Self::Mesh { by_area, .. } => by_area.total() as f32,
            Self::Analytic(shape) => shape.area(),
        }
    }

    #[inline(always)]
    fn sample(&self, u: Vec2) -> AreaSample {
        match self {
            Self::Mesh { triangles, by_area } => Self::sample_triangles(triangles, by_area, u),
            Self::Analytic(shape) => shape.sample_area(u),
        }
    }

    /// Uniform over triangles that `by_area` weighs.
    #[inline(always)]
    pub(super) fn sample_triangles(triangles: &[MeshTriangle], by_area: &Discrete, u: Vec2) -> AreaSample {
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
}

/// What textures want to know of a sample.
pub(super) fn site(s: &AreaSample) -> Site {
    Site { uv: s.uv, p: s.p, n: s.n, on: OnMesh::NONE }
}

/// Which sides of a lamp shine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Only the side that the normals point to.
    Front,
    /// Both sides, with the same radiance.
    Both,
}

/// A shape that emits the same radiance in all directions of a side.
#[derive(Clone, Debug)]
pub struct Area {
    /// Where it shines from.
    pub surface: Surface,
    /// W/(m²·sr).
    pub radiance: Param,
    /// Which sides shine.
    pub sides: Sides,
    /// Lift off the surface that rounding needs (see `Scene::offset`).
    pub lift: f32,
    area: f32,
    /// Where photons of a textured lamp start, in the square that [`Surface::sample`] maps to it.
    places: Option<Places>,
    /// Mean radiance over the surface.
    mean: Color,
}

/// Cells of the sampling square by their light.
#[derive(Clone, Debug)]
struct Places {
    table: Table,
    weights: Vec<f32>,
}

/// Cells on a side of the sampling square, and places that are looked at in each, on a side.
const CELLS: usize = 64;
const LOOKS: usize = 2;
/// Least weight of a cell against the mean: light that the looks missed costs noise, never bias.
const FLOOR: f32 = 0.1;

impl Area {
    /// Surveys a textured `radiance` over the surface, so that photons start where it is bright.
    pub fn new(surface: Surface, radiance: Param, sides: Sides, lift: f32, textures: &Textures) -> Self {
        let area = surface.area();
        let (mean, places) = match radiance {
            Param::Constant(c) => (c, None),
            Param::Texture(_) if area > 0.0 => survey(&surface, radiance, textures),
            Param::Texture(_) => (Color::ZERO, None),
        };
        Self { surface, radiance, sides, lift, area, places, mean }
    }

    /// The end of a shadow ray from `p` to the point `q` of the lamp: clear of it by the roundings of both.
    #[inline(always)]
    fn above(&self, q: Vec3, n: Vec3, p: Vec3) -> Vec3 {
        q + n * self.lift.max(p.abs().max_element() * LIFT)
    }

    /// A sphere seen from outside is sampled within its cone: no sample is wasted on its far side.
    #[inline]
    fn visible_cone(&self, p: Vec3) -> Option<(&Sphere, Cone)> {
        match &self.surface {
            Surface::Analytic(Analytic::Sphere(s)) if !s.inward || self.sides == Sides::Both => {
                s.cone(p).map(|cone| (s, cone))
            }
            _ => None,
        }
    }

    #[inline(always)]
    fn sample_cone(
        &self,
        textures: &Textures,
        p: Vec3,
        sphere: &Sphere,
        cone: &Cone,
        u: Vec2,
    ) -> Option<DirectSample> {
        let (dir, local) = sphere.sample_cone(cone, u);
        let pdf = 1.0 / (2.0 * PI * cone.gap);
        let radiance = match self.radiance {
            Param::Constant(c) => c,
            Param::Texture(_) => {
                let uv = sphere.uv(local.p);
                textures.eval(self.radiance, &Site { uv, p: local.p, n: local.n, on: OnMesh::NONE })
            }
        };
        let value = radiance * (2.0 * PI * cone.gap);
        let n = if sphere.inward { -local.n } else { local.n };
        Some(DirectSample { dir, target: Some(self.above(local.p, n, p)), value, pdf })
    }

    /// World area in square scene units.
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Power in W per lane: exact but for textures, whose mean over the surface is sampled.
    pub fn flux(&self) -> Color {
        let sides = if self.sides == Sides::Both { 2.0 } else { 1.0 };
        self.mean * (sides * PI * self.area)
    }
}

impl Light for Area {
    #[inline(always)]
    fn sample_direct(&self, textures: &Textures, p: Vec3, u: Vec2) -> Option<DirectSample> {
        if let Some((sphere, cone)) = self.visible_cone(p) {
            return self.sample_cone(textures, p, sphere, &cone, u);
        }
        let s = self.surface.sample(u);
        let d = s.p - p;
        let d2 = d.length_squared();
        let dir = d / d2.sqrt();
        let mut cos = -dir.dot(s.n);
        let mut n = s.n;
        if self.sides == Sides::Both && cos < 0.0 {
            (cos, n) = (-cos, -n);
        }
        if !(cos > 0.0 && d2 > 0.0) {
            return None;
        }
        let pdf = d2 / (cos * self.area);
        let value = textures.eval(self.radiance, &site(&s)) / pdf;
        Some(DirectSample { dir, target: Some(self.above(s.p, n, p)), value, pdf })
    }

    fn sample_emission(
        &self,
        textures: &Textures,
        bounds: &EmissionBounds<'_>,
        place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        let (place, density) = self.places.as_ref().map_or((place, 1.0), |p| p.choose(place));
        let s = self.surface.sample(place);
        let both = self.sides == Sides::Both;
        let sides = if both { 2.0 } else { 1.0 };
        let own = |mut u: Vec2| {
            let mut n = s.n;
            if both {
                u.x *= 2.0;
                if u.x >= 1.0 {
                    (u.x, n) = (u.x - 1.0, -n);
                }
            }
            Frame::from_normal(n).to_world(warp::cosine_hemisphere(u))
        };
        let cosine = |d: Vec3| if both { s.n.dot(d).abs() } else { s.n.dot(d).max(0.0) };
        let (d, weight) = bounds.head(s.p, direction, own, |d| cosine(d) / (sides * PI));
        let n = if both && s.n.dot(d) < 0.0 { -s.n } else { s.n };
        let flux = textures.eval(self.radiance, &site(&s)) * (sides * PI * self.area * weight / density);
        let cos = cosine(d);
        (flux.max_element() > 0.0).then_some(Emission {
            o: s.p + n * self.lift,
            d,
            cos,
            flux,
            position: Density::Finite(density / self.area),
            direction: Density::Finite(cos / (sides * PI * weight)),
            weight,
        })
    }

    #[inline(always)]
    fn emitted(&self, textures: &Textures, site: &Site, front: bool) -> Color {
        if front || self.sides == Sides::Both { textures.eval(self.radiance, site) } else { Color::ZERO }
    }

    #[inline(always)]
    fn pdf_direct_surface(&self, p: Vec3, d: Vec3, q: Vec3, n: Vec3) -> f32 {
        if let Some((_, cone)) = self.visible_cone(p) {
            return 1.0 / (2.0 * PI * cone.gap);
        }
        let cos = d.dot(n).abs();
        if cos > 0.0 { (q - p).length_squared() / (cos * self.area) } else { 0.0 }
    }

    fn visible_area(&self) -> f32 {
        self.area
    }

    fn place(&self, u: Vec2) -> Option<Vec3> {
        Some(self.surface.sample(u).p)
    }

    fn power(&self, _textures: &Textures, _scene: &SceneSphere) -> Color {
        self.flux()
    }
}

impl Places {
    /// A place of the square and its density.
    fn choose(&self, u: Vec2) -> (Vec2, f32) {
        let (x, y, rest) = self.table.sample(u);
        ((Vec2::new(x as f32, y as f32) + rest) / CELLS as f32, self.weights[y * CELLS + x])
    }
}

/// Looks at the texture all over the lamp.
fn survey(surface: &Surface, radiance: Param, textures: &Textures) -> (Color, Option<Places>) {
    let mut cells = vec![Color::ZERO; CELLS * CELLS];
    let side = CELLS * LOOKS;
    for i in 0..side * side {
        let (x, y) = (i % side, i / side);
        let u = (Vec2::new(x as f32, y as f32) + 0.5) / side as f32;
        let seen = textures.eval(radiance, &site(&surface.sample(u))).max(Color::ZERO);
        cells[y / LOOKS * CELLS + x / LOOKS] += seen / (LOOKS * LOOKS) as f32;
    }
    let mean = cells.iter().copied().sum::<Color>() / cells.len() as f32;
    if mean.max_element() <= 0.0 {
        return (mean, None);
    }
    let least = FLOOR * luminance(mean);
    let raw = |x: usize, y: usize| f64::from(luminance(cells[y * CELLS + x]).max(least));
    let table = Table::new(CELLS, CELLS, raw);
    let scale = (CELLS * CELLS) as f64 / table.total();
    let weights = (0..CELLS * CELLS).map(|i| (raw(i % CELLS, i / CELLS) * scale) as f32).collect();
    (mean, Some(Places { table, weights }))
}
