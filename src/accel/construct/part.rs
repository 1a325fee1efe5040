//! Divides many boxes into a few parts, whose subtrees are built in parallel.

use obvhs::aabb::Aabb;

use crate::math::Vec3;
use crate::math::simd::WIDTH;

/// Parts smaller than this are not worth splitting off.
const SMALLEST: usize = 1 << 12;

/// Bins per axis; a part may be cut between any two.
const BINS: usize = 32;

/// Divides boxes into at most as many parts as a node has lanes, each a list of indices; `None` stands for all
/// boxes. Cuts are those of the surface area heuristic (MacDonald and Booth 1990), binned (Wald 2007), and depend
/// only on the boxes.
pub fn parts(boxes: &[Aabb]) -> Vec<Option<Vec<u32>>> {
    if boxes.len() < 2 * SMALLEST {
        return vec![None];
    }
    let mut out = Vec::new();
    split(boxes, (0..boxes.len() as u32).collect(), WIDTH, &mut out);
    out.into_iter().map(Some).collect()
}

/// Appends at most `most` parts of `items` to `out`.
fn split(boxes: &[Aabb], items: Vec<u32>, most: usize, out: &mut Vec<Vec<u32>>) {
    let cut = if most < 2 || items.len() < 2 * SMALLEST { None } else { best_cut(boxes, &items) };
    let Some(cut) = cut else {
        out.push(items);
        return;
    };
    let (below, above): (Vec<u32>, Vec<u32>) = items.iter().partition(|&&i| cut.is_below(&boxes[i as usize]));
    // Each side gets parts in proportion to its boxes, but at least one.
    let share = (most * below.len()).div_euclid(items.len()).clamp(1, most - 1);
    drop(items);
    let mut others = Vec::new();
    rayon::join(|| split(boxes, below, share, out), || split(boxes, above, most - share, &mut others));
    out.append(&mut others);
}

/// A cutting plane below bin `bin` of an axis.
struct Cut {
    axis: usize,
    from: f32,
    per_bin: f32,
    bin: usize,
}

impl Cut {
    fn is_below(&self, b: &Aabb) -> bool {
        bin(middle(b)[self.axis], self.from, self.per_bin) < self.bin
    }
}

/// Twice the centre of a box.
fn middle(b: &Aabb) -> Vec3 {
    b.min + b.max
}

/// The bin of the coordinate `x`.
fn bin(x: f32, from: f32, per_bin: f32) -> usize {
    // The cast saturates, and takes NaN to 0.
    (((x - from) * per_bin) as usize).min(BINS - 1)
}

/// The cut of least cost; `None` if all centres are equal.
fn best_cut(boxes: &[Aabb], items: &[u32]) -> Option<Cut> {
    let (mut from, mut to) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &i in items {
        let m = middle(&boxes[i as usize]);
        (from, to) = (from.min(m), to.max(m));
    }
    let per_bin = (BINS as f32 / (to - from)).to_array();
    let mut bins = [[(Aabb::INVALID, 0_usize); BINS]; 3];
    for &i in items {
        let b = &boxes[i as usize];
        let m = middle(b);
        for axis in 0..3 {
            let (bounds, count) = &mut bins[axis][bin(m[axis], from[axis], per_bin[axis])];
            *bounds = bounds.union(b);
            *count += 1;
        }
    }
    let axes = (0..3).filter(|&axis| per_bin[axis].is_finite());
    let candidates = axes.flat_map(|axis| {
        let costs = costs(&bins[axis]);
        (1..BINS).filter_map(move |bin| Some((costs[bin]?, axis, bin)))
    });
    let (_, axis, bin) = candidates.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Cut { axis, from: from[axis], per_bin: per_bin[axis], bin })
}

/// The cost of a cut below each bin; `None` if it would leave one side empty.
fn costs(bins: &[(Aabb, usize); BINS]) -> [Option<f32>; BINS] {
    let add = |(a, n): (Aabb, usize), (b, m): &(Aabb, usize)| (a.union(b), n + m);
    let mut below = [(Aabb::INVALID, 0); BINS];
    for i in 1..BINS {
        below[i] = add(below[i - 1], &bins[i - 1]);
    }
    let mut costs = [None; BINS];
    let mut above = (Aabb::INVALID, 0);
    for i in (1..BINS).rev() {
        above = add(above, &bins[i]);
        let cost = |(b, n): (Aabb, usize)| b.half_area() * n as f32;
        if below[i].1 > 0 && above.1 > 0 {
            costs[i] = Some(cost(below[i]) + cost(above));
        }
    }
    costs
}
