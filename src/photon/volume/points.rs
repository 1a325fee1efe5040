//! Photons at collisions, and those near a segment.
//!
//! Sorted along a Morton curve, eight neighbours make a packet, whose columns are tested together; the tree is over
//! the boxes of packets, each grown by the radius.

use std::ops::Range;

use rayon::prelude::*;

use super::{Segment, grown, morton};
use crate::accel::{Bvh, Visitor};
use crate::math::simd::{WIDTH, Wide, widest_wide};
use crate::math::{Bounds, Color, Vec3, encode_direction};

/// A photon that a medium scatters.
#[derive(Clone, Copy, Debug)]
pub struct VolumePhoton {
    /// In the world.
    pub p: Vec3,
    /// W per channel, of what is scattered.
    pub flux: Color,
    /// Unit, back towards where it came from.
    pub wi: Vec3,
    /// Which medium scatters it.
    pub medium: u32,
    /// Path segments from the lamp, saturating.
    pub depth: u8,
}

/// A photon near a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Its number in the map.
    pub index: u32,
    /// Squared distance from the segment.
    pub d2: f32,
    /// Distance from the plane at which the segment begins, along its direction.
    pub t: f32,
}

/// Photons and the tree that finds them, for one radius.
#[derive(Debug)]
pub struct PointMap {
    pub(super) radius: f32,
    bvh: Bvh,
    /// By packet, axis and lane; lanes without a photon are at infinity.
    position: Vec<[[f32; WIDTH]; 3]>,
    pub(super) flux: [Vec<f32>; 3],
    pub(super) direction: Vec<u32>,
    pub(super) medium: Vec<u32>,
    pub(super) depth: Vec<u8>,
    count: usize,
}

impl PointMap {
    /// A map of `photons`, which are finite, for queries within `radius`.
    pub fn build(photons: &[VolumePhoton], radius: f32) -> Self {
        let bounds = Bounds::of(photons.iter().map(|photon| photon.p));
        let order = morton::order(photons.par_iter().map(|photon| photon.p), &bounds);
        let packets: Vec<&[u32]> = order.chunks(WIDTH).collect();
        let around = |packet: &&[u32]| Bounds::of(packet.iter().map(|&i| photons[i as usize].p));
        let boxes: Vec<Bounds> = packets.par_iter().map(|packet| grown(around(packet), radius)).collect();
        let (bvh, leaves) =
            Bvh::build(&boxes, |items, leaves: &mut Vec<u32>| leaves.extend_from_slice(items));
        drop(boxes);
        let lane = |packet: u32, l: usize| packets[packet as usize].get(l).map(|&i| &photons[i as usize]);
        let lanes = |packet: &u32, axis: usize| {
            std::array::from_fn(|l| lane(*packet, l).map_or(f32::INFINITY, |photon| photon.p[axis]))
        };
        let position =
            leaves.par_iter().map(|packet| std::array::from_fn(|axis| lanes(packet, axis))).collect();
        Self {
            radius,
            bvh,
            position,
            flux: std::array::from_fn(|c| {
                column(&leaves, |packet, l| lane(packet, l).map_or(0.0, |photon| photon.flux.lanes()[c]))
            }),
            direction: column(&leaves, |packet, l| {
                lane(packet, l).map_or(0, |photon| encode_direction(photon.wi))
            }),
            medium: column(&leaves, |packet, l| lane(packet, l).map_or(0, |photon| photon.medium)),
            depth: column(&leaves, |packet, l| lane(packet, l).map_or(0, |photon| photon.depth)),
            count: photons.len(),
        }
    }

    /// Photons stored.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Memory of one photon in a map beside the tree: position and flux, direction, medium and depth.
    pub const PHOTON_BYTES: usize = 6 * size_of::<f32>() + 2 * size_of::<u32>() + 1;

    /// Memory of all columns and of the tree.
    pub fn bytes(&self) -> usize {
        self.position.len() * WIDTH * Self::PHOTON_BYTES + self.bvh.bytes()
    }

    /// Where photon `index` lies.
    #[inline]
    pub fn place(&self, index: u32) -> Vec3 {
        let packet = &self.position[index as usize / WIDTH];
        Vec3::from_array(packet.each_ref().map(|axis| axis[index as usize % WIDTH]))
    }

    /// Fills `found` with the photons that belong to the segment, within the radius of its line, in an order that depends
    /// on nothing but the map and the segment.
    pub fn along(&self, segment: &Segment, found: &mut Vec<Near>) {
        found.clear();
        if self.count > 0 {
            self.search(segment, found);
        }
    }

    fn search(&self, segment: &Segment, found: &mut Vec<Near>) {
        widest_wide!(PointMap::search_any;
            map: &PointMap = self, segment: &Segment = segment, found: &mut Vec<Near> = found => ())
    }

    #[inline(always)]
    fn search_any<W: Wide>(&self, segment: &Segment, found: &mut Vec<Near>, isa: W::Isa) {
        let mut search = Search { map: self, segment, found };
        self.bvh.walk::<W, false>(&segment.ray(self.radius), &mut search, isa);
    }
}

/// A column of all packets.
fn column<T: Send>(leaves: &[u32], of: impl Fn(u32, usize) -> T + Sync) -> Vec<T> {
    let of = &of;
    leaves.par_iter().flat_map_iter(|&packet| (0..WIDTH).map(move |l| of(packet, l))).collect()
}

struct Search<'a> {
    map: &'a PointMap,
    segment: &'a Segment,
    found: &'a mut Vec<Near>,
}

impl Visitor for Search<'_> {
    #[inline(always)]
    fn test(&mut self, elements: Range<usize>, _: &mut f32) -> bool {
        let Segment { o, d, length, begin, end } = *self.segment;
        let ([ox, oy, oz], [dx, dy, dz]) = (o.to_array(), d.to_array());
        let ([bx, by, bz], [ex, ey, ez]) = (begin.to_array(), end.to_array());
        let r2 = self.map.radius * self.map.radius;
        for packet in elements {
            let [x, y, z] = &self.map.position[packet];
            let (mut t, mut d2, mut inside) = ([0.0; WIDTH], [0.0; WIDTH], [false; WIDTH]);
            for l in 0..WIDTH {
                let (wx, wy, wz) = (x[l] - ox, y[l] - oy, z[l] - oz);
                let foot = wx * dx + wy * dy + wz * dz;
                // From the nearest point: |w|² − foot² would cancel.
                let (qx, qy, qz) = (wx - foot * dx, wy - foot * dy, wz - foot * dz);
                d2[l] = qx * qx + qy * qy + qz * qz;
                t[l] = wx * bx + wy * by + wz * bz;
                inside[l] = (d2[l] < r2) & (t[l] >= 0.0) & (wx * ex + wy * ey + wz * ez < length);
            }
            for l in 0..WIDTH {
                if inside[l] {
                    self.found.push(Near { index: (packet * WIDTH + l) as u32, d2: d2[l], t: t[l] });
                }
            }
        }
        false
    }
}
