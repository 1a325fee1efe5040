//! Glass that lies flush on a floor, or in a wall of other glass. Which of two coincident faces a ray hits is
//! decided by rounding; a ray that passes through one starts behind the other, and the picture depends on
//! the integrator. Such a face is drawn back into its own body by a few units of rounding: the gap is what
//! the author means, and every ray finds both faces.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::LevelParts;
use crate::math::{Bounds, LIFT, Vec3};
use crate::scene::ShapeRecord;
use crate::scene::geometry::{Kind, Primitive};
use crate::shape::{Analytic, Disk, triangle};

/// Faces nearer than this coincide: rays that leave one are lifted past the other. Both this and the gap are
/// relative to the largest coordinate.
const NEAR: f32 = 4.0 * LIFT;
const GAP: f32 = 12.0 * LIFT;

/// Largest distance that a face is moved, relative to the size of its shape; too small to be visible.
const MOST: f32 = 1e-3;

/// Most pairs of faces that are compared: some seconds, reached only by scenes with many thousands of
/// coincident faces.
const PAIRS: usize = 1 << 27;

/// Corners of the polygon that stands for a disk, in triangles that meet at its centre.
const SIDES: usize = 12;

/// A flat face that may coincide with another.
#[derive(Clone, Copy)]
struct Face {
    v: [Vec3; 3],
    /// Unit, of the front.
    n: Vec3,
    bounds: Bounds,
    shape: u32,
    clear: bool,
}

/// Draws back every face of a shape for which `clear` says that light goes through it, where it coincides
/// with a face of another shape. Returns the shapes and the farthest that one of their faces moved.
pub fn draw_back(
    level: &mut LevelParts,
    records: &[ShapeRecord],
    clear: impl Fn(&ShapeRecord) -> bool,
) -> Vec<(u32, f32)> {
    // A lamp has its own list of the triangles that shine.
    let clear: Vec<bool> = records.iter().map(|r| r.emitter.is_none() && clear(r)).collect();
    let Some(around) = around(level, &clear) else { return Vec::new() };
    let faces = faces(level, records, &clear, &around);
    let mut sizes = vec![Bounds::EMPTY; records.len()];
    faces.iter().filter(|f| f.clear).for_each(|f| sizes[f.shape as usize].union(&f.bounds));
    let others: Vec<u32> = (0..faces.len() as u32).collect();
    let own: Vec<u32> = others.iter().copied().filter(|&f| faces[f as usize].clear).collect();
    let mut search = Search { faces: &faces, left: PAIRS, found: BTreeSet::new() };
    search.join(&own, &others, around, 0);

    // By shape and position: shared corners must stay shared, and a disk moves with its centre.
    let mut steps: HashMap<(u32, [u32; 3]), Vec<Vec3>> = HashMap::new();
    let mut moved: BTreeMap<u32, f32> = BTreeMap::new();
    let mut sheets: HashMap<u32, bool> = HashMap::new();
    for &(a, o) in &search.found {
        let (a, o) = (&faces[a as usize], &faces[o as usize]);
        if a.n.dot(o.n) > 0.0 && *sheets.entry(a.shape).or_insert_with(|| is_sheet(&faces, a)) {
            continue;
        }
        let most = MOST * sizes[a.shape as usize].extent().length();
        let gap = (GAP * a.bounds.magnitude().max(o.bounds.magnitude())).min(most);
        let step = -a.n * gap;
        let farthest = moved.entry(a.shape).or_default();
        *farthest = farthest.max(gap);
        for v in a.v {
            let steps = steps.entry((a.shape, bits(v))).or_default();
            // The corner of a room moves a corner of the glass along three axes; the faces of a tessellated
            // floor move it only once.
            match steps.iter_mut().find(|s| s.normalize_or_zero().dot(-a.n) > 0.99) {
                Some(s) if s.length() >= gap => {}
                Some(s) => *s = step,
                None => steps.push(step),
            }
        }
    }
    let step = |shape, place| -> Vec3 { steps.get(&(shape, bits(place))).into_iter().flatten().sum() };
    for p in level.primitives.iter_mut().filter(|p| moved.contains_key(&p.shape)) {
        let shape = p.shape;
        match p.kind() {
            Kind::Triangle(_) => p.corners_mut().iter_mut().for_each(|v| {
                let place = Vec3::from(*v);
                *v = (place + step(shape, place)).to_array();
            }),
            Kind::Analytic(i) => {
                if let Analytic::Disk(d) = &mut level.analytic[i as usize] {
                    d.center += step(shape, d.center.as_vec3a()).as_dvec3();
                }
            }
            Kind::Instance(_) => {}
        }
    }
    moved.into_iter().collect()
}

fn bits(place: Vec3) -> [u32; 3] {
    place.to_array().map(f32::to_bits)
}

/// The box around all that light goes through; `None` without any.
fn around(level: &LevelParts, clear: &[bool]) -> Option<Bounds> {
    let mut around = Bounds::EMPTY;
    if clear.contains(&true) {
        // Instances are of no shape here.
        let of_clear = |p: &&Primitive| clear.get(p.shape as usize) == Some(&true);
        for p in level.primitives.iter().filter(of_clear) {
            around.union(&p.bounds(&level.analytic, &[]));
        }
    }
    (!around.is_empty()).then_some(around)
}

/// The flat ones within `around`.
fn faces(level: &LevelParts, records: &[ShapeRecord], clear: &[bool], around: &Bounds) -> Vec<Face> {
    let mut faces = Vec::new();
    for p in &level.primitives {
        let mut add = |v: [Vec3; 3], normal: Option<Vec3>| {
            let bounds = Bounds::of(v);
            if overlap(&bounds, around, NEAR * bounds.magnitude()) {
                let shape = p.shape as usize;
                let flip = if records[shape].flip { -1.0 } else { 1.0 };
                let n =
                    normal.unwrap_or_else(|| triangle::cross_product(p.corners()).normalize_or_zero() * flip);
                // A degenerate triangle covers nothing.
                if n != Vec3::ZERO {
                    faces.push(Face { v, n, bounds, shape: p.shape, clear: clear[shape] });
                }
            }
        };
        match p.kind() {
            Kind::Triangle(_) => add(p.corners().map(Vec3::from), None),
            Kind::Analytic(i) => {
                if let Analytic::Disk(d) = &level.analytic[i as usize] {
                    fan(d).for_each(|v| add(v, Some(d.normal)));
                }
            }
            Kind::Instance(_) => {}
        }
    }
    faces
}

fn fan(d: &Disk) -> impl Iterator<Item = [Vec3; 3]> {
    let center = d.center.as_vec3a();
    let rim = move |i: usize| {
        let (sin, cos) = (i as f32 * std::f32::consts::TAU / SIDES as f32).sin_cos();
        center + d.u * cos + d.v * sin
    };
    (0..SIDES).map(move |i| [center, rim(i), rim((i + 1) % SIDES)])
}

/// Whether all of the shape lies in the plane of `f`.
fn is_sheet(faces: &[Face], f: &Face) -> bool {
    let off = |v: Vec3| f.n.dot(v - f.v[0]).abs() > NEAR * f.bounds.magnitude();
    !faces.iter().any(|g| g.shape == f.shape && g.v.into_iter().any(off))
}

fn overlap(a: &Bounds, b: &Bounds, slack: f32) -> bool {
    (a.min - slack).cmple(b.max).all() && (b.min - slack).cmple(a.max).all()
}

struct Search<'a> {
    faces: &'a [Face],
    left: usize,
    found: BTreeSet<(u32, u32)>,
}

impl Search<'_> {
    /// All pairs of `own` and `others` within a box, by halving it.
    fn join(&mut self, own: &[u32], others: &[u32], within: Bounds, depth: u32) {
        let pairs = own.len() * others.len();
        if pairs > 256 && depth < 40 {
            let extent = within.extent();
            let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
            let middle = 0.5 * (within.min[axis] + within.max[axis]);
            let (mut low, mut high) = (within, within);
            low.max[axis] = middle;
            high.min[axis] = middle;
            let halves = [low, high].map(|half| {
                let inside = |&&f: &&u32| {
                    let f = &self.faces[f as usize];
                    overlap(&f.bounds, &half, NEAR * f.bounds.magnitude())
                };
                let own: Vec<u32> = own.iter().filter(inside).copied().collect();
                let others: Vec<u32> = others.iter().filter(inside).copied().collect();
                (own, others, half)
            });
            // If most faces span the middle, halving does not help.
            if halves.iter().map(|(own, others, _)| own.len() * others.len()).sum::<usize>() < pairs / 4 * 3 {
                for (own, others, half) in halves {
                    self.join(&own, &others, half, depth + 1);
                }
                return;
            }
        }
        self.left = self.left.saturating_sub(pairs);
        if self.left == 0 {
            return;
        }
        for &a in own {
            for &o in others {
                if meet(&self.faces[a as usize], &self.faces[o as usize]) {
                    self.found.insert((a, o));
                }
            }
        }
    }
}

/// Whether `a` must give way to `o`.
fn meet(a: &Face, o: &Face) -> bool {
    // Of two clear faces, only one has to move.
    if a.shape == o.shape || o.clear && a.shape < o.shape || a.n.dot(o.n).abs() < 1.0 - 1e-4 {
        return false;
    }
    let near = NEAR * a.bounds.magnitude().max(o.bounds.magnitude());
    if !overlap(&a.bounds, &o.bounds, near) {
        return false;
    }
    let size = |f: &Face| f.bounds.extent().length_squared();
    let (large, small) = if size(a) > size(o) { (a, o) } else { (o, a) };
    small.v.into_iter().all(|v| large.n.dot(v - large.v[0]).abs() <= near) && cover(a, o, near)
}

/// Whether two coplanar triangles overlap by more than `near` (separating axes).
fn cover(a: &Face, o: &Face, near: f32) -> bool {
    let apart = |f: &Face| {
        (0..3).any(|i| {
            let edge = f.v[(i + 1) % 3] - f.v[i];
            let across = f.n.cross(edge).normalize_or_zero();
            let range = |g: &Face| {
                let at = g.v.map(|v| across.dot(v - f.v[i]));
                (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]))
            };
            let ((a0, a1), (o0, o1)) = (range(a), range(o));
            a1 - near <= o0 || o1 - near <= a0
        })
    };
    !apart(a) && !apart(o)
}
