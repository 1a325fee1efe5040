//! What varies from place to place in a medium.

use std::sync::Arc;

use super::Grid;
use crate::math::{Affine, Color, Vec3};

/// A colour, or a vector, at each place.
#[derive(Clone, Debug)]
pub enum Volume {
    /// The same everywhere.
    Constant(Color),
    /// Numbers or colours of a grid, times a colour.
    Grid(Arc<Grid>, Color),
}

impl Volume {
    /// The colour at a place.
    #[inline(always)]
    pub fn color(&self, p: Vec3) -> Color {
        match self {
            Self::Constant(c) => *c,
            Self::Grid(grid, tint) if grid.channels == 1 => *tint * grid.at::<1>(p)[0],
            Self::Grid(grid, tint) => *tint * Color::from_lanes(grid.at(p)),
        }
    }

    /// The vector at a place.
    #[inline]
    pub fn vector(&self, p: Vec3) -> Vec3 {
        Vec3::from(self.color(p).lanes())
    }

    /// No lane is greater at any place.
    pub fn largest(&self) -> f32 {
        match self {
            Self::Constant(c) => c.max_element(),
            Self::Grid(grid, tint) => tint.max_element() * grid.largest(),
        }
    }

    /// The grid, if it has one.
    pub fn grid(&self) -> Option<&Grid> {
        match self {
            Self::Constant(_) => None,
            Self::Grid(grid, _) => Some(grid),
        }
    }

    /// The box beyond which it is 0, by the map to its unit cube; `None` if there is no end to it.
    pub fn end(&self) -> Option<Affine> {
        self.grid().filter(|grid| grid.reading.clipped).map(|grid| grid.reading.to_local)
    }

    /// The mean colour over its box.
    pub fn mean(&self) -> Color {
        match self {
            Self::Constant(c) => *c,
            Self::Grid(grid, tint) => {
                let n = grid.channels as usize;
                let mut sums = [0.0f64; 3];
                for value in grid.data.chunks_exact(n) {
                    sums.iter_mut().enumerate().for_each(|(c, s)| *s += f64::from(value[c.min(n - 1)]));
                }
                let count = (grid.data.len() / n).max(1) as f64;
                *tint * Color::from_lanes(sums.map(|s| (s / count) as f32))
            }
        }
    }
}

/// A symmetric matrix: xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric(pub [f32; 6]);

impl Symmetric {
    /// The product with a vector.
    #[inline]
    pub fn times(&self, v: Vec3) -> Vec3 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        Vec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }

    /// The determinant.
    pub fn determinant(&self) -> f32 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        xx * yy * zz + 2.0 * xy * xz * yz - xx * yz * yz - yy * xz * xz - zz * xy * xy
    }

    /// The inverse times the determinant.
    #[must_use]
    pub fn adjugate(&self) -> Self {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        Self([
            yy * zz - yz * yz,
            xx * zz - xz * xz,
            xx * yy - xy * xy,
            xz * yz - xy * zz,
            xy * yz - xz * yy,
            xy * xz - yz * xx,
        ])
    }
}

/// A symmetric matrix at each place.
#[derive(Clone, Debug)]
pub enum Matrices {
    /// The same everywhere.
    Constant(Symmetric),
    /// Of a grid with six channels.
    Grid(Arc<Grid>),
}

impl Matrices {
    /// The matrix at a place.
    #[inline]
    pub fn at(&self, p: Vec3) -> Symmetric {
        match self {
            Self::Constant(s) => *s,
            Self::Grid(grid) => Symmetric(grid.at(p)),
        }
    }

    /// No trace is greater at any place.
    pub fn largest_trace(&self) -> f32 {
        let trace = |s: &[f32]| s[0] + s[1] + s[2];
        match self {
            Self::Constant(s) => trace(&s.0),
            Self::Grid(grid) => grid.data.chunks_exact(6).map(trace).fold(0.0, f32::max),
        }
    }
}
