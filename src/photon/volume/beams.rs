//! Ways that light went through media, and those near a segment.
//!
//! A beam is cut into pieces, so that boxes along the axes are no larger than they must be; the pieces of a leaf
//! make packets of eight, whose columns are tested together.

use std::ops::Range;

use super::{Segment, grown};
use crate::accel::{Bvh, Visitor};
use crate::math::simd::{WIDTH, Wide, widest_wide};
use crate::math::{Bounds, Color, Vec3};

/// Light on its way from `o` along `d`: the flux of all of it passes each place up to `length`.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Where it begins.
    pub o: Vec3,
    /// Unit direction of the light.
    pub d: Vec3,
    /// In scene units, finite.
    pub length: f32,
    /// W per channel.
    pub flux: Color,
    /// The medium that it is in.
    pub medium: u32,
    /// Path segments from the lamp, this one included, saturating.
    pub depth: u8,
}

/// The part of a beam that is within the radius of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Which beam.
    pub beam: u32,
    /// ∫ of the kernel across the segment over the way along the beam, 1/length.
    pub weight: f32,
    /// The middle of the part.
    pub p: Vec3,
    /// Unit direction of the light.
    pub d: Vec3,
    /// Distance of the middle from the plane at which the segment begins, along its direction.
    pub t: f32,
}

/// A packet without a piece in this lane.
const NONE: u32 = u32::MAX;

/// Pieces that a beam of mean length is cut into. By `benches/volume.rs` with beams half as long as the scene, twice as
/// many take twice the time to build and find no faster below 10⁵ beams.
const PIECES: f64 = 2.0;

/// Eight pieces of beams by lane; lanes without one have length 0 at infinity.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Packet {
    o: [[f32; WIDTH]; 3],
    d: [[f32; WIDTH]; 3],
    length: [f32; WIDTH],
    beam: [u32; WIDTH],
}

/// A piece before it is in a packet.
#[derive(Clone, Copy)]
struct Piece {
    beam: u32,
    from: f32,
    to: f32,
}

/// Beams and the tree that finds them, for one radius.
#[derive(Debug)]
pub struct BeamMap {
    radius: f32,
    bvh: Bvh,
    packets: Vec<Packet>,
    pub(super) flux: [Vec<f32>; 3],
    pub(super) medium: Vec<u32>,
    pub(super) depth: Vec<u8>,
}

impl BeamMap {
    /// A map of `beams`, which are finite, for queries within `radius`.
    pub fn build(beams: &[Beam], radius: f32) -> Self {
        let pieces = cut(beams, radius);
        let around = |piece: &Piece| {
            let beam = &beams[piece.beam as usize];
            grown(Bounds::of([piece.from, piece.to].map(|s| beam.o + beam.d * s)), radius)
        };
        let boxes: Vec<Bounds> = pieces.iter().map(around).collect();
        let (bvh, packets) = Bvh::build(&boxes, |items, packets: &mut Vec<Packet>| {
            packets.extend(items.chunks(WIDTH).map(|lanes| Packet::new(beams, &pieces, lanes)));
        });
        Self {
            radius,
            bvh,
            packets,
            flux: std::array::from_fn(|c| beams.iter().map(|beam| beam.flux.lanes()[c]).collect()),
            medium: beams.iter().map(|beam| beam.medium).collect(),
            depth: beams.iter().map(|beam| beam.depth).collect(),
        }
    }

    /// Beams stored.
    pub fn len(&self) -> usize {
        self.medium.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.medium.is_empty()
    }

    /// Memory of one beam in a map beside its pieces: flux, medium and depth.
    pub const BEAM_BYTES: usize = 3 * size_of::<f32>() + size_of::<u32>() + 1;

    /// Memory of all columns and of the tree. A beam has [`PIECES`] + 1 pieces at most on average, each in a packet that
    /// is half full as a rule: 150 to 200 bytes a beam.
    pub fn bytes(&self) -> usize {
        self.len() * Self::BEAM_BYTES + size_of_val(self.packets.as_slice()) + self.bvh.bytes()
    }

    /// Fills `found` with what of the beams is within the radius of the segment, in an order that depends on nothing but
    /// the map and the segment. A beam comes once for each of its pieces.
    pub fn along(&self, segment: &Segment, found: &mut Vec<Crossing>) {
        found.clear();
        if !self.is_empty() {
            self.search(segment, found);
        }
    }

    fn search(&self, segment: &Segment, found: &mut Vec<Crossing>) {
        widest_wide!(BeamMap::search_any;
            map: &BeamMap = self, segment: &Segment = segment, found: &mut Vec<Crossing> = found => ())
    }

    #[inline(always)]
    fn search_any<W: Wide>(&self, segment: &Segment, found: &mut Vec<Crossing>, isa: W::Isa) {
        let mut search = Search { map: self, segment, found };
        self.bvh.walk::<W, false>(&segment.ray(self.radius), &mut search, isa);
    }
}

/// Cuts beams into pieces of one length, at most [`PIECES`] + 1 for each on average. Pieces shorter than the box around
/// their radius would gain nothing.
fn cut(beams: &[Beam], radius: f32) -> Vec<Piece> {
    let total: f64 = beams.iter().map(|beam| f64::from(beam.length)).sum();
    let most = PIECES * beams.len() as f64;
    let length = (total / most.max(1.0)).max(2.0 * f64::from(radius)).max(f64::from(f32::MIN_POSITIVE));
    let mut pieces = Vec::with_capacity(beams.len());
    for (beam, i) in beams.iter().zip(0..) {
        let n = (f64::from(beam.length) / length).ceil().max(1.0) as u32;
        let at = |k: u32| (f64::from(beam.length) * (f64::from(k) / f64::from(n))) as f32;
        pieces.extend((0..n).map(|k| Piece { beam: i, from: at(k), to: at(k + 1) }));
    }
    pieces
}

impl Packet {
    fn new(beams: &[Beam], pieces: &[Piece], lanes: &[u32]) -> Self {
        let mut packet = Self {
            o: [[f32::INFINITY; WIDTH]; 3],
            d: [[0.0; WIDTH]; 3],
            length: [0.0; WIDTH],
            beam: [NONE; WIDTH],
        };
        for (l, &i) in lanes.iter().enumerate() {
            let Piece { beam: index, from, to } = pieces[i as usize];
            let beam = &beams[index as usize];
            let o = beam.o + beam.d * from;
            for axis in 0..3 {
                packet.o[axis][l] = o[axis];
                packet.d[axis][l] = beam.d[axis];
            }
            packet.length[l] = to - from;
            packet.beam[l] = index;
        }
        packet
    }
}

struct Search<'a> {
    map: &'a BeamMap,
    segment: &'a Segment,
    found: &'a mut Vec<Crossing>,
}

impl Visitor for Search<'_> {
    #[inline(always)]
    fn test(&mut self, elements: Range<usize>, _: &mut f32) -> bool {
        let r2 = self.map.radius * self.map.radius;
        for packet in &self.map.packets[elements] {
            let near = Nearest::of(packet, self.segment);
            for l in 0..WIDTH {
                if near.d2[l] < r2 {
                    self.cross(packet, l, near.s[l]);
                }
            }
        }
        false
    }
}

/// The place of each piece that is nearest to the line of a segment.
struct Nearest {
    /// From the start of the piece.
    s: [f32; WIDTH],
    /// Squared distance.
    d2: [f32; WIDTH],
}

impl Nearest {
    #[inline(always)]
    fn of(packet: &Packet, segment: &Segment) -> Self {
        let ([ox, oy, oz], [dx, dy, dz]) = (segment.o.to_array(), segment.d.to_array());
        let Packet { o: [px, py, pz], d: [bx, by, bz], length, .. } = packet;
        let (mut s, mut d2) = ([0.0; WIDTH], [0.0; WIDTH]);
        for l in 0..WIDTH {
            let (wx, wy, wz) = (px[l] - ox, py[l] - oy, pz[l] - oz);
            let (wd, bd) = (wx * dx + wy * dy + wz * dz, bx[l] * dx + by[l] * dy + bz[l] * dz);
            // Across the segment.
            let (wx, wy, wz) = (wx - wd * dx, wy - wd * dy, wz - wd * dz);
            let (bx, by, bz) = (bx[l] - bd * dx, by[l] - bd * dy, bz[l] - bd * dz);
            let sin2 = bx * bx + by * by + bz * bz;
            let along = -(wx * bx + wy * by + wz * bz) / sin2.max(f32::MIN_POSITIVE);
            s[l] = along.max(0.0).min(length[l]);
            let (qx, qy, qz) = (wx + s[l] * bx, wy + s[l] * by, wz + s[l] * bz);
            d2[l] = qx * qx + qy * qy + qz * qz;
        }
        Self { s, d2 }
    }
}

impl Search<'_> {
    /// Adds what lane `l` has within the radius; it is nearest to the line of the segment at `s`.
    #[inline(never)]
    fn cross(&mut self, packet: &Packet, l: usize, s: f32) {
        let Segment { o, d, length, begin, end } = *self.segment;
        let at = |v: &[[f32; WIDTH]; 3]| Vec3::from_array(v.each_ref().map(|axis| axis[l]));
        let (start, b) = (at(&packet.o), at(&packet.d));
        let p = start + b * s;
        let (t, cos) = ((p - o).dot(d), b.dot(d));
        let across = Across { q: (p - o) - d * t, b: b - d * cos, radius: self.map.radius };
        let part = across.within(-s, packet.length[l] - s);
        // Behind the one plane and before the other.
        let (behind, along) = ((p - o).dot(begin), b.dot(begin));
        let (before, slower) = (length - (p - o).dot(end), -b.dot(end));
        let part = clipped(clipped(part, behind, along), before, slower);
        if part[0] < part[1] && !(slower == 0.0 && before == 0.0) {
            let middle = 0.5 * (part[0] + part[1]);
            self.found.push(Crossing {
                beam: packet.beam[l],
                weight: across.weight(part),
                p: p + b * middle,
                d: b,
                t: (behind + along * middle).max(0.0),
            });
        }
    }
}

/// The part of x between `from` and `to` where `value + slope·x` is not negative.
#[inline(always)]
fn clipped([from, to]: [f32; 2], value: f32, slope: f32) -> [f32; 2] {
    let zero = -value / slope;
    if slope > 0.0 {
        [from.max(zero), to]
    } else if slope < 0.0 {
        [from, to.min(zero)]
    } else if value >= 0.0 {
        [from, to]
    } else {
        [from, from]
    }
}

/// A beam as it passes a segment, seen along the segment: `q + x·b` across it.
#[derive(Clone, Copy, Debug)]
struct Across {
    q: Vec3,
    /// Its length is the sine of the angle between the two.
    b: Vec3,
    radius: f32,
}

impl Across {
    /// The part of `from ≤ x ≤ to` that is within the radius.
    fn within(&self, from: f32, to: f32) -> [f32; 2] {
        let (a, b) = (self.b.length_squared(), self.b.dot(self.q));
        let c = self.q.length_squared() - self.radius * self.radius;
        // b is 0 unless an end of the beam is nearest, so that nothing cancels where the lines cross.
        let root = (b * b - a * c).max(0.0).sqrt();
        if root > 0.0 && a > 0.0 { [from.max((-b - root) / a), to.min((-b + root) / a)] } else { [from, to] }
    }

    /// ∫ K(|q + x·b|) dx with the Epanechnikov kernel K(d) = 2/(π·r²)·(1 − d²/r²).
    ///
    /// Across the whole disc this is a kernel of one dimension over sin θ. But it has no pole: along a beam that is
    /// parallel to the segment it is K(d) times the length of the part.
    fn weight(&self, [from, to]: [f32; 2]) -> f32 {
        let inverse = 1.0 / self.radius;
        let (q, b) = (self.q * inverse, self.b * inverse);
        let integral =
            |x: f32| x * ((1.0 - q.length_squared()) - x * (q.dot(b) + x * b.length_squared() * (1.0 / 3.0)));
        let mass = std::f32::consts::FRAC_2_PI * inverse * inverse;
        (mass * (integral(to) - integral(from))).max(0.0)
    }
}
