//! Reconstruction filters by importance sampling: a sample is drawn from |filter| and carries its sign,
//! so every sample belongs to one pixel and pixels never wait for each other (Ernst, Stamminger,
//! Greiner 2006). The expectation equals Mitsuba's Σw·f/Σw.

mod cubic;
mod gaussian;
mod lanczos;
mod polynomial;

pub use cubic::{Cubic, Stretched};
pub use gaussian::{Gaussian, Truncated};
pub use lanczos::{Lanczos, Sinc};
pub use polynomial::{Box, Tent};

use crate::math::{Vec2, closed_enum};

closed_enum! {
    /// One axis of a separable filter. Distances are in pixels.
    pub trait Profile {
        /// Half of the support: the weight is 0 beyond. Positive.
        fn radius(&self) -> f64;

        /// Weight at distance `x` from the pixel's centre, |x| ≤ `radius`; symmetric, may be negative, in any scale.
        fn weight(&self, x: f64) -> f64;

        /// Whether all weights are the same: such a filter needs no table.
        fn is_even(&self) -> bool {
            false
        }
    }

    /// Every filter.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum Shape {
        Box(Box),
        Tent(Tent),
        Gaussian(Gaussian),
        Cubic(Cubic),
        Lanczos(Lanczos),
        /// pbrt's, which may be wider on one axis.
        Truncated(Truncated),
        Stretched(Stretched),
        Sinc(Sinc),
    }
}

/// Cells of the inversion table per axis; the density is linear within none, so offsets are exact to
/// 1/512 of the support, far below a pixel.
const CELLS: usize = 512;

/// A filter ready for sampling.
#[derive(Clone, Debug)]
pub struct Filter {
    axes: [Axis; 2],
}

/// One axis of a filter.
#[derive(Clone, Debug)]
struct Axis {
    shape: Shape,
    radius: f32,
    even: bool,
    cdf: Vec<f32>,
    signs: Vec<f32>,
    /// For each of [`CELLS`] equal parts of u, the cell it begins in: the search is a step or two.
    guide: Vec<u16>,
}

impl Filter {
    /// The same on both axes.
    pub fn new(shape: Shape) -> Self {
        Self::separable(shape, shape)
    }

    /// The product of two filters.
    pub fn separable(x: Shape, y: Shape) -> Self {
        Self { axes: [Axis::new(x), Axis::new(y)] }
    }

    /// Along x and along y.
    pub fn shapes(&self) -> [Shape; 2] {
        [self.axes[0].shape, self.axes[1].shape]
    }

    /// Offset from the pixel's centre and the weight of the sample; the mean weight is 1.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (x, wx) = self.axes[0].sample(u.x);
        let (y, wy) = self.axes[1].sample(u.y);
        (Vec2::new(x, y), wx * wy)
    }

    /// Density of [`Filter::sample`] at an offset, per squared pixel, and the weight of such a sample.
    pub fn density(&self, offset: Vec2) -> (f32, f32) {
        let (x, wx) = self.axes[0].density(offset.x);
        let (y, wy) = self.axes[1].density(offset.y);
        (x * y, wx * wy)
    }
}

impl Axis {
    /// Density and weight of the samples that are this far from the pixel's centre.
    fn density(&self, x: f32) -> (f32, f32) {
        let place = (x / self.radius + 1.0) * 0.5;
        if !(0.0..1.0).contains(&place) {
            return (0.0, 0.0);
        }
        let width = 2.0 * self.radius;
        if self.even {
            return (1.0 / width, 1.0);
        }
        let i = ((place * CELLS as f32) as usize).min(CELLS - 1);
        ((self.cdf[i + 1] - self.cdf[i]) * CELLS as f32 / width, self.signs[i])
    }

    fn new(shape: Shape) -> Self {
        let radius = shape.radius();
        let weights: Vec<f64> = (0..CELLS)
            .map(|i| shape.weight(((i as f64 + 0.5) / CELLS as f64 * 2.0 - 1.0) * radius))
            .collect();
        let absolute: f64 = weights.iter().map(|w| w.abs()).sum();
        let signed: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let mut cdf = vec![0.0f32];
        for w in &weights {
            sum += w.abs() / absolute;
            cdf.push(sum as f32);
        }
        cdf[CELLS] = 1.0;
        let scale = (absolute / signed) as f32;
        let signs = weights.iter().map(|w| scale.copysign(*w as f32)).collect();
        let guide = (0..CELLS)
            .map(|i| (cdf.partition_point(|&c| c <= i as f32 / CELLS as f32).max(1) - 1) as u16)
            .collect();
        Self { shape, radius: radius as f32, even: shape.is_even(), cdf, signs, guide }
    }

    #[inline]
    fn sample(&self, u: f32) -> (f32, f32) {
        if self.even {
            return ((u * 2.0 - 1.0) * self.radius, 1.0);
        }
        let mut i = usize::from(self.guide[((u * CELLS as f32) as usize).min(CELLS - 1)]);
        while i < CELLS - 1 && self.cdf[i + 1] <= u {
            i += 1;
        }
        let width = self.cdf[i + 1] - self.cdf[i];
        let inside = if width > 0.0 { ((u - self.cdf[i]) / width).clamp(0.0, 1.0) } else { 0.5 };
        let x = (i as f32 + inside) / CELLS as f32 * 2.0 - 1.0;
        (x * self.radius, self.signs[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of 2¹⁶ regular samples against the filter's own by quadrature; both discretise the
    /// support into at least 512 cells, so they agree to (radius/512)².
    #[test]
    fn samples_have_the_filters_mean_weight_and_second_moment() {
        let all = [
            ("box", Shape::Box(Box { radius: 0.5 })),
            ("tent", Shape::Tent(Tent { radius: 1.0 })),
            ("gaussian", Shape::Gaussian(Gaussian { stddev: 0.5 })),
            ("mitchell", Shape::Cubic(Cubic { b: 1.0 / 3.0, c: 1.0 / 3.0 })),
            ("catmullrom", Shape::Cubic(Cubic { b: 0.0, c: 0.5 })),
            ("lanczos", Shape::Lanczos(Lanczos { lobes: 3 })),
            ("truncated", Shape::Truncated(Truncated { sigma: 0.5, radius: 1.5 })),
            ("stretched", Shape::Stretched(Stretched { cubic: Cubic { b: 0.3, c: 0.3 }, radius: 1.2 })),
            ("sinc", Shape::Sinc(Sinc { tau: 3.0, radius: 4.0 })),
        ];
        for (name, shape) in all {
            let filter = Axis::new(shape);
            let n = 1 << 16;
            let (mut mass, mut square) = (0.0f64, 0.0f64);
            for i in 0..n {
                let (x, w) = filter.sample((i as f32 + 0.5) / n as f32);
                mass += f64::from(w) / f64::from(n);
                square += f64::from(w * x * x) / f64::from(n);
            }
            let r = shape.radius();
            let steps = 100_000;
            let (mut m0, mut m2) = (0.0, 0.0);
            for i in 0..steps {
                let x = ((f64::from(i) + 0.5) / f64::from(steps) * 2.0 - 1.0) * r;
                m0 += shape.weight(x);
                m2 += shape.weight(x) * x * x;
            }
            assert!((mass - 1.0).abs() < 2e-4, "{name}: {mass}");
            assert!((square - m2 / m0).abs() < (r / 512.0).powi(2) + 5e-4, "{name}: {square} {}", m2 / m0);
        }
    }

    /// Weights printed by Mitsuba 3.9.1 (its gaussian is a polynomial fit, good to 1e-3).
    #[test]
    fn gaussian_matches_mitsuba() {
        let g = Gaussian { stddev: 0.5 };
        for (x, w) in [(0.0, 0.999247), (0.5, 0.606423), (1.0, 0.134960), (1.5, 0.010758)] {
            assert!((g.weight(x) - w).abs() < 1e-3);
        }
    }
}
