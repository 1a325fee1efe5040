//! Upper bounds of a medium's extinction along a ray.

use super::{Beyond, Grid, Nodes, Reading, Volume};
use crate::math::{Affine, Color, Ray, Vec3};

/// Values of a grid that one cell of majorants spans on an axis, and cells on an axis at most.
const SPAN: u32 = 8;
const MOST: u32 = 64;

/// Upper bounds of the extinction over all lanes, by the cells of a box.
#[derive(Clone, Debug)]
pub struct Majorants {
    /// From the world to the box, which is the unit cube; without it, there is one cell without an end.
    to_local: Option<Affine>,
    size: [u32; 3],
    /// x fastest.
    values: Vec<f32>,
}

/// A part of a ray and a bound of the extinction there.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Where it begins, in units of the ray's direction.
    pub begin: f32,
    /// Where it ends.
    pub end: f32,
    /// Per unit of length of the scene, however long the direction is.
    pub majorant: f32,
}

impl Majorants {
    /// Of a volume times `factor`.
    pub fn new(volume: &Volume, factor: f32) -> Self {
        match (volume, volume.end()) {
            (Volume::Grid(grid, tint), Some(to_local)) => {
                let size = grid.size.map(|n| n.div_ceil(SPAN).min(MOST));
                let bound = |v: &[f32]| {
                    let value = Color::from_lanes(std::array::from_fn(|c| v[c.min(v.len() - 1)]));
                    (value * *tint).max_element() * factor
                };
                let ranges: [Vec<[u32; 2]>; 3] = std::array::from_fn(|axis| {
                    (0..size[axis]).map(|c| reach(c, size[axis], grid.size[axis], &grid.reading)).collect()
                });
                let values = largest(grid, bound, &ranges);
                Self { to_local: Some(to_local), size, values }
            }
            (_, to_local) => Self { to_local, size: [1; 3], values: vec![volume.largest() * factor] },
        }
    }

    /// The parts of the ray in the box, in order; gaps are outside of it.
    pub fn along(&self, ray: &Ray) -> Segments<'_> {
        let Some(m) = &self.to_local else {
            return Segments::everywhere(self, ray);
        };
        let size = Vec3::from(self.size.map(|n| n as f32));
        let o = m.transform_point3a(ray.o) * size;
        let d = m.transform_vector3a(ray.d) * size;
        let (mut begin, mut end) = (0.0f32, ray.tmax);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if !(0.0..=size[axis]).contains(&o[axis]) {
                    end = -1.0;
                }
                continue;
            }
            let (a, b) = (-o[axis] / d[axis], (size[axis] - o[axis]) / d[axis]);
            begin = begin.max(a.min(b));
            end = end.min(a.max(b));
        }
        let p = o + d * begin;
        let cell = std::array::from_fn(|a| (p[a].floor() as i32).clamp(0, self.size[a] as i32 - 1));
        Segments { majorants: self, o, d, cell, t: begin, end, done: begin >= end || !p.is_finite() }
    }

    /// The bound at a distance along the ray; 0 outside of the box.
    pub fn at(&self, ray: &Ray, t: f32) -> f32 {
        self.along(ray).find(|part| t < part.end).map_or(0.0, |part| part.majorant)
    }

    /// The greatest bound.
    pub fn largest(&self) -> f32 {
        self.values.iter().copied().fold(0.0, f32::max)
    }
}

/// First and last node that matter in cell `c` of `cells` along an axis with `n` nodes.
fn reach(c: u32, cells: u32, n: u32, reading: &Reading) -> [u32; 2] {
    let at = |edge: u32| {
        let local = f64::from(edge) / f64::from(cells);
        match reading.nodes {
            Nodes::Centers => local * f64::from(n) - 0.5,
            Nodes::Corners => local * f64::from(n - 1),
        }
    };
    // Rounding may put a point of the next cell here: one node more.
    let (low, high) = ((at(c) - 1e-3).floor(), (at(c + 1) + 1e-3).ceil());
    let last = n - 1;
    if reading.beyond == Beyond::Repeat && (low < 0.0 || high > f64::from(last)) {
        return [0, last];
    }
    [(low.max(0.0) as u32).min(last), (high.max(0.0) as u32).min(last)]
}

fn largest(grid: &Grid, bound: impl Fn(&[f32]) -> f32, ranges: &[Vec<[u32; 2]>; 3]) -> Vec<f32> {
    let mut values = Vec::new();
    for &[z0, z1] in &ranges[2] {
        for &[y0, y1] in &ranges[1] {
            for &[x0, x1] in &ranges[0] {
                values.push(grid.largest_of([[x0, y0, z0], [x1, y1, z1]], &bound));
            }
        }
    }
    values
}

/// See [`Majorants::along`].
#[derive(Clone, Debug)]
pub struct Segments<'a> {
    majorants: &'a Majorants,
    /// In cells.
    o: Vec3,
    d: Vec3,
    cell: [i32; 3],
    t: f32,
    end: f32,
    done: bool,
}

/// Optical depth of the bound at which a ray without an end has come to one: nothing is left there, but of lanes that
/// are not extinguished.
const DEEPEST: f32 = 1e4;

impl<'a> Segments<'a> {
    /// One segment: no end but the ray's.
    fn everywhere(majorants: &'a Majorants, ray: &Ray) -> Self {
        let unit = ray.d.length();
        let end = if ray.tmax.is_finite() { ray.tmax } else { DEEPEST / (majorants.values[0] * unit) };
        Self {
            majorants,
            o: Vec3::ZERO,
            d: Vec3::ZERO,
            cell: [0; 3],
            t: 0.0,
            end,
            done: end <= 0.0 || end.is_nan(),
        }
    }

    /// The part of the ray that is in the box; `None` of one that misses it.
    pub fn range(&self) -> Option<[f32; 2]> {
        (!self.done).then_some([self.t, self.end])
    }

    /// Where the ray leaves the cell, and through which axis.
    #[inline(always)]
    fn leave(&self) -> (f32, usize) {
        let mut first = (f32::INFINITY, 0);
        for axis in 0..3 {
            let d = self.d[axis];
            if d != 0.0 {
                let plane = (self.cell[axis] + i32::from(d > 0.0)) as f32;
                let t = (plane - self.o[axis]) / d;
                if t < first.0 {
                    first = (t, axis);
                }
            }
        }
        first
    }
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        if self.done {
            return None;
        }
        let size = self.majorants.size;
        let [x, y, z] = self.cell.map(|c| c as usize);
        let majorant = self.majorants.values[(z * size[1] as usize + y) * size[0] as usize + x];
        let (t, axis) = self.leave();
        let begin = self.t;
        let end = t.clamp(begin, self.end);
        self.t = end;
        self.cell[axis] += if self.d[axis] > 0.0 { 1 } else { -1 };
        self.done = end >= self.end || !(0..size[axis] as i32).contains(&self.cell[axis]);
        Some(Segment { begin, end, majorant })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::medium::Values;
    use crate::sampling::{CounterRng, warp};

    fn grid(beyond: Beyond, nodes: Nodes) -> Volume {
        let mut rng = CounterRng::new(3, 5);
        let size = [37, 9, 20];
        // Few large values among small ones.
        let data = (0..size.iter().product()).map(|_| rng.next_f32().powi(20)).collect();
        let to_local = Affine::from_scale(glam::Vec3::new(0.5, 0.25, 1.0)) * Affine::from_rotation_z(0.4);
        let reading = Reading { to_local, nodes, beyond, clipped: true, smooth: true };
        Volume::Grid(
            Arc::new(Grid { size, channels: 1, values: Values::Dense(data), reading }),
            Color::splat(3.0),
        )
    }

    /// Along rays through the box the extinction is nowhere above the bound of its segment (but by what f32 rounds),
    /// and outside of the segments it is 0.
    #[test]
    fn no_extinction_is_above_its_majorant() {
        let kinds = [
            (Beyond::Zero, Nodes::Corners),
            (Beyond::Clamp, Nodes::Centers),
            (Beyond::Repeat, Nodes::Centers),
        ];
        for (beyond, nodes) in kinds {
            let volume = grid(beyond, nodes);
            let majorants = Majorants::new(&volume, 2.0);
            assert_eq!(majorants.size, [5, 2, 3]);
            let mut rng = CounterRng::new(7, 1);
            let mut inside = 0;
            for _ in 0..400 {
                let o = warp::sphere(rng.next_2d().into()) * 5.0;
                let ray = Ray { o, d: warp::sphere(rng.next_2d().into()) * 2.0 - o, tmax: 1.3 };
                let parts: Vec<_> = majorants.along(&ray).collect();
                for pair in parts.windows(2) {
                    assert_eq!(pair[0].end, pair[1].begin);
                }
                for i in 0..500 {
                    let t = ray.tmax * i as f32 / 500.0;
                    let value = volume.color(ray.at(t)).lanes()[0] * 2.0;
                    let bound =
                        parts.iter().find(|s| (s.begin..s.end).contains(&t)).map_or(0.0, |s| s.majorant);
                    assert!(value <= bound * 1.001 + 1e-6, "{beyond:?}: {value} above {bound}");
                    inside += u32::from(value > 0.0);
                }
            }
            assert!(inside > 1000);
        }
    }

    #[test]
    fn a_constant_has_one_segment_that_ends() {
        let majorants = Majorants::new(&Volume::Constant(Color::splat(4.0)), 0.5);
        let ray = Ray { o: Vec3::ZERO, d: Vec3::X * 2.0, tmax: f32::INFINITY };
        let parts: Vec<_> = majorants.along(&ray).collect();
        assert_eq!(parts.len(), 1);
        assert_eq!((parts[0].majorant, parts[0].end), (2.0, 0.25 * DEEPEST));
    }
}
