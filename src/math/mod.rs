//! Vectors, colours, frames, kernels and SIMD: the numeric types that everything above uses.

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
pub use erf::{erf, erf_inv, gauss};
pub use frame::Frame;
pub use glam::{Affine3A as Affine, DVec3, Mat2, Vec2, Vec3A as Vec3};
pub use octahedral::{decode_direction, encode_direction};
pub use quadrature::gauss_legendre;

/// Offset that keeps a ray from hitting the surface it starts on or ends at, relative to the largest
/// absolute coordinate involved: 2⁻¹⁹, which is 16 times `f32::EPSILON` (measured errors of barycentric
/// points and of the triangle test stay below 8 times).
pub const LIFT: f32 = 1.0 / 524_288.0;

/// `p` moved along `n` by [`LIFT`]: the start of a ray from a place of which nothing else is known.
#[inline]
pub fn lifted(p: Vec3, n: Vec3) -> Vec3 {
    p + n * (p.abs().max_element() * LIFT)
}

/// The points `o + t·d` with `0 < t < tmax`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Direction, of any non-zero length.
    pub d: Vec3,
    /// End of the ray, in units of the length of `d`.
    pub tmax: f32,
}

impl Ray {
    /// An unbounded ray.
    #[inline]
    pub fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, d, tmax: f32::INFINITY }
    }

    /// The same ray with a unit direction.
    #[must_use]
    #[inline]
    pub fn normalised(&self) -> Self {
        let unit = self.d.length();
        Self { o: self.o, d: self.d / unit, tmax: self.tmax * unit }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }
}

/// Axis-aligned box; empty if `min.x > max.x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Corner of least coordinates.
    pub min: Vec3,
    /// Corner of greatest coordinates.
    pub max: Vec3,
}

impl Bounds {
    /// The box of no points, from +∞ to −∞: the identity of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`; [`Bounds::EMPTY`] if there are none.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        let mut bounds = Self::EMPTY;
        points.into_iter().for_each(|p| bounds.add(p));
        bounds
    }

    /// Grows the box to contain `p`.
    pub fn add(&mut self, p: Vec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// Grows the box to contain `other`.
    pub fn union(&mut self, other: &Self) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// The centre; NaN for an empty box.
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths along the axes; −∞ for an empty box.
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Radius of the bounding sphere, half the diagonal; 0 for an empty box.
    pub fn radius(&self) -> f32 {
        if self.is_empty() { 0.0 } else { self.extent().length() * 0.5 }
    }

    /// The largest absolute coordinate; ∞ for an empty box.
    pub fn magnitude(&self) -> f32 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}
