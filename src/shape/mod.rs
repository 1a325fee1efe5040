//! Shapes in world space: intersection, surface point, area and area sampling.
//!
//! Triangles are stored flat in [`crate::scene::Geometry`] because nearly every primitive is one;
//! the analytic shapes are the variants of [`Analytic`], one file each.

mod cylinder;
mod disk;
mod sphere;
pub mod triangle;

pub use cylinder::Cylinder;
pub use disk::Disk;
pub use sphere::Sphere;

use crate::math::{Bounds, DVec3, Ray, Vec2, Vec3};

/// A point on an analytic shape.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// Projected back onto the shape.
    pub p: Vec3,
    /// Unit normal of the front side.
    pub n: Vec3,
    pub uv: Vec2,
}

/// A point chosen with density 1/area.
#[derive(Clone, Copy, Debug)]
pub struct AreaSample {
    pub p: Vec3,
    pub n: Vec3,
    pub uv: Vec2,
}

/// The shapes that are not meshes.
#[derive(Clone, Debug)]
pub enum Analytic {
    Sphere(Sphere),
    Disk(Disk),
    Cylinder(Cylinder),
}

macro_rules! each {
    ($self:ident, $shape:ident => $body:expr) => {
        match $self {
            Self::Sphere($shape) => $body,
            Self::Disk($shape) => $body,
            Self::Cylinder($shape) => $body,
        }
    };
}

impl Analytic {
    /// Nearest `t` in (0, tmax).
    pub fn intersect(&self, ray: &Ray, tmax: f32) -> Option<f32> {
        each!(self, s => s.intersect(ray, tmax))
    }

    /// Normal and uv at `p`, which lies on the shape up to rounding.
    pub fn local(&self, p: Vec3) -> Local {
        each!(self, s => s.local(p))
    }

    /// Largest number whose rounding to f32 is in the point `p` of [`Analytic::local`].
    pub fn magnitude(&self, p: Vec3) -> f32 {
        match self {
            // What its f64 loses of the radius, in roundings of f32.
            Self::Sphere(s) => p.abs().max_element() + (s.radius * 2f64.powi(-29)) as f32,
            // Of the plane of a vast one, single precision keeps what it does of the point itself.
            Self::Disk(_) => p.abs().max_element(),
            Self::Cylinder(_) => self.bounds().magnitude(),
        }
    }

    /// ∂p/∂u and ∂p/∂v at `p`, which lies on the shape up to rounding.
    pub fn partials(&self, p: Vec3) -> [Vec3; 2] {
        each!(self, s => s.partials(p))
    }

    /// Surface area in world units.
    pub fn area(&self) -> f32 {
        each!(self, s => s.area())
    }

    /// Uniform point; density 1/area.
    pub fn sample_area(&self, u: Vec2) -> AreaSample {
        each!(self, s => s.sample_area(u))
    }

    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Sphere(s) => {
                let r = DVec3::splat(s.radius);
                Bounds { min: (s.center - r).as_vec3a(), max: (s.center + r).as_vec3a() }
            }
            Self::Disk(d) => {
                let e = (d.u * d.u + d.v * d.v).map(f32::sqrt);
                let center = d.center.as_vec3a();
                Bounds { min: center - e, max: center + e }
            }
            Self::Cylinder(c) => {
                let n = c.axis.n;
                let e = (Vec3::ONE - n * n).max(Vec3::ZERO).map(f32::sqrt) * c.radius;
                let p1 = c.p0 + n * c.length;
                Bounds { min: c.p0.min(p1) - e, max: c.p0.max(p1) + e }
            }
        }
    }
}
