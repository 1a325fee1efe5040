//! Shapes in world space: intersection, surface point, area and area sampling.
//!
//! Triangles are stored flat in [`crate::scene::Geometry`] because nearly every primitive is one;
//! the analytic shapes are the variants of [`Analytic`], one file each; [`Shape`] is the contract.

mod cylinder;
mod disk;
mod lines;
mod sphere;
pub mod triangle;

pub use cylinder::Cylinder;
pub use disk::Disk;
pub use lines::Lines;
pub use sphere::{Cone, Sphere};

use crate::math::{Bounds, Ray, Vec2, Vec3, closed_enum};

/// A point on an analytic shape.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    /// Projected back onto the shape.
    pub p: Vec3,
    /// Unit normal of the front side.
    pub n: Vec3,
}

/// A point chosen with density 1/area.
#[derive(Clone, Copy, Debug)]
pub struct AreaSample {
    /// On the shape, in world space.
    pub p: Vec3,
    /// Unit normal of the front side.
    pub n: Vec3,
    /// Of the shape's own parametrisation, in [0, 1]².
    pub uv: Vec2,
}

closed_enum! {
    /// A shape with a surface of its own, in world space and world units.
    pub trait Shape {
        /// Nearest `t` in (0, tmax) at which the ray meets it from either side; `None` where it does not. `t` counts in
        /// lengths of `ray.d`.
        fn intersect(&self, ray: &Ray, tmax: f32) -> Option<f32>;

        /// The nearest point of the shape to `p`, which lies on it up to rounding, with its normal.
        fn local(&self, p: Vec3) -> Local;

        /// Coordinates in [0, 1]² of the shape's own parametrisation at `p`, which lies on the shape up to rounding.
        fn uv(&self, p: Vec3) -> Vec2;

        /// Largest number whose rounding to f32 is in the point `p` of [`Shape::local`]: how far off the shape that
        /// may lie, in units of 2⁻²⁴ of it.
        fn magnitude(&self, p: Vec3) -> f32;

        /// ∂p/∂u and ∂p/∂v at `p`, which lies on the shape up to rounding.
        fn partials(&self, p: Vec3) -> [Vec3; 2];

        /// Surface area of one side.
        fn area(&self) -> f32;

        /// A point chosen by `u` in [0, 1)², of density 1/area.
        fn sample_area(&self, u: Vec2) -> AreaSample;

        /// The smallest box around it, up to rounding.
        fn bounds(&self) -> Bounds;
    }

    /// Every shape that is not made of triangles.
    #[derive(Clone, Debug)]
    pub enum Analytic {
        Sphere(Sphere),
        Disk(Disk),
        Cylinder(Cylinder),
    }
}
