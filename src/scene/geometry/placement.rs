//! Where instances stand.

use crate::math::{Ray, Vec3};

/// Affine map in f32 with its inverse.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Images of the axes and of the origin.
    pub columns: [Vec3; 4],
    /// The same of the inverse.
    pub inverse: [Vec3; 4],
}

#[inline]
fn affine(m: &[Vec3; 4], v: Vec3, w: f32) -> Vec3 {
    m[0] * v.x + m[1] * v.y + m[2] * v.z + m[3] * w
}

impl Placement {
    /// From the group to the world.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        affine(&self.columns, p, 1.0)
    }

    /// A direction with its length.
    #[inline]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        affine(&self.columns, v, 0.0)
    }

    /// Normals go by the inverse transpose.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        Vec3::new(self.inverse[0].dot(n), self.inverse[1].dot(n), self.inverse[2].dot(n)).normalize_or_zero()
    }

    /// From the world to the group.
    #[inline]
    pub fn inverse_point(&self, p: Vec3) -> Vec3 {
        affine(&self.inverse, p, 1.0)
    }

    /// The inverse of [`Placement::vector`].
    #[inline]
    pub fn inverse_vector(&self, v: Vec3) -> Vec3 {
        affine(&self.inverse, v, 0.0)
    }

    /// t is the same on both sides because the direction is not normalised.
    #[inline]
    pub(super) fn inverse_ray(&self, ray: &Ray, tmax: f32) -> Ray {
        Ray { o: self.inverse_point(ray.o), d: self.inverse_vector(ray.d), tmax }
    }
}

/// A group placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index into `Geometry::groups`.
    pub group: u32,
    /// From the group to the world.
    pub placement: Placement,
}
