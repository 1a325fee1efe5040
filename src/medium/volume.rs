//! What varies from place to place in a medium.

use std::sync::Arc;

use super::{Cloud, Grid};
use crate::math::{Affine, Color, Vec3};

/// A colour, or a vector, at each place.
#[derive(Clone, Debug)]
pub enum Volume {
    /// The same everywhere.
    Constant(Color),
    /// Numbers or colours of a grid, times a colour.
    Grid(Arc<Grid>, Color),
    /// A density, times a colour.
    Cloud(Box<Cloud>, Color),
    /// Both multiplied.
    Product(Box<[Self; 2]>),
    /// Colours for the numbers x of a grid, as a·x + b.
    Ramp(Arc<Ramp>, Arc<Grid>, [f32; 2]),
}

/// Colours by a number, straight lines between.
#[derive(Clone, Debug)]
pub struct Ramp {
    /// The number of the first colour; `below` counts up to it.
    pub begin: f32,
    /// The number of the last colour, which counts beyond it too.
    pub end: f32,
    /// Evenly spaced, one or more.
    pub colors: Vec<Color>,
    /// Of smaller numbers.
    pub below: Color,
}

impl Ramp {
    /// The colour of a number.
    pub fn color(&self, x: f32) -> Color {
        let last = self.colors.len() - 1;
        if x <= self.begin || x.is_nan() {
            return self.below;
        }
        let at = ((x - self.begin) / (self.end - self.begin) * last as f32).min(last as f32);
        if !at.is_finite() {
            return self.colors[last];
        }
        let i = (at as usize).min(last);
        let t = at - i as f32;
        self.colors[i] * (1.0 - t) + self.colors[(i + 1).min(last)] * t
    }
}

impl Volume {
    /// The colour at a place.
    #[inline(always)]
    pub fn color(&self, p: Vec3) -> Color {
        match self {
            Self::Constant(c) => *c,
            Self::Grid(grid, tint) if grid.channels == 1 => *tint * grid.at::<1>(p)[0],
            Self::Grid(grid, tint) => *tint * Color::from_lanes(grid.at(p)),
            Self::Cloud(cloud, tint) => *tint * cloud.density(p),
            Self::Product(both) => both[0].color(p) * both[1].color(p),
            Self::Ramp(ramp, grid, [a, b]) => ramp.color(a * grid.at::<1>(p)[0] + b),
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
            Self::Constant(c) | Self::Cloud(_, c) => c.max_element(),
            Self::Grid(grid, tint) => tint.max_element() * grid.largest(),
            Self::Product(both) => both[0].largest() * both[1].largest(),
            Self::Ramp(ramp, ..) => ramp.colors.iter().map(|c| c.max_element()).fold(0.0, f32::max),
        }
    }

    /// The grid, if it has one.
    pub fn grid(&self) -> Option<&Grid> {
        match self {
            Self::Grid(grid, _) | Self::Ramp(_, grid, _) => Some(grid),
            Self::Constant(_) | Self::Cloud(..) | Self::Product(_) => None,
        }
    }

    /// The box beyond which it is 0, by the map to its unit cube; `None` if there is no end to it.
    pub fn end(&self) -> Option<Affine> {
        match self {
            Self::Cloud(cloud, _) => Some(cloud.to_box),
            other => other.grid().filter(|grid| grid.reading.clipped).map(|grid| grid.reading.to_local),
        }
    }

    /// The mean colour over its box; of a product, the product of the means, and of a cloud half of the greatest.
    pub fn mean(&self) -> Color {
        match self {
            Self::Constant(c) => *c,
            Self::Cloud(_, tint) => *tint * 0.5,
            Self::Grid(grid, tint) => {
                *tint * mean(grid, |v| Color::from_lanes(std::array::from_fn(|c| v[c.min(v.len() - 1)])))
            }
            Self::Product(both) => both[0].mean() * both[1].mean(),
            Self::Ramp(ramp, grid, [a, b]) => mean(grid, |v| ramp.color(a * v[0] + b)),
        }
    }
}

/// Of the colours of all nodes.
fn mean(grid: &Grid, color: impl Fn(&[f32]) -> Color) -> Color {
    let (mut sums, mut count) = ([0.0f64; 3], 0);
    grid.each(|v, n| {
        let lanes = color(v).lanes();
        sums.iter_mut().zip(lanes).for_each(|(sum, lane)| *sum += f64::from(lane) * n as f64);
        count += n;
    });
    Color::from_lanes(sums.map(|sum| (sum / count.max(1) as f64) as f32))
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
            Self::Grid(grid) => grid.largest_of([[0; 3], grid.size.map(|n| n - 1)], trace),
        }
    }
}
