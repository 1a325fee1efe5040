//! Bounding volume hierarchy. The only file that names obvhs, which builds the tree; it is then
//! widened to eight boxes a node, which one instruction tests together. Primitive tests are the
//! caller's (obvhs's own lose rays aimed at shared edges).

use std::collections::{HashMap, HashSet};
use std::mem::MaybeUninit;
use std::ops::Range;

use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{BvhBuildParams, aabb::Aabb};

use crate::math::simd::{WIDTH, Wide};
use crate::math::{Bounds, Ray, Vec3};

/// Eight children: their boxes by bound (min, max), axis and lane. Unused lanes hold empty boxes.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Node {
    bounds: [[[f32; WIDTH]; 3]; 2],
    /// Node, or first element of a leaf.
    child: [u32; WIDTH],
    /// Elements of a leaf; 0 is an inner node.
    count: [u32; WIDTH],
}

impl Node {
    const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]],
        child: [0; WIDTH],
        count: [0; WIDTH],
    };
}

/// A BVH over boxes, whose leaves name elements of the caller's arrays.
#[derive(Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// All elements, when they are too few for a tree.
    flat: Option<Range<usize>>,
    /// Entries that a walk may have to remember.
    stack: usize,
}

/// obvhs's medium preset with leaves as large as the packets that primitives are tested in.
const PARAMETERS: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: WIDTH as u32,
    collapse_traversal_cost: 6.0,
    ..BvhBuildParams::medium_build()
};

/// Up to so many boxes there is no tree: testing eight packets in a row is faster than choosing among
/// them, because nothing in that loop can be mispredicted.
const FLAT: usize = 64;

/// A component of 1/d that stays finite, so that 0·inf never makes a NaN in the slab test.
fn reciprocal(d: f32) -> f32 {
    if d.abs() < 1e-30 { 1e30f32.copysign(d) } else { 1.0 / d }
}

/// Far distances grow by this factor, more than the three roundings of the slab test (Ize 2013).
const ROUNDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// What a walk does at the elements of leaves. A trait rather than a closure: only methods can be
/// forced inline into the functions that are compiled for wider instructions.
pub trait Visitor {
    /// Tests some elements, shortens the ray to what it hit, and says whether that ends the walk.
    fn test(&mut self, elements: Range<usize>, tmax: &mut f32) -> bool;
}

/// A subtree to visit, and where the ray enters it.
#[derive(Clone, Copy)]
struct Entry {
    child: u32,
    count: u32,
    t: f32,
}

/// A node of the binary tree that is yet to be put into a lane of a node.
struct Pending {
    binary: u32,
    parent: usize,
    lane: usize,
    depth: usize,
}

/// A farthest corner nearer than this has boxes scaled.
const NEAREST: f32 = 1e-6;

/// Farthest corners of all bands but the last.
const FARTHEST: [f32; 2] = [1e12, 1e25];

/// Entries kept without the heap.
const STACK: usize = 192;

/// Boxes of which so many are looked at for equal ones.
const LOOKED_AT: usize = 1024;

/// Finite boxes whose magnitudes are close enough for the areas that the builder compares in `f32`: areas that
/// overflow or are 0 are equal, and no tree can part equal ones. It pairs neighbours that prefer each other
/// two at a time, and makes a chain as deep as they are many.
struct Band {
    /// Indices of the boxes.
    items: Vec<u32>,
    /// Groups of `items` with equal boxes, unless all are taken to differ.
    groups: Option<Vec<Vec<u32>>>,
    /// What boxes are multiplied by, a power of two. Usual scenes stay as they are.
    scale: f32,
    /// One for every group, else for every item.
    boxes: Vec<Aabb>,
}

impl Band {
    /// All bands in which there are boxes.
    fn all(boxes: &[Bounds]) -> Vec<Self> {
        let mut bands: [Vec<u32>; 3] = Default::default();
        for (i, b) in (0_u32..).zip(boxes).filter(|(_, b)| b.min.is_finite() && b.max.is_finite()) {
            bands[FARTHEST.iter().filter(|&&f| b.magnitude() > f).count()].push(i);
        }
        bands.into_iter().filter(|b| !b.is_empty()).map(|items| Self::new(items, boxes)).collect()
    }

    fn new(items: Vec<u32>, boxes: &[Bounds]) -> Self {
        let far = items.iter().map(|&i| boxes[i as usize].magnitude()).fold(0.0, f32::max);
        let scale = if far == 0.0 || (NEAREST..=FARTHEST[0]).contains(&far) {
            1.0
        } else {
            (FARTHEST[0].log2() - far.log2()).floor().min(126.0).exp2()
        };
        let mut boxes: Vec<Aabb> = items.iter().map(|&i| padded(&boxes[i as usize], scale)).collect();
        let groups = equal(&boxes);
        if let Some(groups) = &groups {
            boxes = groups.iter().map(|g| boxes[g[0] as usize]).collect();
        }
        Self { items, groups, scale, boxes }
    }

    /// Indices of what has these of the band's boxes.
    fn members(&self, boxes: &[u32]) -> Vec<u32> {
        let item = |&i: &u32| self.items[i as usize];
        match &self.groups {
            Some(groups) => boxes.iter().flat_map(|&g| &groups[g as usize]).map(item).collect(),
            None => boxes.iter().map(item).collect(),
        }
    }
}

/// A box larger by a few units in the last place, so that rounding cannot lose a ray that the primitive test
/// accepts, times the scale (which may lose digits of what is nearly 0).
fn padded(b: &Bounds, scale: f32) -> Aabb {
    let lost = if scale == 1.0 { 0.0 } else { f32::MIN_POSITIVE };
    let pad = Vec3::splat(b.magnitude() * scale * 4.0 * f32::EPSILON + lost);
    Aabb { min: b.min * scale - pad, max: b.max * scale + pad }
}

/// All boxes in groups of equal ones, when many are equal.
fn equal(boxes: &[Aabb]) -> Option<Vec<Vec<u32>>> {
    let key = |b: &Aabb| [b.min, b.max].map(|v| v.to_array().map(f32::to_bits));
    let mut seen = HashSet::new();
    if boxes.iter().step_by((boxes.len() / LOOKED_AT).max(1)).all(|b| seen.insert(key(b))) {
        return None;
    }
    let mut known = HashMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for (i, b) in (0_u32..).zip(boxes) {
        let group = *known.entry(key(b)).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(i);
    }
    Some(groups)
}

impl Bvh {
    /// Builds over boxes; what has one that is not finite is left out. `pack(items)` is called for every
    /// leaf with the indices of its boxes; what it returns, a first element and a count in the caller's
    /// arrays, is what the leaf names.
    pub fn build(boxes: &[Bounds], mut pack: impl FnMut(&[u32]) -> (u32, u32)) -> Self {
        let mut bvh = Self { nodes: Vec::new(), flat: None, stack: 0 };
        let bands = Band::all(boxes);
        if bands.iter().map(|b| b.boxes.len()).sum::<usize>() <= FLAT {
            let all = |b: &Band| b.members(&(0..b.boxes.len() as u32).collect::<Vec<_>>());
            let (first, count) = pack(&bands.iter().flat_map(all).collect::<Vec<_>>());
            bvh.flat = Some(first as usize..(first + count) as usize);
            return bvh;
        }
        let mut lanes = if bands.len() > 1 { bvh.open(vec![0; bands.len()], 1) } else { Vec::new() };
        for band in &bands {
            let mut time = std::time::Duration::ZERO;
            let binary = build_bvh2(&band.boxes, PARAMETERS, &mut time);
            let pending = match lanes.pop() {
                Some(lane) => vec![lane],
                None if binary.nodes[0].is_leaf() => bvh.open(vec![0], 1),
                None => bvh.open(widened(&binary, 0), 1),
            };
            bvh.widen(&binary, pending, 1.0 / band.scale, &mut |boxes| pack(&band.members(boxes)));
        }
        bvh
    }

    /// Appends what is pending of the binary tree, depth first. A loop, since the tree may be deeper
    /// than a thread's stack allows.
    fn widen(
        &mut self,
        binary: &Bvh2,
        mut pending: Vec<Pending>,
        scale: f32,
        pack: &mut impl FnMut(&[u32]) -> (u32, u32),
    ) {
        while let Some(Pending { binary: c, parent, lane, depth }) = pending.pop() {
            let node = &binary.nodes[c as usize];
            let (child, count) = if node.is_leaf() {
                let first = node.first_index as usize;
                pack(&binary.primitive_indices[first..first + node.prim_count as usize])
            } else {
                let index = self.nodes.len() as u32;
                pending.extend(self.open(widened(binary, c), depth + 1));
                (index, 0)
            };
            let wide = &mut self.nodes[parent];
            let aabb = node.aabb();
            for axis in 0..3 {
                wide.bounds[0][axis][lane] = aabb.min[axis] * scale;
                wide.bounds[1][axis][lane] = aabb.max[axis] * scale;
            }
            (wide.child[lane], wide.count[lane]) = (child, count);
        }
    }

    /// Appends an empty node, and says what is to be put into it, last first.
    fn open(&mut self, children: Vec<u32>, depth: usize) -> Vec<Pending> {
        let parent = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        self.stack = self.stack.max(depth * (WIDTH - 1) + 1);
        let lanes = children.into_iter().enumerate();
        lanes.map(|(lane, binary)| Pending { binary, parent, lane, depth }).rev().collect()
    }

    /// Whether there is no tree because the elements are few.
    pub fn is_flat(&self) -> bool {
        self.flat.is_some()
    }

    /// Bytes held by nodes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Visits the leaves whose boxes the ray crosses: nearest first when `ORDERED`, else in any order.
    #[inline(always)]
    pub fn walk<W: Wide, const ORDERED: bool>(&self, ray: &Ray, visitor: &mut impl Visitor) {
        if let Some(all) = &self.flat {
            visitor.test(all.clone(), &mut ray.tmax.clone());
            return;
        }
        if self.stack <= STACK {
            self.walk_with::<W, ORDERED>(ray, &mut [MaybeUninit::uninit(); STACK], visitor);
        } else {
            self.walk_with::<W, ORDERED>(ray, &mut vec![MaybeUninit::uninit(); self.stack], visitor);
        }
    }

    #[inline(always)]
    fn walk_with<W: Wide, const ORDERED: bool>(
        &self,
        ray: &Ray,
        stack: &mut [MaybeUninit<Entry>],
        visitor: &mut impl Visitor,
    ) {
        let o = ray.o.to_array();
        let inverse = ray.d.to_array().map(reciprocal);
        let side = inverse.map(|i| usize::from(i < 0.0));
        let mut tmax = ray.tmax;
        let mut top = 0;
        let mut current = Entry { child: 0, count: 0, t: 0.0 };
        loop {
            if current.count > 0 {
                let first = current.child as usize;
                if visitor.test(first..first + current.count as usize, &mut tmax) {
                    return;
                }
            } else {
                let node = &self.nodes[current.child as usize];
                let (mut near, mut far) = (W::splat(0.0), W::splat(tmax));
                for axis in 0..3 {
                    let enter = W::load(&node.bounds[side[axis]][axis]);
                    let exit = W::load(&node.bounds[1 - side[axis]][axis]);
                    let (o, inverse) = (W::splat(o[axis]), W::splat(inverse[axis]));
                    near = near.max((enter - o) * inverse);
                    far = far.min((exit - o) * inverse * W::splat(ROUNDING));
                }
                let mut mask = W::bits(near.less_or_equal(far));
                let near = near.array();
                let bottom = top;
                while mask != 0 {
                    let l = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    let entry = Entry { child: node.child[l], count: node.count[l], t: near[l] };
                    let mut at = top;
                    if ORDERED {
                        // Farthest first, so that the nearest is taken next.
                        while at > bottom {
                            // SAFETY: entries below `top` have been written.
                            let below = unsafe { stack[at - 1].assume_init() };
                            if below.t >= entry.t {
                                break;
                            }
                            stack[at].write(below);
                            at -= 1;
                        }
                    }
                    stack[at].write(entry);
                    top += 1;
                }
            }
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                // SAFETY: entries below `top` have been written.
                current = unsafe { stack[top].assume_init() };
                if !ORDERED || current.t < tmax {
                    break;
                }
            }
        }
    }
}

/// Up to eight descendants of an inner node that together cover it: the child with the largest surface
/// is opened until the node is full.
fn widened(binary: &Bvh2, index: u32) -> Vec<u32> {
    let open = |i: u32| {
        let first = binary.nodes[i as usize].first_index;
        [first, first + 1]
    };
    let mut list = open(index).to_vec();
    while list.len() < WIDTH {
        let area = |i: u32| binary.nodes[i as usize].aabb().half_area();
        let largest = (0..list.len())
            .filter(|&k| !binary.nodes[list[k] as usize].is_leaf())
            .max_by(|&a, &b| area(list[a]).total_cmp(&area(list[b])));
        let Some(k) = largest else { break };
        let [a, b] = open(list[k]);
        list[k] = a;
        list.push(b);
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of small boxes.
    fn grid(scale: f32, at: f32) -> impl Iterator<Item = Bounds> {
        (0..20_000_u16).map(move |i| {
            let corner = Vec3::new(f32::from(i % 27), f32::from(i / 27 % 27), f32::from(i / 729));
            let min = corner * scale + Vec3::splat(at);
            Bounds { min, max: min + Vec3::splat(0.5 * scale) }
        })
    }

    #[test]
    fn trees_stay_shallow_whatever_the_sizes() {
        let vast = Bounds { min: Vec3::splat(-3e38), max: Vec3::splat(3e38) };
        let cases: [(&str, Vec<Bounds>); 6] = [
            ("usual", grid(1.0, 0.0).collect()),
            ("areas overflow", grid(1e30, 0.0).collect()),
            ("areas vanish", grid(1e-30, 0.0).collect()),
            ("subnormal", grid(1e-42, 0.0).collect()),
            ("equal but for rounding", grid(1e-12, 1.0).collect()),
            ("one is vast", grid(1.0, 0.0).chain(std::iter::once(vast)).chain(grid(1e18, 0.0)).collect()),
        ];
        for (name, boxes) in cases {
            let mut packed = vec![0; boxes.len()];
            let bvh = Bvh::build(&boxes, |items| {
                for &i in items {
                    packed[i as usize] += 1;
                }
                (0, items.len() as u32)
            });
            assert!(bvh.stack <= STACK, "{name}: {}", bvh.stack);
            assert!(packed.iter().all(|&n| n == 1), "{name}");
        }
    }
}
