//! Primitives and their BVHs: one level for the world, one per shape group that is instanced.

use crate::accel::Bvh;
use crate::math::{Bounds, Ray, Vec3};
use crate::shape::Analytic;
use crate::shape::triangle::Shear;

/// A triangle's corners, or the number of something else. In BVH leaf order, so that a leaf is one
/// read of consecutive memory.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    v: [[f32; 3]; 3],
    pub shape: u32,
    /// Triangle of the shape's mesh; with [`ANALYTIC`] or [`INSTANCE`] set, an index into those lists.
    tag: u32,
}

const ANALYTIC: u32 = 1 << 31;
const INSTANCE: u32 = 1 << 30;
const INDEX: u32 = INSTANCE - 1;

/// What a primitive is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Triangle(u32),
    Analytic(u32),
    Instance(u32),
}

impl Primitive {
    pub fn triangle(v: [[f32; 3]; 3], shape: u32, index: u32) -> Self {
        debug_assert!(index <= INDEX);
        Self { v, shape, tag: index }
    }

    pub fn analytic(shape: u32, index: u32) -> Self {
        Self { v: [[0.0; 3]; 3], shape, tag: index | ANALYTIC }
    }

    pub fn instance(index: u32) -> Self {
        Self { v: [[0.0; 3]; 3], shape: u32::MAX, tag: index | INSTANCE }
    }

    #[inline]
    pub fn kind(&self) -> Kind {
        if self.tag & (ANALYTIC | INSTANCE) == 0 {
            Kind::Triangle(self.tag)
        } else if self.tag & ANALYTIC != 0 {
            Kind::Analytic(self.tag & INDEX)
        } else {
            Kind::Instance(self.tag & INDEX)
        }
    }

    pub fn corners(&self) -> &[[f32; 3]; 3] {
        &self.v
    }
}

/// Most triangles of one mesh, and most meshes or instances of one scene.
pub const MAX_INDEX: usize = INDEX as usize;

/// Affine map in f32 with its inverse.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    pub columns: [Vec3; 4],
    pub inverse: [Vec3; 4],
}

fn affine(m: &[Vec3; 4], v: Vec3, w: f32) -> Vec3 {
    m[0] * v.x + m[1] * v.y + m[2] * v.z + m[3] * w
}

impl Placement {
    pub fn point(&self, p: Vec3) -> Vec3 {
        affine(&self.columns, p, 1.0)
    }

    pub fn vector(&self, v: Vec3) -> Vec3 {
        affine(&self.columns, v, 0.0)
    }

    /// Normals go by the inverse transpose.
    pub fn normal(&self, n: Vec3) -> Vec3 {
        Vec3::new(self.inverse[0].dot(n), self.inverse[1].dot(n), self.inverse[2].dot(n)).normalize_or_zero()
    }

    pub fn inverse_point(&self, p: Vec3) -> Vec3 {
        affine(&self.inverse, p, 1.0)
    }

    pub fn inverse_vector(&self, v: Vec3) -> Vec3 {
        affine(&self.inverse, v, 0.0)
    }

    /// t is the same on both sides because the direction is not normalised.
    fn inverse_ray(&self, ray: &Ray, tmax: f32) -> Ray {
        Ray { o: self.inverse_point(ray.o), d: self.inverse_vector(ray.d), tmax }
    }
}

/// A group placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    pub group: u32,
    pub placement: Placement,
}

/// One level: primitives in leaf order and the tree over them.
#[derive(Debug)]
pub struct Level {
    pub primitives: Vec<Primitive>,
    pub analytic: Vec<Analytic>,
    bvh: Bvh,
    pub bounds: Bounds,
}

impl Level {
    pub fn new(primitives: Vec<Primitive>, analytic: Vec<Analytic>, instance_bounds: &[Bounds]) -> Self {
        let boxes: Vec<Bounds> = primitives
            .iter()
            .map(|p| match p.kind() {
                Kind::Triangle(_) => {
                    let mut b = Bounds::EMPTY;
                    p.v.iter().for_each(|&v| b.add(Vec3::from(v)));
                    b
                }
                Kind::Analytic(i) => analytic[i as usize].bounds(),
                Kind::Instance(i) => instance_bounds[i as usize],
            })
            .collect();
        let mut bounds = Bounds::EMPTY;
        boxes.iter().for_each(|b| bounds.union(b));
        let bvh = Bvh::build(&boxes);
        let primitives = bvh.order().iter().map(|&i| primitives[i as usize]).collect();
        Self { primitives, analytic, bvh, bounds }
    }

    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of_val(self.primitives.as_slice())
    }
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f32,
    /// Barycentric weights of the second and third corner (triangles).
    pub b1: f32,
    pub b2: f32,
    /// Position in the level's primitives.
    pub primitive: u32,
    /// Instance the primitive was reached through; [`NO_INSTANCE`] for the world itself.
    pub instance: u32,
}

pub const NO_INSTANCE: u32 = u32::MAX;

/// Everything rays can meet.
#[derive(Debug)]
pub struct Geometry {
    pub world: Level,
    pub groups: Vec<Level>,
    pub instances: Vec<Instance>,
}

impl Geometry {
    /// Level that holds the primitive of `hit`.
    pub fn level(&self, instance: u32) -> &Level {
        match self.instances.get(instance as usize) {
            Some(i) => &self.groups[i.group as usize],
            None => &self.world,
        }
    }

    /// Nearest hit in (0, tmax).
    #[inline]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let mut best = None;
        self.closest_in(&self.world, ray, NO_INSTANCE, &mut best);
        best
    }

    #[inline]
    fn closest_in(&self, level: &Level, ray: &Ray, instance: u32, best: &mut Option<Hit>) {
        let shear = Shear::new(ray);
        level.bvh.closest(ray, |position, tmax| {
            let p = &level.primitives[position];
            if let Kind::Triangle(_) = p.kind() {
                let (t, b1, b2) = shear.intersect(&p.v, tmax)?;
                *best = Some(Hit { t, b1, b2, primitive: position as u32, instance });
                return Some(t);
            }
            self.closest_other(level, p, position, ray, tmax, instance, best)
        });
    }

    #[inline(never)]
    fn closest_other(
        &self,
        level: &Level,
        p: &Primitive,
        position: usize,
        ray: &Ray,
        tmax: f32,
        instance: u32,
        best: &mut Option<Hit>,
    ) -> Option<f32> {
        match p.kind() {
            Kind::Analytic(i) => {
                let t = level.analytic[i as usize].intersect(ray, tmax)?;
                *best = Some(Hit { t, b1: 0.0, b2: 0.0, primitive: position as u32, instance });
                Some(t)
            }
            Kind::Instance(i) => {
                let placed = &self.instances[i as usize];
                let mut found = None;
                let local = placed.placement.inverse_ray(ray, tmax);
                self.closest_in(&self.groups[placed.group as usize], &local, i, &mut found);
                let hit = found?;
                *best = Some(hit);
                Some(hit.t)
            }
            Kind::Triangle(_) => None,
        }
    }

    /// Whether anything lies in (0, tmax).
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_in(&self.world, ray)
    }

    #[inline]
    fn occluded_in(&self, level: &Level, ray: &Ray) -> bool {
        let shear = Shear::new(ray);
        level.bvh.any(ray, |position| {
            let p = &level.primitives[position];
            match p.kind() {
                Kind::Triangle(_) => shear.intersect(&p.v, ray.tmax).is_some(),
                Kind::Analytic(i) => level.analytic[i as usize].intersect(ray, ray.tmax).is_some(),
                Kind::Instance(i) => self.instance_occluded(i, ray),
            }
        })
    }

    #[inline(never)]
    fn instance_occluded(&self, i: u32, ray: &Ray) -> bool {
        let placed = &self.instances[i as usize];
        self.occluded_in(&self.groups[placed.group as usize], &placed.placement.inverse_ray(ray, ray.tmax))
    }

    pub fn bytes(&self) -> usize {
        self.world.bytes() + self.groups.iter().map(Level::bytes).sum::<usize>()
    }
}
