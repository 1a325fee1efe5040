//! A bounding volume hierarchy with eight children per node, tested together in one SIMD register. Primitives
//! are tested by the caller: obvhs's triangle tests miss rays aimed at shared edges.

mod construct;

use std::mem::MaybeUninit;
use std::ops::Range;

use crate::math::simd::{WIDTH, Wide};
use crate::math::{Bounds, Ray, Vec3};

/// Eight children, one per lane; unused lanes hold empty boxes. It fills four cache lines: three of boxes, one of children.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Node {
    /// Boxes by bound (min, max), axis and lane.
    bounds: [[[f32; WIDTH]; 3]; 2],
    /// Index of an inner node, or of the first element of a leaf.
    child: [u32; WIDTH],
    /// Number of elements of a leaf; 0 for an inner node.
    count: [u32; WIDTH],
}

impl Node {
    const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]],
        child: [0; WIDTH],
        count: [0; WIDTH],
    };
}

/// A BVH over boxes. Its leaves are ranges of elements: indices into an array that the caller keeps.
#[derive(Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// All elements, if they are too few to need a tree.
    flat: Option<Range<usize>>,
    /// Stack entries that a traversal needs at most.
    stack: usize,
}

/// 1/d for one axis, kept finite so that the slab test never computes 0·∞ = NaN.
fn reciprocal(d: f32) -> f32 {
    if d.abs() < 1e-30 { 1e30f32.copysign(d) } else { 1.0 / d }
}

/// Factor on the exit distance that makes up for the three roundings of the slab test (Ize 2013).
const ROUNDING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// The caller's part of a traversal. This is a trait and not a closure because only methods can be forced inline
/// into functions compiled for wider instruction sets.
pub trait Visitor {
    /// Tests the elements of a leaf, lowers `tmax` to the nearest hit, and returns true to end the traversal.
    fn test(&mut self, elements: Range<usize>, tmax: &mut f32) -> bool;
}

/// A subtree still to be visited, with the ray parameter where the ray enters its box.
#[derive(Clone, Copy)]
struct Entry {
    child: u32,
    count: u32,
    t: f32,
}

/// Entries of the traversal stack that need no heap allocation.
const STACK: usize = 192;

impl Bvh {
    /// Whether there is no tree because there are few elements; then every traversal tests them all.
    pub fn is_flat(&self) -> bool {
        self.flat.is_some()
    }

    /// Memory of the nodes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }

    /// Calls `visit` with the elements of the leaves whose boxes meet `bounds`, until it returns false. Of few elements
    /// these are all.
    pub fn near(&self, bounds: &Bounds, mut visit: impl FnMut(Range<usize>) -> bool) {
        if let Some(all) = &self.flat {
            visit(all.clone());
            return;
        }
        let mut stack = vec![0u32];
        while let Some(i) = stack.pop() {
            let node = &self.nodes[i as usize];
            for lane in 0..WIDTH {
                let corner = |end: usize| Vec3::from_array(node.bounds[end].map(|axis| axis[lane]));
                if corner(0).cmple(bounds.max).all() && corner(1).cmpge(bounds.min).all() {
                    let (child, count) = (node.child[lane], node.count[lane]);
                    let first = child as usize;
                    if count == 0 {
                        stack.push(child);
                    } else if !visit(first..first + count as usize) {
                        return;
                    }
                }
            }
        }
    }

    /// Visits the leaves whose boxes the ray crosses before its `tmax`: front to back if `ORDERED`, else in any
    /// order. `W` is the SIMD instruction set, which must be available.
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
        'next: loop {
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
                    // What would be popped next is not pushed.
                    if mask == 0 && (top == bottom || !ORDERED) {
                        current = entry;
                        continue 'next;
                    }
                    // SAFETY: entries below `top` have been written.
                    unsafe { push::<ORDERED>(stack, bottom, top, entry) };
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

/// Puts `entry` on the stack as entry `top`; if `ORDERED`, sorts it into the entries from `bottom` on, farthest
/// first, so that the nearest is popped next.
///
/// # Safety
///
/// Entries `bottom..top` have been written.
#[inline(always)]
unsafe fn push<const ORDERED: bool>(
    stack: &mut [MaybeUninit<Entry>],
    bottom: usize,
    top: usize,
    entry: Entry,
) {
    let mut at = top;
    while ORDERED && at > bottom {
        // SAFETY: the caller's promise.
        let below = unsafe { stack[at - 1].assume_init() };
        if below.t >= entry.t {
            break;
        }
        stack[at].write(below);
        at -= 1;
    }
    stack[at].write(entry);
}
