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

/// Entries kept without the heap.
const STACK: usize = 192;

/// Boxes of which so many are looked at for equal ones.
const LOOKED_AT: usize = 1024;

/// All finite boxes in groups of equal ones, when many are equal or some are not finite. No tree can part
/// equal ones, and the builder, which pairs neighbours that prefer each other, would pair them two at a
/// time: a chain as deep as they are many.
fn equal(boxes: &[Bounds]) -> Option<Vec<Vec<u32>>> {
    let key = |b: &Bounds| [b.min, b.max].map(|v| v.to_array().map(f32::to_bits));
    let finite = |b: &Bounds| b.min.is_finite() && b.max.is_finite();
    let mut seen = HashSet::new();
    if boxes.iter().all(finite)
        && boxes.iter().step_by((boxes.len() / LOOKED_AT).max(1)).all(|b| seen.insert(key(b)))
    {
        return None;
    }
    let mut known = HashMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for (i, b) in (0_u32..).zip(boxes).filter(|(_, b)| finite(b)) {
        let group = *known.entry(key(b)).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(i);
    }
    Some(groups)
}

impl Bvh {
    /// Builds over boxes; what has one that is not finite is left out. `pack(items)` is called for every leaf with the indices of its boxes;
    /// what it returns, a first element and a count in the caller's arrays, is what the leaf names.
    pub fn build(boxes: &[Bounds], mut pack: impl FnMut(&[u32]) -> (u32, u32)) -> Self {
        let Some(groups) = equal(boxes) else { return Self::build_over(boxes, pack) };
        let different: Vec<Bounds> = groups.iter().map(|g| boxes[g[0] as usize]).collect();
        Self::build_over(&different, |items| {
            pack(&items.iter().flat_map(|&i| groups[i as usize].iter().copied()).collect::<Vec<u32>>())
        })
    }

    fn build_over(boxes: &[Bounds], mut pack: impl FnMut(&[u32]) -> (u32, u32)) -> Self {
        let mut bvh = Self { nodes: Vec::new(), flat: None, stack: 0 };
        if boxes.len() <= FLAT {
            let items: Vec<u32> = (0..boxes.len() as u32).collect();
            let (first, count) = pack(&items);
            bvh.flat = Some(first as usize..(first + count) as usize);
            return bvh;
        }
        // A few units in the last place, so that rounding cannot lose a ray that the primitive test accepts.
        let padded: Vec<Aabb> = boxes
            .iter()
            .map(|b| {
                let pad = Vec3::splat(b.magnitude() * 4.0 * f32::EPSILON);
                Aabb { min: b.min - pad, max: b.max + pad }
            })
            .collect();
        let mut time = std::time::Duration::ZERO;
        let binary = build_bvh2(&padded, PARAMETERS, &mut time);
        if let Some(root) = binary.nodes.first() {
            let children = if root.is_leaf() { vec![0] } else { widened(&binary, 0) };
            bvh.widen(&binary, &children, 1, &mut pack);
        }
        bvh
    }

    /// Appends the node with these children of the binary tree, and everything below it.
    fn widen(
        &mut self,
        binary: &Bvh2,
        children: &[u32],
        depth: usize,
        pack: &mut impl FnMut(&[u32]) -> (u32, u32),
    ) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        self.stack = self.stack.max(depth * (WIDTH - 1) + 1);
        for (lane, &c) in children.iter().enumerate() {
            let node = &binary.nodes[c as usize];
            let (child, count) = if node.is_leaf() {
                let first = node.first_index as usize;
                pack(&binary.primitive_indices[first..first + node.prim_count as usize])
            } else {
                (self.widen(binary, &widened(binary, c), depth + 1, pack), 0)
            };
            let wide = &mut self.nodes[index];
            let aabb = node.aabb();
            for axis in 0..3 {
                wide.bounds[0][axis][lane] = aabb.min[axis];
                wide.bounds[1][axis][lane] = aabb.max[axis];
            }
            (wide.child[lane], wide.count[lane]) = (child, count);
        }
        index as u32
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
