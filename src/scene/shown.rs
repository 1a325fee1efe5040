//! What pictures of a surface show beside its light: how its author counts it, how it is parametrised, what it
//! reflects.

use super::surface::triangle_partials;
use super::{Hit, Kind, NO_INSTANCE, Scene, Surface};
use crate::bsdf::Point;
use crate::math::{Color, Frame, Vec3};

/// How the author's scene counts its shapes.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    /// By shape: its number from 1, 0 in groups, and how its primitives are counted.
    pub records: Vec<(u32, Primitives)>,
    /// By instance: its number from 1.
    pub instances: Vec<u32>,
}

/// How the primitives of a shape are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Primitives {
    /// As its triangles; what has none is number 0.
    Triangles,
    /// It is one, whatever it is made of here.
    One,
    /// As the two triangles of Mitsuba's rectangle.
    Rectangle,
    /// As the triangles of Mitsuba's cube.
    Cube,
}

/// Numbers that Mitsuba gives to the faces of our cube.
const FACES: [u32; 6] = [2, 4, 1, 0, 3, 5];

impl Scene {
    /// Number of the shape in the author's scene, from 1; an instance counts as one.
    pub fn shape_number(&self, hit: &Hit, s: &Surface) -> u32 {
        match hit.instance {
            NO_INSTANCE => self.numbers.records[s.shape as usize].0,
            instance => self.numbers.instances[instance as usize],
        }
    }

    /// Number of the primitive in its shape, from 0.
    pub fn primitive_number(&self, s: &Surface) -> u32 {
        let triangle = s.triangle as usize;
        let authored = self.shapes[s.shape as usize].authored.get(triangle).copied().unwrap_or(s.triangle);
        match self.numbers.records[s.shape as usize].1 {
            Primitives::Triangles => authored,
            Primitives::One => 0,
            // Mitsuba cuts each face along u + v = 1.
            Primitives::Rectangle => u32::from(s.uv.x + s.uv.y > 1.0),
            Primitives::Cube => match FACES.get(authored as usize / 2) {
                Some(face) => 2 * face + u32::from(s.uv.x + s.uv.y < 1.0),
                None => authored,
            },
        }
    }

    /// ∂p/∂u and ∂p/∂v in the world. Meshes without texture coordinates have two unit tangents.
    pub fn partials(&self, hit: &Hit, s: &Surface) -> [Vec3; 2] {
        let level = self.geometry.level(hit.instance);
        let shape = &self.shapes[s.shape as usize];
        let placement = self.geometry.instances.get(hit.instance as usize).map(|i| &i.placement);
        let partials = match level.kind(hit) {
            Kind::Triangle(_) if shape.uvs.is_empty() => {
                let normal = level.face(hit).normal * if shape.flip { -1.0 } else { 1.0 };
                let frame = Frame::from_normal(normal);
                [frame.s, frame.t]
            }
            Kind::Triangle(triangle) => {
                triangle_partials(&level.face(hit).corners(), shape, triangle as usize)
            }
            Kind::Analytic(i) => {
                let p = placement.map_or(s.p, |m| m.inverse_point(s.p));
                level.analytic[i as usize].partials(p)
            }
            Kind::Instance(_) => unreachable!("an instance's hit names a primitive of its group"),
        };
        placement.map_or(partials, |m| partials.map(|d| m.vector(d)))
    }

    /// Diffuse reflectance as Mitsuba's BSDFs tell it, seen from the local direction `wi`.
    pub fn reflectance(&self, s: &Surface, wi: Vec3) -> Color {
        self.material(s).reflectance(&self.point(s), wi)
    }

    /// Shading normal as seen from the local direction `wi`. A bump or normal map bends it where it is the outermost
    /// part of the material, or with `inside` wherever it is in it.
    pub fn shown_normal(&self, s: &Surface, wi: Vec3, inside: bool) -> Vec3 {
        match self.material(s).bent_normal(&self.point(s), wi, inside) {
            Some(local) => s.frame.to_world(local),
            None => s.frame.n,
        }
    }

    fn point(&self, s: &Surface) -> Point<'_> {
        let axes = [s.frame.s, s.frame.t];
        Point { textures: &self.textures, site: s.site(), tangents: s.tangents, axes }
    }
}
