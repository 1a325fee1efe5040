//! Numbers on the nodes of a box.

use super::Values;
use crate::math::{Affine, Vec3};

/// What lies beyond the outermost values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// Nothing: 0.
    Zero,
    /// The outermost value.
    Clamp,
    /// The box again.
    Repeat,
    /// The box reflected.
    Mirror,
}

/// Where the values are in their box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodes {
    /// In the middle of cells.
    Centers,
    /// On the border too: the first and the last value of an axis are on opposite faces.
    Corners,
}

/// How a [`Grid`] is read.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// From the world to the box, which is the unit cube.
    pub to_local: Affine,
    /// Where the values are.
    pub nodes: Nodes,
    /// What lies beyond.
    pub beyond: Beyond,
    /// Outside of the box everything is 0, whatever lies beyond the outermost values inside.
    pub clipped: bool,
    /// Straight lines between values; otherwise the nearest.
    pub smooth: bool,
}

/// Values in a box: of one, three or six channels.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Values along the axes of the box, none 0.
    pub size: [u32; 3],
    /// Numbers a value.
    pub channels: u32,
    /// The numbers.
    pub values: Values,
    /// See there.
    pub reading: Reading,
}

impl Grid {
    /// The value at a point of the world.
    #[inline]
    pub fn at<const N: usize>(&self, p: Vec3) -> [f32; N] {
        let local = self.reading.to_local.transform_point3a(p);
        let inside = local.cmpge(Vec3::ZERO).all() && local.cmple(Vec3::ONE).all();
        if !inside && (self.reading.clipped || !local.is_finite()) {
            return [0.0; N];
        }
        let size = Vec3::from(self.size.map(|n| n as f32));
        let x = match self.reading.nodes {
            Nodes::Centers => local * size - 0.5,
            Nodes::Corners => local * (size - 1.0),
        };
        if !self.reading.smooth {
            // The nearest node, the upper one half way.
            let i = (x + 0.5).floor();
            return self.node([i.x as i64, i.y as i64, i.z as i64]);
        }
        let floor = x.floor();
        let t = x - floor;
        let i = [floor.x as i64, floor.y as i64, floor.z as i64];
        let mut sum = [0.0; N];
        for corner in 0..8 {
            let bit = |axis: usize| i64::from(corner >> axis & 1 == 1);
            let weight: f32 = (0..3).map(|a| if bit(a) == 1 { t[a] } else { 1.0 - t[a] }).product();
            if weight > 0.0 {
                let value: [f32; N] = self.node([i[0] + bit(0), i[1] + bit(1), i[2] + bit(2)]);
                sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
            }
        }
        sum
    }

    /// The value at a node, by what lies beyond.
    #[inline]
    fn node<const N: usize>(&self, i: [i64; 3]) -> [f32; N] {
        let mut point = [0; 3];
        for axis in 0..3 {
            let n = i64::from(self.size[axis]);
            let Some(k) = wrap(i[axis], n, self.reading.beyond) else { return [0.0; N] };
            point[axis] = k as u32;
        }
        self.values.at(self.size, self.channels, point)
    }

    /// Calls `f` for all nodes: with the numbers of one, and with how many nodes have them.
    pub fn each(&self, f: impl FnMut(&[f32], u64)) {
        self.values.each((self.size, self.channels), [[0; 3], self.size.map(|n| n - 1)], f);
    }

    /// The greatest `f` of a node between the two, both included; 0 at least.
    pub fn largest_of(&self, nodes: [[u32; 3]; 2], f: impl Fn(&[f32]) -> f32) -> f32 {
        let mut most = 0.0f32;
        self.values.each((self.size, self.channels), nodes, |v, _| most = most.max(f(v)));
        most
    }

    /// The greatest number of any channel.
    pub fn largest(&self) -> f32 {
        let mut most = 0.0;
        self.each(|v, _| most = v.iter().copied().fold(most, f32::max));
        most
    }

    /// Replaces numbers that are negative or NaN by 0, and those above `most` by it. Returns how many there were.
    pub fn clean(&mut self, most: f32) -> usize {
        let mut cleaned = 0;
        for v in self.values.numbers() {
            if !(*v >= 0.0 && *v <= most) {
                *v = if *v > most { most } else { 0.0 };
                cleaned += 1;
            }
        }
        cleaned
    }
}

#[inline]
fn wrap(i: i64, n: i64, beyond: Beyond) -> Option<i64> {
    match beyond {
        _ if (0..n).contains(&i) => Some(i),
        Beyond::Zero => None,
        Beyond::Clamp => Some(i.clamp(0, n - 1)),
        Beyond::Repeat => Some(i.rem_euclid(n)),
        Beyond::Mirror => {
            let k = i.rem_euclid(2 * n);
            Some(if k < n { k } else { 2 * n - 1 - k })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a linear function; lines between nodes give it back.
    fn ramp(nodes: Nodes, beyond: Beyond, clipped: bool, smooth: bool) -> Grid {
        let reading = Reading { to_local: Affine::IDENTITY, nodes, beyond, clipped, smooth };
        let data = (0..60).map(|i| (i % 3) as f32 + 10.0 * (i / 3 % 4) as f32 + 100.0 * (i / 12) as f32);
        Grid { size: [3, 4, 5], channels: 1, values: Values::Dense(data.collect()), reading }
    }

    fn read(grid: &Grid, p: [f32; 3]) -> f32 {
        grid.at::<1>(Vec3::from(p))[0]
    }

    #[test]
    fn values_between_nodes_lie_on_straight_lines() {
        let centers = ramp(Nodes::Centers, Beyond::Clamp, true, true);
        let corners = ramp(Nodes::Corners, Beyond::Zero, true, true);
        for p in [[0.5, 0.5, 0.5], [0.3, 0.6, 0.2], [0.2, 0.8, 0.85]] {
            let [x, y, z] = [p[0] * 3.0 - 0.5, p[1] * 4.0 - 0.5, p[2] * 5.0 - 0.5];
            assert!((read(&centers, p) - (x + 10.0 * y + 100.0 * z)).abs() < 1e-3, "{p:?}");
            let [x, y, z] = [p[0] * 2.0, p[1] * 3.0, p[2] * 4.0];
            assert!((read(&corners, p) - (x + 10.0 * y + 100.0 * z)).abs() < 1e-3, "{p:?}");
        }
        assert_eq!(read(&corners, [1.0, 1.0, 1.0]), 432.0);
    }

    #[test]
    fn beyond_the_outermost_values_lies_what_was_asked_for() {
        let at = |beyond| read(&ramp(Nodes::Centers, beyond, true, true), [0.0, 0.5, 0.5]);
        // Half way between node −1 and node 0 of x, y = 1.5 and z = 2.
        let middle = 215.0;
        assert_eq!(at(Beyond::Zero), 0.5 * middle);
        assert_eq!(at(Beyond::Clamp), middle);
        assert_eq!(at(Beyond::Repeat), middle + 1.0);
        assert_eq!(at(Beyond::Mirror), middle);
        let far = |clipped| read(&ramp(Nodes::Centers, Beyond::Clamp, clipped, true), [-2.0, 0.5, 0.5]);
        assert_eq!((far(true), far(false)), (0.0, middle));
        let nearest = ramp(Nodes::Centers, Beyond::Clamp, true, false);
        assert_eq!(read(&nearest, [0.9, 0.1, 0.1]), 2.0);
    }

    #[test]
    fn numbers_that_mean_nothing_are_replaced_and_counted() {
        let mut grid = ramp(Nodes::Centers, Beyond::Clamp, true, true);
        let numbers = [f32::NAN, -1.0, f32::INFINITY, 1e30];
        grid.values.numbers().zip(numbers).for_each(|(v, bad)| *v = bad);
        assert_eq!(grid.clean(1e6), 4);
        assert_eq!(grid.values.dense().unwrap()[..4], [0.0, 0.0, 1e6, 1e6]);
        assert_eq!(grid.clean(1e6), 0);
    }

    /// A grid in bricks, of which all but two are constant, reads as the dense one with the same numbers does, and so do
    /// its sums and bounds. It begins inside a brick.
    #[test]
    fn bricks_read_as_dense_values_do() {
        let (size, offset, count) = ([21u32, 10, 13], [3u32, 0, 6], [3u32, 2, 3]);
        let mut index: Vec<u32> = (0..18).map(|i| (1 << 31) | (i % 3)).collect();
        (index[4], index[13]) = (0, 1);
        let full = (0..2).map(|b| std::array::from_fn(|i| (i * 7 % 31) as f32 + b as f32)).collect();
        let bricks = crate::medium::Bricks { offset, count, index, full, constants: vec![0.0, 2.5, 40.0] };
        let reading = ramp(Nodes::Centers, Beyond::Clamp, true, true).reading;
        let sparse = Grid { size, channels: 1, values: Values::Sparse(bricks), reading };
        let mut data = Vec::new();
        for z in 0..size[2] {
            for y in 0..size[1] {
                data.extend((0..size[0]).map(|x| sparse.values.at::<1>(size, 1, [x, y, z])[0]));
            }
        }
        let dense = Grid { size, channels: 1, values: Values::Dense(data), reading };
        let mut rng = crate::sampling::CounterRng::new(31, 0);
        for _ in 0..2000 {
            let p = std::array::from_fn(|_| rng.next_f32());
            assert_eq!(read(&sparse, p), read(&dense, p));
            let corner = |u: [f32; 3]| std::array::from_fn(|a| (u[a] * size[a] as f32) as u32);
            let (a, b): ([u32; 3], [u32; 3]) = (corner(p), corner(std::array::from_fn(|_| rng.next_f32())));
            let nodes = [std::array::from_fn(|i| a[i].min(b[i])), std::array::from_fn(|i| a[i].max(b[i]))];
            assert_eq!(sparse.largest_of(nodes, |v| v[0]), dense.largest_of(nodes, |v| v[0]));
        }
        let sum = |grid: &Grid| {
            let (mut sum, mut nodes) = (0.0, 0);
            grid.each(|v, n| (sum, nodes) = (sum + f64::from(v[0]) * n as f64, nodes + n));
            (sum, nodes)
        };
        assert_eq!(sum(&sparse), sum(&dense));
        assert_eq!(sum(&sparse).1, 21 * 10 * 13);
    }
}
