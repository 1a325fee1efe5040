//! Bounding volume hierarchy. The only file that names obvhs, which builds and walks the tree;
//! primitive tests are the caller's (obvhs's own lose rays aimed at shared edges).

use glam::Vec3A;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::ray::RayHit;
use obvhs::{BvhBuildParams, aabb::Aabb};

use crate::math::{Bounds, Ray};

/// A BVH over boxes, whose leaves name elements of the caller's arrays.
pub struct Bvh {
    inner: Bvh2,
}

impl std::fmt::Debug for Bvh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Bvh({} nodes)", self.inner.nodes.len())
    }
}

/// obvhs's medium preset with leaves of at most four boxes: primitives are tested four at a time, so a
/// leaf costs about as much as an inner node.
const PARAMETERS: BvhBuildParams =
    BvhBuildParams { max_prims_per_leaf: 4, collapse_traversal_cost: 3.0, ..BvhBuildParams::medium_build() };

/// A component of 1/d that stays finite, so that 0·inf never makes a NaN in the slab test.
fn reciprocal(d: f32) -> f32 {
    if d.abs() < 1e-30 { 1e30f32.copysign(d) } else { 1.0 / d }
}

fn to_obvhs(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray {
        origin: ray.o,
        direction: ray.d,
        inv_direction: Vec3A::new(reciprocal(ray.d.x), reciprocal(ray.d.y), reciprocal(ray.d.z)),
        tmin: 0.0,
        tmax: ray.tmax,
    }
}

impl Bvh {
    /// Boxes must be finite. Each is padded by a few units in the last place so that the slab test's
    /// rounding cannot lose a ray that the primitive test would accept.
    pub fn build(boxes: &[Bounds]) -> Self {
        let padded: Vec<Aabb> = boxes
            .iter()
            .map(|b| {
                let pad = Vec3A::splat(b.magnitude() * 4.0 * f32::EPSILON);
                Aabb { min: b.min - pad, max: b.max + pad }
            })
            .collect();
        let mut time = std::time::Duration::ZERO;
        Self { inner: build_bvh2(&padded, PARAMETERS, &mut time) }
    }

    /// Calls `pack(items)` for every leaf with the indices of its boxes; what it returns, a first
    /// element and a count in the caller's own arrays, is what the leaf names from then on.
    pub fn pack_leaves(&mut self, mut pack: impl FnMut(&[u32]) -> (u32, u32)) {
        let order = std::mem::take(&mut self.inner.primitive_indices);
        for node in self.inner.nodes.iter_mut().filter(|n| n.is_leaf()) {
            let first = node.first_index as usize;
            let (start, count) = pack(&order[first..first + node.prim_count as usize]);
            (node.first_index, node.prim_count) = (start, count);
        }
    }

    /// Bytes held by nodes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.inner.nodes.as_slice())
    }

    /// Walks leaves front to back. `test(element, tmax)` returns the new tmax when it hits, and
    /// remembers what it hit itself.
    #[inline(always)]
    pub fn closest(&self, ray: &Ray, mut test: impl FnMut(usize, f32) -> Option<f32>) {
        self.walk(ray, |first, last, tmax| {
            for element in first..last {
                if let Some(t) = test(element, *tmax) {
                    *tmax = t;
                }
            }
            true
        });
    }

    /// True as soon as `test(element)` is true in a leaf whose box the ray crosses.
    #[inline(always)]
    pub fn any(&self, ray: &Ray, mut test: impl FnMut(usize) -> bool) -> bool {
        let mut found = false;
        self.walk(ray, |first, last, _| {
            found = (first..last).any(&mut test);
            !found
        });
        found
    }

    #[inline(always)]
    fn walk(&self, ray: &Ray, mut leaf: impl FnMut(usize, usize, &mut f32) -> bool) {
        let mut hit = RayHit::none();
        let mut visit = |node: &obvhs::bvh2::node::Bvh2Node, r: &mut obvhs::ray::Ray, _: &mut RayHit| {
            leaf(node.first_index as usize, (node.first_index + node.prim_count) as usize, &mut r.tmax)
        };
        obvhs::fast_stack!(u32, (96, 192), self.inner.max_depth, stack, {
            self.inner.ray_traverse_dynamic(&mut stack, to_obvhs(ray), &mut hit, &mut visit)
        });
    }
}
