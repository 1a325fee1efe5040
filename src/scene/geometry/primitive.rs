//! What rays can hit, as the compiler lists it.

use crate::math::{Bounds, Vec3};
use crate::shape::Analytic;

/// A triangle, or a reference to an analytic shape or an instance.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    pub(super) v: [[f32; 3]; 3],
    pub shape: u32,
    /// Triangle of the shape's mesh; with [`ANALYTIC`] or [`INSTANCE`] set, an index into those lists.
    pub(super) tag: u32,
}

const ANALYTIC: u32 = 1 << 31;
const INSTANCE: u32 = 1 << 30;
const INDEX: u32 = INSTANCE - 1;

/// What a primitive is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Of the shape's mesh.
    Triangle(u32),
    /// Index into the level's list of shapes with models of their own.
    Analytic(u32),
    /// Index into `Geometry::instances`.
    Instance(u32),
}

/// By the tag of a primitive.
#[inline(always)]
pub(super) fn kind(tag: u32) -> Kind {
    if tag & (ANALYTIC | INSTANCE) == 0 {
        Kind::Triangle(tag)
    } else if tag & ANALYTIC != 0 {
        Kind::Analytic(tag & INDEX)
    } else {
        Kind::Instance(tag & INDEX)
    }
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

    pub fn corners(&self) -> &[[f32; 3]; 3] {
        &self.v
    }

    pub fn corners_mut(&mut self) -> &mut [[f32; 3]; 3] {
        &mut self.v
    }

    pub fn kind(&self) -> Kind {
        kind(self.tag)
    }

    /// Its box, given the lists that its tag indexes.
    pub fn bounds(&self, analytic: &[Analytic], instance_bounds: &[Bounds]) -> Bounds {
        match self.kind() {
            Kind::Triangle(_) => Bounds::of(self.v.map(Vec3::from)),
            Kind::Analytic(i) => analytic[i as usize].bounds(),
            Kind::Instance(i) => instance_bounds[i as usize],
        }
    }
}

/// Most triangles of one mesh, and most meshes or instances of one scene.
pub const MAX_INDEX: usize = INDEX as usize;
