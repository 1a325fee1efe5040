use std::fmt;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Sub};

use glam::Vec4;

/// Lanes of a [`Color`] in use.
pub const LANES: usize = 3;

/// A radiometric quantity (radiance, flux, throughput, albedo) in the lanes of one SIMD register.
///
/// Only `spectrum` and `film` know what a lane stands for. [`LANES`] of the four are in use. The last lane is
/// a copy of the one before it, so that operations on the whole register (maximum, comparison, test for
/// NaN) need no mask.
#[derive(Clone, Copy, PartialEq)]
#[repr(transparent)]
pub struct Color(Vec4);

impl Color {
    /// Black: 0 in every lane.
    pub const ZERO: Self = Self::splat(0.0);
    /// White: 1 in every lane, the throughput of an empty path.
    pub const ONE: Self = Self::splat(1.0);

    /// The same value in every lane.
    #[inline(always)]
    pub const fn splat(value: f32) -> Self {
        Self(Vec4::splat(value))
    }

    /// A colour from the values of its lanes.
    #[inline(always)]
    pub const fn from_lanes([a, b, c]: [f32; LANES]) -> Self {
        Self(Vec4::new(a, b, c, c))
    }

    /// The values of the lanes in use.
    #[inline(always)]
    pub fn lanes(self) -> [f32; LANES] {
        let [a, b, c, _] = self.0.to_array();
        [a, b, c]
    }

    /// The value of all lanes if they are equal.
    #[inline(always)]
    pub fn uniform(self) -> Option<f32> {
        (self == Self::splat(self.0.x)).then_some(self.0.x)
    }

    /// Applies `f` to each lane.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl FnMut(f32) -> f32) -> Self {
        Self::from_lanes(self.lanes().map(f))
    }

    /// Applies `f` to each pair of lanes.
    #[inline]
    #[must_use]
    pub fn zip(self, other: Self, mut f: impl FnMut(f32, f32) -> f32) -> Self {
        let (a, b) = (self.lanes(), other.lanes());
        Self::from_lanes(std::array::from_fn(|i| f(a[i], b[i])))
    }

    /// The largest lane value.
    #[inline(always)]
    pub fn max_element(self) -> f32 {
        self.0.max_element()
    }

    /// The sum of the lanes in use.
    #[inline]
    pub fn sum_of_lanes(self) -> f32 {
        self.lanes().iter().sum()
    }

    /// The smallest lane value.
    #[inline(always)]
    pub fn min_element(self) -> f32 {
        self.0.min_element()
    }

    /// The smaller value of each lane.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    /// The larger value of each lane.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// Clamps each lane to its range, `low` to `high`.
    #[inline(always)]
    #[must_use]
    pub fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// The absolute value of each lane.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// The exponential of each lane.
    #[inline]
    #[must_use]
    pub fn exp(self) -> Self {
        self.map(f32::exp)
    }

    /// Whether no lane is infinite or NaN.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Whether any lane is NaN.
    #[inline(always)]
    pub fn is_nan(self) -> bool {
        self.0.is_nan()
    }
}

impl Default for Color {
    fn default() -> Self {
        Self::ZERO
    }
}

impl fmt::Debug for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Color").field(&self.lanes()).finish()
    }
}

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c] = self.lanes();
        write!(f, "[{a}, {b}, {c}]")
    }
}

macro_rules! operators {
    ($($operator:ident $function:ident $assign:ident $assign_function:ident;)+) => {$(
        impl $operator for Color {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                Self(self.0.$function(other.0))
            }
        }

        impl $assign for Color {
            #[inline(always)]
            fn $assign_function(&mut self, other: Self) {
                self.0 = self.0.$function(other.0);
            }
        }
    )+};
}

operators! {
    Add add AddAssign add_assign;
    Mul mul MulAssign mul_assign;
}

macro_rules! scalar_operators {
    ($($operator:ident $function:ident $assign:ident $assign_function:ident;)+) => {$(
        impl $operator<f32> for Color {
            type Output = Self;
            #[inline(always)]
            fn $function(self, number: f32) -> Self {
                Self(self.0.$function(number))
            }
        }

        impl $assign<f32> for Color {
            #[inline(always)]
            fn $assign_function(&mut self, number: f32) {
                self.0 = self.0.$function(number);
            }
        }
    )+};
}

scalar_operators! {
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}

impl Sub for Color {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Div for Color {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Mul<Color> for f32 {
    type Output = Color;
    #[inline(always)]
    fn mul(self, color: Color) -> Color {
        Color(self * color.0)
    }
}

impl Sum for Color {
    #[inline]
    fn sum<I: Iterator<Item = Self>>(colors: I) -> Self {
        colors.fold(Self::ZERO, Add::add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unused_lane_affects_no_result() {
        let c = Color::from_lanes([3.0, -1.0, 2.0]);
        assert_eq!((c - Color::splat(5.0)).max_element(), -2.0);
        assert_eq!((Color::ONE - c).max_element(), 2.0);
        assert_eq!(Color::splat(0.5).uniform(), Some(0.5));
        assert_eq!(c.uniform(), None);
        assert_eq!(c, Color::from_lanes(c.lanes()));
    }

    #[test]
    fn only_lanes_in_use_can_divide_by_zero() {
        let c = Color::from_lanes([3.0, 1.0, 2.0]) / Color::from_lanes([1.0, 2.0, 4.0]);
        assert!(c.is_finite() && !c.is_nan());
        assert!((Color::ZERO / Color::from_lanes([1.0, 1.0, 0.0])).is_nan());
    }
}
