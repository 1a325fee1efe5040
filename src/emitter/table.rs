use crate::math::Vec2;
use crate::sampling::{Discrete, Guide};

/// Chooses a cell of a rectangular grid in proportion to its weight.
#[derive(Clone, Debug)]
pub struct Table {
    width: usize,
    rows: Discrete,
    /// Of each row, the normalised cumulative sums without the leading 0. f32 serves, because densities
    /// are computed from the weights themselves: what rounds away is 10⁻⁷ of a row's light.
    columns: Vec<f32>,
    guide: Guide,
}

impl Table {
    /// Weights must be finite and non-negative.
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64) -> Self {
        let mut columns = Vec::with_capacity(width * height);
        let mut sums = Vec::with_capacity(height);
        for y in 0..height {
            let total: f64 = (0..width).map(|x| weight(x, y)).sum();
            let mut sum = 0.0;
            for x in 0..width {
                sum += if total > 0.0 { weight(x, y) / total } else { 1.0 / width as f64 };
                columns.push(if x + 1 == width { 1.0 } else { sum as f32 });
            }
            sums.push(total);
        }
        let guide = Guide::new(&columns, width);
        Self { width, rows: Discrete::new(sums), columns, guide }
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    /// Column, row, and the two numbers rescaled to [0, 1) within the cell.
    pub fn sample(&self, u: Vec2) -> (usize, usize, Vec2) {
        let (y, rest_y) = self.rows.sample(u.y);
        let row = &self.columns[y * self.width..(y + 1) * self.width];
        let x = self.guide.count(&self.columns, y, u.x).min(self.width - 1);
        let low = if x == 0 { 0.0 } else { row[x - 1] };
        let rest_x = ((u.x - low) / (row[x] - low)).clamp(0.0, 1.0 - f32::EPSILON);
        (x, y, Vec2::new(if rest_x.is_nan() { 0.5 } else { rest_x }, rest_y))
    }

    /// Memory of the table.
    pub fn bytes(&self) -> usize {
        size_of_val(self.columns.as_slice()) + self.guide.bytes()
    }
}

/// Density proportional to a + (b − a)x on [0, 1].
pub fn linear(u: f32, a: f32, b: f32) -> f32 {
    let root = (a * a + (b * b - a * a) * u).max(0.0).sqrt();
    if a + root > 0.0 { (u * (a + b) / (a + root)).min(1.0) } else { u }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_chosen_by_weight_and_empty_ones_never() {
        let weights = [[0.0, 1.0, 3.0], [0.0, 0.0, 0.0], [2.0, 0.0, 2.0]];
        let table = Table::new(3, 3, |x, y| weights[y][x]);
        let n = 256;
        let at = |i: usize| (i as f32 + 0.5) / n as f32;
        let mut counts = [[0.0; 3]; 3];
        for i in 0..n * n {
            let (x, y, rest) = table.sample(Vec2::new(at(i % n), at(i / n)));
            assert!((0.0..1.0).contains(&rest.x) && (0.0..1.0).contains(&rest.y));
            counts[y][x] += table.total() / (n * n) as f64;
        }
        assert_eq!(counts, weights);
    }

    /// Quantiles of the density 2x/(a + b)…: the cumulative a·x + (b − a)x²/2 over its value at 1.
    #[test]
    fn the_linear_warp_inverts_its_cumulative() {
        for (a, b) in [(0.0, 1.0), (2.0, 0.5), (1.0, 1.0)] {
            for u in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let x = linear(u, a, b);
                let cumulative = (a * x + (b - a) * x * x * 0.5) / (0.5 * (a + b));
                assert!((cumulative - u).abs() < 1e-6, "{a} {b} {u}: {x}");
            }
        }
    }
}
