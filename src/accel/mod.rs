//! Bounding volume hierarchy of eight boxes a node, which one instruction tests together. Primitive tests are
//! the caller's (obvhs's own lose rays aimed at shared edges).

mod construct;

use std::mem::MaybeUninit;
use std::ops::Range;

use crate::math::Ray;
use crate::math::simd::{WIDTH, Wide};

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

impl Bvh {
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
    pub fn walk<W: Wide, const ORDERED: bool>(&self, ray: &Ray, visitor: &mut impl Visitor, isa: W::Isa) {
        if let Some(all) = &self.flat {
            visitor.test(all.clone(), &mut ray.tmax.clone());
            return;
        }
        if self.stack <= STACK {
            self.walk_with::<W, ORDERED>(ray, &mut [MaybeUninit::uninit(); STACK], visitor, isa);
        } else {
            self.walk_with::<W, ORDERED>(ray, &mut vec![MaybeUninit::uninit(); self.stack], visitor, isa);
        }
    }

    #[inline(always)]
    fn walk_with<W: Wide, const ORDERED: bool>(
        &self,
        ray: &Ray,
        stack: &mut [MaybeUninit<Entry>],
        visitor: &mut impl Visitor,
        isa: W::Isa,
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
                let (mut near, mut far) = (W::splat(isa, 0.0), W::splat(isa, tmax));
                for axis in 0..3 {
                    let enter = W::load(isa, &node.bounds[side[axis]][axis]);
                    let exit = W::load(isa, &node.bounds[1 - side[axis]][axis]);
                    let (o, inverse) = (W::splat(isa, o[axis]), W::splat(isa, inverse[axis]));
                    near = near.max((enter - o) * inverse);
                    far = far.min((exit - o) * inverse * W::splat(isa, ROUNDING));
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
