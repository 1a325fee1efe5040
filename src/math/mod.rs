//! Vectors, frames and small numeric helpers shared by every layer above.

mod closed_enum;
mod color;
mod erf;
mod frame;
pub mod kernel;
mod octahedral;
mod quadrature;
pub mod simd;

pub(crate) use closed_enum::closed_enum;
pub use color::{Color, LANES};
pub use erf::{erf, erf_inv};
pub use frame::Frame;
pub use glam::{DVec3, Vec2, Vec3A as Vec3};
pub use octahedral::{decode_direction, encode_direction};
pub use quadrature::gauss_legendre;

/// How far above its surface a ray starts, or before it ends, so as not to meet it: 2⁻¹⁹ of the largest
/// coordinate involved, some sixteen roundings; measured errors of barycentric points and of the
/// triangle test stay below eight.
pub const LIFT: f32 = 1.0 / 524_288.0;

/// A ray restricted to `0 < t < tmax`; `d` need not be of unit length.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub o: Vec3,
    pub d: Vec3,
    pub tmax: f32,
}

impl Ray {
    #[inline]
    pub fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, d, tmax: f32::INFINITY }
    }

    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }
}

/// Axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub min: Vec3,
    pub max: Vec3,
}

impl Bounds {
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest around all points; empty without any.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        let mut bounds = Self::EMPTY;
        points.into_iter().for_each(|p| bounds.add(p));
        bounds
    }

    pub fn add(&mut self, p: Vec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    pub fn union(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Radius of the sphere around `center` through the corners; 0 when empty.
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.extent().length() * 0.5 }
    }

    /// Largest absolute coordinate.
    pub fn magnitude(&self) -> f32 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}
