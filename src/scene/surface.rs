//! Where a ray meets a shape: position, normals, uv, and how light scatters there.

use super::{Face, Hit, Kind, Level, NO_INSTANCE, Scene, ShapeRecord};
use crate::bsdf::{Closure, Material, Point};
use crate::math::{Frame, LIFT, Ray, Vec2, Vec3};
use crate::texture::{OnMesh, Site};

/// A point on a surface, in the world.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where it is.
    pub p: Vec3,
    /// Unit geometric normal.
    pub ng: Vec3,
    /// Shading frame.
    pub frame: Frame,
    /// Texture coordinates; 0 on analytic shapes on which nothing depends on them.
    pub uv: Vec2,
    /// ∂p/∂u and ∂p/∂v along `frame.s` and `frame.t`, for shapes whose material asks for them.
    pub tangents: [Vec2; 2],
    /// Offset along the normal at which rays start, so that rounding does not make them hit this surface again.
    pub lift: f32,
    /// Index into `Scene::shapes`.
    pub shape: u32,
    /// Triangle of the shape's mesh; 0 for shapes without one.
    pub triangle: u32,
    /// Barycentric weights of its second and third corner.
    pub weights: [f32; 2],
}

impl Surface {
    /// Origin for a ray leaving along `d`, on that side of the surface.
    #[inline(always)]
    pub fn origin(&self, d: Vec3) -> Vec3 {
        self.p + self.ng * self.lift.copysign(self.ng.dot(d))
    }

    /// A ray along `d` that starts off the surface, so that rounding does not make it hit the surface again.
    #[inline(always)]
    pub fn leave(&self, d: Vec3) -> Ray {
        Ray::new(self.origin(d), d)
    }

    /// How far behind the start of a ray that leaves along `d` the surface lies, in units of `d`. At a graze it is no
    /// farther than the lift is long a hundred times.
    #[inline(always)]
    pub fn gap(&self, d: Vec3) -> f32 {
        self.lift / self.ng.dot(d).abs().max(0.01 * d.length())
    }

    /// For textures.
    #[inline(always)]
    pub(super) fn site(&self) -> Site {
        let on = OnMesh { shape: self.shape, triangle: self.triangle, weights: self.weights };
        Site { uv: self.uv, p: self.p, n: self.ng, on }
    }

    /// Turns the frame around `n` so that s follows the first of the partial derivatives of the position.
    #[inline(never)]
    fn orient(&mut self, n: Vec3, partials: [Vec3; 2]) {
        let Some(s) = (partials[0] - n * n.dot(partials[0])).try_normalize() else {
            self.frame = Frame::from_normal(n);
            return;
        };
        self.frame = Frame { s, t: n.cross(s), n };
        self.tangents = partials.map(|d| Vec2::new(self.frame.s.dot(d), self.frame.t.dot(d)));
    }

    /// ∂p/∂u and ∂p/∂v in the tangent plane of the shading normal.
    fn partials(&self) -> [Vec3; 2] {
        self.tangents.map(|t| self.frame.s * t.x + self.frame.t * t.y)
    }
}

/// The side of a surface that photons are stored for.
#[derive(Clone, Copy, Debug)]
pub struct PhotonSide {
    /// Unit normal that its photons carry.
    pub n: Vec3,
    /// Photons of both sides are stored together.
    pub both: bool,
}

impl Scene {
    /// Position, normals and uv at a hit.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let level = &self.geometry.world;
        if hit.instance == NO_INSTANCE
            && let Kind::Triangle(triangle) = level.kind(hit)
        {
            let index = level.shape(hit);
            let shape = &self.shapes[index as usize];
            if shape.oriented {
                return oriented_triangle(level, shape, index, triangle as usize, hit);
            }
            return plain_triangle(&level.face(hit), shape, index, triangle as usize, hit);
        }
        self.other_surface(ray, hit)
    }

    /// [`Scene::surface`] for everything but triangles of the world level.
    #[inline(never)]
    fn other_surface(&self, ray: &Ray, hit: &Hit) -> Surface {
        let level = self.geometry.level(hit.instance);
        let index = level.shape(hit);
        let shape = &self.shapes[index as usize];
        let mut s = match level.kind(hit) {
            Kind::Triangle(triangle) if shape.oriented => {
                oriented_triangle(level, shape, index, triangle as usize, hit)
            }
            Kind::Triangle(triangle) => {
                plain_triangle(&level.face(hit), shape, index, triangle as usize, hit)
            }
            Kind::Analytic(i) => {
                let p = match self.geometry.instances.get(hit.instance as usize) {
                    Some(i) => i.placement.inverse_point(ray.at(hit.t)),
                    None => ray.at(hit.t),
                };
                let l = level.analytic[i as usize].local(p);
                let n = if shape.flip { -l.n } else { l.n };
                let extent = level.analytic[i as usize].magnitude(l.p);
                let mut s = Surface {
                    p: l.p,
                    ng: n,
                    frame: Frame::from_normal(n),
                    uv: if shape.varies { level.analytic[i as usize].uv(l.p) } else { Vec2::ZERO },
                    tangents: NO_TANGENTS,
                    lift: extent * LIFT,
                    shape: index,
                    triangle: 0,
                    weights: [0.0; 2],
                };
                if shape.oriented {
                    s.orient(n, level.analytic[i as usize].partials(l.p));
                }
                s
            }
            Kind::Instance(_) => unreachable!("an instance's hit names a primitive of its group"),
        };
        if let Some(instance) = self.geometry.instances.get(hit.instance as usize) {
            let m = &instance.placement;
            let scale = m.columns[..3].iter().map(|c| c.length()).fold(0.0, f32::max);
            s.p = m.point(s.p);
            s.ng = m.normal(s.ng);
            let n = m.normal(s.frame.n);
            if shape.oriented {
                s.orient(n, s.partials().map(|d| m.vector(d)));
            } else {
                s.frame = Frame::from_normal(n);
            }
            s.lift = s.lift * scale + s.p.abs().max_element() * LIFT;
        }
        s
    }

    /// Scattering at a surface point for light handled on the side of the local direction `wi`.
    #[inline(always)]
    pub fn closure(&self, s: &Surface, wi: Vec3) -> Closure<'_> {
        let material = self.shapes[s.shape as usize].material;
        let axes = [s.frame.s, s.frame.t];
        let point = Point { textures: &self.textures, site: s.site(), tangents: s.tangents, axes };
        self.materials[material as usize].closure(&point, wi)
    }

    /// The side of the surface whose photons describe the light along `w` (world): the side of `w`, or the
    /// front for both sides if the material transmits light diffusely.
    #[inline]
    pub fn photon_side(&self, s: &Surface, w: Vec3) -> PhotonSide {
        let both = self.material(s).nature().diffuses_through;
        PhotonSide { n: if both || s.ng.dot(w) >= 0.0 { s.ng } else { -s.ng }, both }
    }

    /// [`Scene::photon_side`] for glossy lobes.
    pub fn glint_side(&self, s: &Surface, w: Vec3) -> PhotonSide {
        let both = self.material(s).nature().transmits;
        PhotonSide { n: if both || s.ng.dot(w) >= 0.0 { s.ng } else { -s.ng }, both }
    }

    /// What the surface is made of.
    #[inline]
    pub fn material(&self, s: &Surface) -> &Material {
        &self.materials[self.shapes[s.shape as usize].material as usize]
    }
}

/// A surface whose frame follows ∂p/∂u.
#[inline(never)]
fn oriented_triangle(level: &Level, shape: &ShapeRecord, index: u32, triangle: usize, hit: &Hit) -> Surface {
    let face = level.face(hit);
    let mut s = plain_triangle(&face, shape, index, triangle, hit);
    s.orient(s.frame.n, triangle_partials(&face.corners(), shape, triangle));
    s
}

/// A surface whose frame is any around its normal. It is put together where it is returned: reading back 16 bytes that
/// were just written as four numbers stalls a processor for longer than all of this takes.
#[inline(always)]
fn plain_triangle(face: &Face, shape: &ShapeRecord, index: u32, triangle: usize, hit: &Hit) -> Surface {
    let [v0, v1, v2] = face.corners();
    let b0 = 1.0 - hit.b1 - hit.b2;
    let mix = |a: Vec3, b: Vec3, c: Vec3| a * b0 + b * hit.b1 + c * hit.b2;
    let flip = if shape.flip { -1.0 } else { 1.0 };
    let ng = face.normal * flip;
    let mut ns = ng;
    let mut uv = Vec2::new(hit.b1, hit.b2);
    if !shape.normals.is_empty() || !shape.uvs.is_empty() {
        let t = shape.triangles[triangle].map(|i| i as usize);
        if !shape.normals.is_empty() {
            let n = t.map(|i| Vec3::from(shape.normals[i]));
            ns = (mix(n[0], n[1], n[2]) * flip).normalize_or(ng);
        }
        if !shape.uvs.is_empty() {
            let c = t.map(|i| Vec2::from(shape.uvs[i]));
            uv = c[0] * b0 + c[1] * hit.b1 + c[2] * hit.b2;
        }
    }
    let lift = face.magnitude * LIFT;
    let mut p = mix(v0, v1, v2);
    if b0.min(hit.b1).min(hit.b2) < NEAR_EDGE {
        p = off_edges(p, &[v0, v1, v2], [b0, hit.b1, hit.b2], 0.5 * lift);
    }
    Surface {
        p,
        ng,
        frame: Frame::from_normal(ns),
        uv,
        tangents: NO_TANGENTS,
        lift,
        shape: index,
        triangle: triangle as u32,
        weights: [hit.b1, hit.b2],
    }
}

/// Barycentric weight below which a hit may lie on the edge opposite the corner.
const NEAR_EDGE: f32 = 1.0 / 4096.0;

/// Moves a point to at least `least` from the edges. In the corner of a room, rounding may put a hit behind
/// the adjacent wall, and a ray from there escapes: about one bounce in 10⁷ did in a mirror box.
#[cold]
fn off_edges(p: Vec3, corners: &[Vec3; 3], weights: [f32; 3], least: f32) -> Vec3 {
    let [v0, v1, v2] = *corners;
    let double_area = (v1 - v0).cross(v2 - v0).length();
    let edges = [v2 - v1, v0 - v2, v1 - v0];
    // A barycentric weight is the distance to the edge divided by the height over it.
    let wanted: [f32; 3] = std::array::from_fn(|i| {
        let share = least * edges[i].length() / double_area;
        if share.is_finite() { weights[i].max(share.min(1.0 / 3.0)) } else { weights[i] }
    });
    let sum: f32 = wanted.iter().sum();
    let moved = (v0 * wanted[0] + v1 * wanted[1] + v2 * wanted[2]) / sum;
    if wanted == weights || !moved.is_finite() { p } else { moved }
}

/// ∂p/∂u and ∂p/∂v over a triangle; without usable uv, those of the barycentric coordinates.
#[inline(never)]
pub(super) fn triangle_partials(v: &[Vec3; 3], shape: &ShapeRecord, triangle: usize) -> [Vec3; 2] {
    let (e1, e2) = (v[1] - v[0], v[2] - v[0]);
    if shape.uvs.is_empty() {
        return [e1, e2];
    }
    let [a, b, c] = shape.triangles[triangle].map(|i| Vec2::from(shape.uvs[i as usize]));
    let (d1, d2) = (b - a, c - a);
    let det = d1.perp_dot(d2);
    if det == 0.0 {
        return [e1, e2];
    }
    [(e1 * d2.y - e2 * d1.y) / det, (e2 * d1.x - e1 * d2.x) / det]
}

/// Tangents of surfaces whose material does not need any.
const NO_TANGENTS: [Vec2; 2] = [Vec2::X, Vec2::Y];
