//! Where discs on a plane lie free: fully on the surface, with nothing else near. There the boundary test has one answer,
//! which is known without rays.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::math::{LIFT, Vec3};
use crate::scene::{Near, Scene};

/// How far from each place the nearest thing is that does not belong to its plane, up to a limit. By cell of a grid, which
/// is filled where it is asked.
#[derive(Debug)]
pub struct Clearance {
    /// Size of a cell: the radius of the widest disc.
    size: f32,
    /// No more is asked for.
    most: f32,
    /// Cell and clearance; 0 is none.
    slots: Vec<AtomicU64>,
}

/// How many cells are remembered.
const SLOTS: usize = 1 << 17;

/// Bits of a cell's number along an axis.
const BITS: u32 = 18;

/// Steps in which a clearance is remembered.
const STEPS: f32 = 254.0;

/// Where more things than these are near, no disc is said to be free.
const MANY: usize = 64;

/// What the boundary test looks at is not farther from the centre than this times the radius.
const HIGHEST: f32 = 1.05;

impl Clearance {
    /// For discs of `radius` and smaller ones.
    pub fn new(radius: f32) -> Self {
        let slots = (0..SLOTS).map(|_| AtomicU64::new(0)).collect();
        Self { size: radius, most: 2.0 * HIGHEST * radius, slots }
    }

    /// Whether the disc of `radius` around the place `p` of a surface, whose rays start at the height `lift`, is surely free.
    pub fn is_free(&self, scene: &Scene, p: Vec3, lift: f32, radius: f32) -> bool {
        let needed = HIGHEST * radius + 2.0 * lift;
        let cell = (p / self.size).floor();
        let half = (1u32 << (BITS - 1)) as f32;
        if needed > self.most || !cell.abs().cmplt(Vec3::splat(half)).all() {
            return false;
        }
        let number = |axis: usize| (cell[axis] + half) as u64;
        let key = number(0) | number(1) << BITS | number(2) << (2 * BITS);
        // Cells of a neighbourhood fall into slots of their own.
        let slot = number(0) + 41 * number(1) + 1681 * number(2);
        let slot = &self.slots[slot as usize % SLOTS];
        let mut held = slot.load(Ordering::Relaxed);
        if held & 0xff == 0 || held >> 8 != key {
            let steps = (self.clearance(scene, cell) / self.most * STEPS) as u64;
            held = key << 8 | (steps + 1);
            slot.store(held, Ordering::Relaxed);
        }
        needed <= ((held & 0xff) - 1) as f32 * (self.most / STEPS)
    }

    /// Of all places of a cell.
    fn clearance(&self, scene: &Scene, cell: Vec3) -> f32 {
        let center = (cell + 0.5) * self.size;
        let corner = 0.87 * self.size;
        let reach = corner + self.most;
        let (mut triangles, mut others, mut seen) = (Vec::new(), reach, 0);
        scene.geometry.near(center, reach, |near| {
            seen += 1;
            match near {
                Near::Triangle(triangle) if to_triangle(center, triangle) < reach => triangles.push(triangle),
                Near::Triangle(_) => {}
                Near::Other(distance) => others = others.min(distance),
            }
            seen <= MANY && others > corner
        });
        if seen > MANY {
            return 0.0;
        }
        (others.min(room(&triangles, center)) - corner).clamp(0.0, self.most)
    }
}

/// How far `p` is from the nearest triangle that does not lie in the plane of the nearest, and from the edges of the union of
/// those that do.
fn room(triangles: &[[Vec3; 3]], p: Vec3) -> f32 {
    let distance = |t: &&[Vec3; 3]| to_triangle(p, **t);
    let Some([a, b, c]) = triangles.iter().min_by(|s, t| distance(s).total_cmp(&distance(t))) else {
        return 0.0;
    };
    let normal = (*b - *a).cross(*c - *a).normalize_or_zero();
    // Rays of the test start at the height of the lift.
    let tolerance = 0.25 * LIFT * a.abs().max_element();
    let (flat, others): (Vec<_>, Vec<_>) =
        triangles.iter().partition(|t| t.iter().all(|&v| (v - *a).dot(normal).abs() <= tolerance));
    let edges = |t: &[Vec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let shared = |of: usize, [from, to]: [Vec3; 2]| {
        let same = |edge: &[Vec3; 2]| *edge == [from, to] || *edge == [to, from];
        flat.iter().enumerate().any(|(i, t)| i != of && edges(t).iter().any(same))
    };
    let rims = flat
        .iter()
        .enumerate()
        .flat_map(|(i, t)| edges(t).into_iter().filter(move |&edge| !shared(i, edge)).collect::<Vec<_>>());
    let to_rim = rims.map(|[from, to]| to_segment(p, from, to));
    to_rim.chain(others.iter().map(|t| to_triangle(p, *t))).fold(f32::INFINITY, f32::min)
}

fn to_segment(p: Vec3, from: Vec3, to: Vec3) -> f32 {
    let along = to - from;
    let t = (p - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
    p.distance(from + along * t.clamp(0.0, 1.0))
}

fn to_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let normal = (b - a).cross(c - a);
    let inside = |from: Vec3, to: Vec3| (to - from).cross(p - from).dot(normal) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        return (p - a).dot(normal.normalize_or_zero()).abs();
    }
    to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
}
