//! A piecewise constant density over the four-dimensional unit cube, learned from samples.

mod learn;

pub use learn::{Found, Grown};

/// Coordinates of a point of the cube.
pub const AXES: usize = 4;

/// A tree of boxes, split along one axis at a time. Numbers are mapped to points monotonically along each axis, so that
/// stratified numbers stay stratified.
#[derive(Clone, Debug)]
pub struct Bins {
    nodes: Vec<Node>,
}

/// Either a split, or a box of constant density.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Where it is split.
    split: f32,
    /// Probability of the lower half given the node; of a box, its density.
    share: f32,
    axis: u32,
    /// Of the lower half, which the upper one follows; 0 for a box.
    child: u32,
}

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl Bins {
    /// The same density everywhere.
    pub fn even() -> Self {
        Self { nodes: vec![Node { split: 0.0, share: 1.0, axis: 0, child: 0 }] }
    }

    /// The point that the uniform numbers `u` select, and the density there.
    #[inline]
    pub fn sample(&self, mut u: [f32; AXES]) -> ([f32; AXES], f32) {
        let (mut low, mut high) = ([0.0f32; AXES], [1.0f32; AXES]);
        let mut node = self.nodes[0];
        while node.child != 0 {
            let axis = node.axis as usize % AXES;
            let x = u[axis];
            let upper = x >= node.share;
            if upper {
                low[axis] = node.split;
                u[axis] = ((x - node.share) / (1.0 - node.share)).min(BELOW_ONE);
            } else {
                high[axis] = node.split;
                u[axis] = (x / node.share).min(BELOW_ONE);
            }
            node = self.nodes[node.child as usize + usize::from(upper)];
        }
        let at = std::array::from_fn(|i| (low[i] + u[i] * (high[i] - low[i])).min(BELOW_ONE));
        (at, node.share)
    }

    /// The density at a point.
    pub fn density(&self, at: [f32; AXES]) -> f32 {
        let mut node = self.nodes[0];
        while node.child != 0 {
            let upper = at[node.axis as usize % AXES] >= node.split;
            node = self.nodes[node.child as usize + usize::from(upper)];
        }
        node.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::CounterRng;

    /// Samples with all value within a box of the sides 0.1, 0.1, 0.3 and 1.
    fn found() -> Vec<Found> {
        let mut rng = CounterRng::new(3, 1);
        let inside = |at: [f32; AXES]| {
            (0.2..0.3).contains(&at[0]) && (0.6..0.7).contains(&at[1]) && (0.1..0.4).contains(&at[2])
        };
        let one = |_| {
            let ([a, b], [c, d]) = (rng.next_2d(), rng.next_2d());
            let at = [a, b, c, d];
            Found { at, weight: 1.0, value: if inside(at) { 1.0 } else { 0.0 }, cost: 1.0 }
        };
        (0..1 << 17).map(one).collect()
    }

    /// The weights of samples add up to the volume of any part of the cube: 2¹⁸ samples of weights below 5 leave errors
    /// of √(5·V/2¹⁸), and the bound is 4.5 of them.
    #[test]
    fn learned_samples_are_unbiased_and_stay_within_the_bound() {
        let bins = Grown::new(&found()).close(0.2);
        let boxes = bins.nodes.iter().filter(|node| node.child == 0).count();
        assert!(boxes > 4, "{boxes}");
        let mut rng = CounterRng::new(5, 0);
        let n = 1 << 18;
        let (mut whole, mut half, mut inside) = (0.0f64, 0.0f64, 0);
        for _ in 0..n {
            let ([a, b], [c, d]) = (rng.next_2d(), rng.next_2d());
            let (at, density) = bins.sample([a, b, c, d]);
            assert!(at.iter().all(|x| (0.0..1.0).contains(x)));
            let weight = 1.0 / f64::from(density);
            assert!(weight <= 5.001, "{weight}");
            whole += weight / f64::from(n);
            half += if at[3] < 0.5 { weight / f64::from(n) } else { 0.0 };
            inside += u32::from((0.2..0.3).contains(&at[0]) && (0.6..0.7).contains(&at[1]));
        }
        let bound = |volume: f64| 4.5 * (5.0 * volume / f64::from(n)).sqrt();
        assert!((whole - 1.0).abs() < bound(1.0), "{whole}");
        assert!((half - 0.5).abs() < bound(0.5), "{half}");
        // A fifth is even; most of the rest belongs to a box that holds a hundredth of the cube.
        assert!(f64::from(inside) > 0.5 * f64::from(n), "{inside}");
    }

    /// What `density` says of a point is what `sample` said of it, but for points that rounding put on a boundary.
    #[test]
    fn the_density_of_a_sample_is_that_of_its_place() {
        let bins = Grown::new(&found()).close(0.2);
        let mut rng = CounterRng::new(6, 0);
        let n = 1 << 14;
        let differs = |_: &u32| {
            let ([a, b], [c, d]) = (rng.next_2d(), rng.next_2d());
            let (at, density) = bins.sample([a, b, c, d]);
            bins.density(at) != density
        };
        let different = (0..n).filter(differs).count();
        assert!(different <= 2, "{different}");
    }
}
