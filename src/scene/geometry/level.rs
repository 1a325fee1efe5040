//! One level: packets of primitives and the tree over them.

use super::Hit;
use super::primitive::{Kind, Primitive, kind};
use crate::accel::Bvh;
use crate::math::{Bounds, Vec3};
use crate::shape::Analytic;
use crate::shape::triangle::{Block, Corners, WIDTH};

/// The primitives of a leaf: up to eight triangles, or up to eight other things. What rays that meet none of them read
/// stands first, in five cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Packet {
    pub(super) triangles: Block,
    /// Number of lanes in use if the packet holds no triangles, otherwise 0.
    pub(super) others: u32,
    pub(super) shape: [u32; WIDTH],
    pub(super) tag: [u32; WIDTH],
}

/// A triangle in the form that shading needs.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    pub(super) corners: Corners,
    /// Unit normal by the winding.
    pub normal: Vec3,
    /// Largest coordinate of a corner.
    pub magnitude: f32,
}

impl Face {
    #[inline(always)]
    fn new(block: &Block, lane: usize) -> Self {
        let [a, b, c] = [block.corner(0, lane), block.corner(1, lane), block.corner(2, lane)];
        Self {
            corners: [a, b, c].map(|v| v.extend(0.0).to_array()),
            normal: (b - a).cross(c - a).normalize_or(Vec3::Z),
            magnitude: a.abs().max(b.abs()).max(c.abs()).max_element(),
        }
    }

    /// In the frame of the level.
    #[inline(always)]
    pub fn corners(&self) -> [Vec3; 3] {
        self.corners.map(|v| Vec3::from_vec4(v.into()))
    }
}

/// So few primitives that rays are tested against all of them.
#[derive(Debug)]
pub(super) struct Small {
    /// All triangles, in the order of the packets.
    pub(super) faces: Vec<Face>,
    pub(super) others: Vec<Other>,
}

/// An analytic shape among few primitives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    pub(super) packet: u32,
    pub(super) lane: u32,
    /// Index into `Level::analytic`.
    pub(super) analytic: u32,
}

impl Small {
    /// `None` if there are instances.
    fn new(packets: &[Packet], primitives: usize) -> Option<Self> {
        let others = packets.iter().zip(0..).filter(|(p, _)| p.others > 0).flat_map(|(p, packet)| {
            (0..p.others).map(move |lane| match kind(p.tag[lane as usize]) {
                Kind::Analytic(analytic) => Some(Other { packet, lane, analytic }),
                _ => None,
            })
        });
        let others = others.collect::<Option<Vec<_>>>()?;
        // Lanes are filled one after another, triangles first.
        let triangles = primitives - others.len();
        let faces = (0..triangles).map(|i| Face::new(&packets[i / WIDTH].triangles, i % WIDTH)).collect();
        Some(Self { faces, others })
    }
}

/// One level: packets of primitives and the tree over them.
#[derive(Debug)]
pub struct Level {
    pub(super) packets: Vec<Packet>,
    /// What there is, when there is no tree and there are no instances.
    pub(super) small: Option<Small>,
    /// How many there are.
    pub primitives: usize,
    /// Shapes with models of their own.
    pub analytic: Vec<Analytic>,
    pub(super) bvh: Bvh,
    /// Around all of it, in its own frame.
    pub bounds: Bounds,
}

impl Level {
    /// Sorts primitives into leaves and builds the tree. `instance_bounds` are those of placed groups, in the
    /// frame of this level.
    pub fn new(primitives: &[Primitive], analytic: Vec<Analytic>, instance_bounds: &[Bounds]) -> Self {
        let boxes: Vec<Bounds> = primitives.iter().map(|p| p.bounds(&analytic, instance_bounds)).collect();
        let mut bounds = Bounds::EMPTY;
        boxes.iter().for_each(|b| bounds.union(b));
        let (bvh, packets) = Bvh::build(&boxes, |items, packets: &mut Vec<Packet>| {
            let is_triangle = |&i: &u32| matches!(kind(primitives[i as usize].tag), Kind::Triangle(_));
            // Most leaves hold nothing else.
            if items.iter().all(is_triangle) {
                packets.extend(items.chunks(WIDTH).map(|lanes| packet(primitives, lanes, true)));
                return;
            }
            let (triangles, others): (Vec<u32>, Vec<u32>) = items.iter().partition(|i| is_triangle(i));
            for (list, are_triangles) in [(triangles, true), (others, false)] {
                packets.extend(list.chunks(WIDTH).map(|lanes| packet(primitives, lanes, are_triangles)));
            }
        });
        let finite = boxes.iter().filter(|b| b.min.is_finite() && b.max.is_finite()).count();
        let small = if bvh.is_flat() { Small::new(&packets, finite) } else { None };
        Self { packets, small, primitives: primitives.len(), analytic, bvh, bounds }
    }

    /// Memory of the tree and of the packets.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of_val(self.packets.as_slice())
    }

    /// What a hit in this level met.
    #[inline(always)]
    pub fn kind(&self, hit: &Hit) -> Kind {
        kind(self.packets[hit.packet as usize].tag[hit.lane as usize])
    }

    /// Shape of the primitive that was hit.
    #[inline(always)]
    pub fn shape(&self, hit: &Hit) -> u32 {
        self.packets[hit.packet as usize].shape[hit.lane as usize]
    }

    /// The triangle that was hit.
    #[inline(always)]
    pub fn face(&self, hit: &Hit) -> Face {
        let (packet, lane) = (hit.packet as usize, hit.lane as usize % WIDTH);
        // In large scenes, loading a stored face takes longer than computing it from the packet, which the
        // traversal has just brought into the cache.
        match self.small.as_ref().and_then(|small| small.faces.get(packet * WIDTH + lane)) {
            Some(face) => *face,
            None => Face::new(&self.packets[packet].triangles, lane),
        }
    }
}

fn packet(primitives: &[Primitive], lanes: &[u32], are_triangles: bool) -> Packet {
    let mut packet = Packet { triangles: Block::EMPTY, shape: [u32::MAX; WIDTH], tag: [0; WIDTH], others: 0 };
    for (lane, &i) in lanes.iter().enumerate() {
        let p = &primitives[i as usize];
        (packet.shape[lane], packet.tag[lane]) = (p.shape, p.tag);
        if are_triangles {
            packet.triangles.set(lane, &p.v);
        } else {
            packet.others += 1;
        }
    }
    packet
}
