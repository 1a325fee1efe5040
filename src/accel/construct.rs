//! Builds a [`Bvh`]: obvhs makes a binary tree, which is then collapsed to eight children per node. Only
//! `construct` uses obvhs.

mod band;
mod part;

use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::{BvhBuildParams, aabb::Aabb};
use rayon::prelude::*;

use super::{Bvh, Node};
use crate::math::Bounds;
use crate::math::simd::WIDTH;
use band::Band;

/// The medium preset of obvhs, with leaves as large as the packets in which primitives are tested.
const PARAMETERS: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: WIDTH as u32,
    collapse_traversal_cost: 6.0,
    ..BvhBuildParams::medium_build()
};

/// Up to this many boxes there is no tree: testing eight packets in a row is faster than traversal, because
/// that loop has no branch to mispredict.
const FLAT: usize = 64;

/// A subtree whose indices count from its own first node and pack.
struct Piece<P> {
    nodes: Vec<Node>,
    packs: Vec<P>,
    /// Its root as `Node::child` and `Node::count` hold it: (node, 0) or (first pack, number of packs).
    root: (u32, u32),
    /// Box around everything in it, in scene units.
    bounds: Aabb,
    depth: usize,
}

/// A node of the binary tree that is still to be put into a lane of the node `parent`.
struct Pending {
    binary: u32,
    parent: usize,
    lane: usize,
    depth: usize,
}

impl Bvh {
    /// Builds a tree over `boxes`; boxes that are not finite are left out. `pack(items, packs)` is called for
    /// every leaf with the indices of its boxes and appends the leaf's elements to `packs`. Tree and elements
    /// do not depend on the number of threads.
    pub fn build<P: Send>(boxes: &[Bounds], pack: impl Fn(&[u32], &mut Vec<P>) + Sync) -> (Self, Vec<P>) {
        let bands = Band::all(boxes);
        if bands.iter().map(|b| b.boxes.len()).sum::<usize>() <= FLAT {
            let all = |b: &Band| b.members(&(0..b.boxes.len() as u32).collect::<Vec<_>>());
            let mut packs = Vec::new();
            pack(&bands.iter().flat_map(all).collect::<Vec<_>>(), &mut packs);
            return (Self { nodes: Vec::new(), flat: Some(0..packs.len()), stack: 0 }, packs);
        }
        let pieces: Vec<Piece<P>> = if let [band] = &*bands {
            let parts = part::parts(&band.boxes);
            parts.into_par_iter().map(|part| Piece::new(band, part.as_deref(), &pack)).collect()
        } else {
            bands.par_iter().map(|band| Piece::new(band, None, &pack)).collect()
        };
        Self::joined(pieces)
    }

    /// Joins at most eight pieces under one root, unless there is one piece whose root is a node already.
    fn joined<P>(pieces: Vec<Piece<P>>) -> (Self, Vec<P>) {
        let total = |count: fn(&Piece<P>) -> usize| pieces.iter().map(count).sum::<usize>();
        let mut nodes = Vec::with_capacity(1 + total(|piece| piece.nodes.len()));
        let mut packs = Vec::with_capacity(total(|piece| piece.packs.len()));
        let single = matches!(&*pieces, [piece] if piece.root.1 == 0);
        if !single {
            nodes.push(Node::EMPTY);
        }
        let mut depth = 0;
        for (lane, piece) in pieces.into_iter().enumerate() {
            let (to_node, to_pack) = (nodes.len() as u32, packs.len() as u32);
            let moved =
                |(child, count): (u32, u32)| (child + if count > 0 { to_pack } else { to_node }, count);
            if !single {
                nodes[0].set(lane, moved(piece.root), &piece.bounds);
            }
            nodes.extend(piece.nodes.into_iter().map(|mut node| {
                for lane in 0..WIDTH {
                    (node.child[lane], node.count[lane]) = moved((node.child[lane], node.count[lane]));
                }
                node
            }));
            packs.extend(piece.packs);
            depth = depth.max(piece.depth + usize::from(!single));
        }
        (Self { nodes, flat: None, stack: depth * (WIDTH - 1) + 1 }, packs)
    }
}

impl Node {
    fn set(&mut self, lane: usize, (child, count): (u32, u32), aabb: &Aabb) {
        for axis in 0..3 {
            self.bounds[0][axis][lane] = aabb.min[axis];
            self.bounds[1][axis][lane] = aabb.max[axis];
        }
        (self.child[lane], self.count[lane]) = (child, count);
    }
}

impl<P> Piece<P> {
    /// Builds the subtree of the boxes `part` of a band, or of all its boxes.
    fn new(band: &Band, part: Option<&[u32]>, pack: &(impl Fn(&[u32], &mut Vec<P>) + Sync)) -> Self {
        let mut time = std::time::Duration::ZERO;
        let binary = match part {
            Some(part) => {
                let boxes: Vec<Aabb> = part.iter().map(|&i| band.boxes[i as usize]).collect();
                build_bvh2(&boxes, PARAMETERS, &mut time)
            }
            None => build_bvh2(&band.boxes, PARAMETERS, &mut time),
        };
        let scale = 1.0 / band.scale;
        let scaled = |b: Aabb| Aabb { min: b.min * scale, max: b.max * scale };
        let mut piece = Self {
            nodes: Vec::new(),
            // Leaves seldom have more than one.
            packs: Vec::with_capacity(binary.nodes.iter().filter(|node| node.is_leaf()).count()),
            root: (0, 0),
            bounds: scaled(*binary.nodes[0].aabb()),
            depth: 0,
        };
        let leaf = |index: u32, packs: &mut Vec<P>| {
            let node = &binary.nodes[index as usize];
            let first = packs.len();
            let leaves = &binary.primitive_indices[node.first_index as usize..][..node.prim_count as usize];
            match part {
                Some(part) => {
                    let boxes: Vec<u32> = leaves.iter().map(|&i| part[i as usize]).collect();
                    pack(&band.members(&boxes), packs);
                }
                None => pack(&band.members(leaves), packs),
            }
            (first as u32, (packs.len() - first) as u32)
        };
        if binary.nodes[0].is_leaf() {
            piece.root = leaf(0, &mut piece.packs);
            return piece;
        }
        let mut pending = piece.open(widened(&binary, 0), 1);
        // Not recursive, since the tree may be deeper than a thread's stack allows.
        while let Some(Pending { binary: index, parent, lane, depth }) = pending.pop() {
            let node = &binary.nodes[index as usize];
            let child = if node.is_leaf() {
                leaf(index, &mut piece.packs)
            } else {
                let child = piece.nodes.len() as u32;
                pending.extend(piece.open(widened(&binary, index), depth + 1));
                (child, 0)
            };
            piece.nodes[parent].set(lane, child, &scaled(*node.aabb()));
        }
        piece
    }

    /// Appends an empty node, and returns what is to be put into its lanes, last lane first.
    fn open(&mut self, children: Vec<u32>, depth: usize) -> Vec<Pending> {
        let parent = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        self.depth = self.depth.max(depth);
        let lanes = children.into_iter().enumerate();
        lanes.map(|(lane, binary)| Pending { binary, parent, lane, depth }).rev().collect()
    }
}

/// Up to eight descendants of an inner node that together cover it: starting from its two children, the one of
/// largest surface area is replaced by its own children until there are eight.
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
    use super::super::STACK;
    use super::*;
    use crate::math::Vec3;

    /// A grid of 20,000 boxes with spacing `scale`, starting at `at`.
    fn grid(scale: f32, at: f32) -> impl Iterator<Item = Bounds> {
        (0..20_000_u16).map(move |i| {
            let corner = Vec3::new(f32::from(i % 27), f32::from(i / 27 % 27), f32::from(i / 729));
            let min = corner * scale + Vec3::splat(at);
            Bounds { min, max: min + Vec3::splat(0.5 * scale) }
        })
    }

    #[test]
    fn trees_stay_shallow_at_any_scale() {
        let vast = Bounds { min: Vec3::splat(-3e38), max: Vec3::splat(3e38) };
        let cases: [(&str, Vec<Bounds>); 6] = [
            ("ordinary", grid(1.0, 0.0).collect()),
            ("areas overflow", grid(1e30, 0.0).collect()),
            ("areas vanish", grid(1e-30, 0.0).collect()),
            ("subnormal", grid(1e-42, 0.0).collect()),
            ("equal but for rounding", grid(1e-12, 1.0).collect()),
            (
                "mixed, with one vast box",
                grid(1.0, 0.0).chain(std::iter::once(vast)).chain(grid(1e18, 0.0)).collect(),
            ),
        ];
        for (name, boxes) in cases {
            let (bvh, mut packed) = Bvh::build(&boxes, |items, packs| packs.extend_from_slice(items));
            assert!(bvh.stack <= STACK, "{name}: {}", bvh.stack);
            packed.sort_unstable();
            assert!(packed.iter().copied().eq(0..boxes.len() as u32), "{name}");
        }
    }
}
