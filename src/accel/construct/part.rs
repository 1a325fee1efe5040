//! Many boxes in a few parts, whose trees are built side by side.

use obvhs::aabb::Aabb;

use crate::math::Vec3;
use crate::math::simd::WIDTH;

/// Fewest boxes of which a part is worth the work of separating it.
const SMALLEST: usize = 1 << 12;

/// Places at which a part may be cut along an axis.
const BINS: usize = 32;

/// Up to as many parts as a node has lanes, each the indices of its boxes; `None` is all boxes. They are cut where
/// the surface area heuristic would cut them (MacDonald and Booth 1990, binned as by Wald 2007), which depends on
/// the boxes only.
pub fn parts(boxes: &[Aabb]) -> Vec<Option<Vec<u32>>> {
    if boxes.len() < 2 * SMALLEST {
        return vec![None];
    }
    let mut out = Vec::new();
    split(boxes, (0..boxes.len() as u32).collect(), WIDTH, &mut out);
    out.into_iter().map(Some).collect()
}

fn split(boxes: &[Aabb], items: Vec<u32>, most: usize, out: &mut Vec<Vec<u32>>) {
    let cut = if most < 2 || items.len() < 2 * SMALLEST { None } else { best_cut(boxes, &items) };
    let Some(cut) = cut else {
        out.push(items);
        return;
    };
    let (below, above): (Vec<u32>, Vec<u32>) = items.iter().partition(|&&i| cut.is_below(&boxes[i as usize]));
    // By their share, but at least one each.
    let share = (most * below.len()).div_euclid(items.len()).clamp(1, most - 1);
    drop(items);
    let mut others = Vec::new();
    rayon::join(|| split(boxes, below, share, out), || split(boxes, above, most - share, &mut others));
    out.append(&mut others);
}

/// Between two bins of an axis.
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

/// Twice the centre.
fn middle(b: &Aabb) -> Vec3 {
    b.min + b.max
}

fn bin(x: f32, from: f32, per_bin: f32) -> usize {
    // The cast saturates.
    (((x - from) * per_bin) as usize).min(BINS - 1)
}

/// The cut of least cost, if the centres differ at all.
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

/// Of a cut before every bin, unless it would leave one side empty.
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
