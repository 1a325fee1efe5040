//! How far shapes reach.

use std::collections::BTreeMap;

use super::primitive::kind;
use super::{Geometry, Kind, Level, Placement};
use crate::emitter::SceneSphere;
use crate::math::{Bounds, Vec3};
use crate::shape::Analytic;

impl Geometry {
    /// Spheres in the world around each shape that `wanted` is true of, by its number, and around each instance of a
    /// group that has such shapes.
    pub fn extents(&self, wanted: impl Fn(u32) -> bool) -> Vec<SceneSphere> {
        let mut boxes: BTreeMap<u32, Bounds> = BTreeMap::new();
        self.world.each(|shape, piece| {
            if wanted(shape) {
                boxes.entry(shape).or_insert(Bounds::EMPTY).union(&Bounds::of(piece.corners()));
            }
        });
        let sphere = |b: &Bounds| SceneSphere { center: b.center(), radius: 0.0 };
        let mut spheres: BTreeMap<u32, SceneSphere> = boxes.iter().map(|(i, b)| (*i, sphere(b))).collect();
        self.world.each(|shape, piece| {
            if let Some(sphere) = spheres.get_mut(&shape) {
                sphere.radius = sphere.radius.max(piece.reach(sphere.center));
            }
        });
        let within: Vec<Bounds> = self.groups.iter().map(|group| group.extent(&wanted)).collect();
        let placed = self.instances.iter().filter_map(|i| {
            let bounds = moved(&i.placement, &within[i.group as usize]);
            let sphere = SceneSphere { center: bounds.center(), radius: bounds.radius() };
            (!bounds.is_empty()).then_some(sphere)
        });
        spheres.into_values().chain(placed).collect()
    }
}

/// A primitive that is no instance.
enum Piece<'a> {
    Triangle([Vec3; 3]),
    Analytic(&'a Analytic),
}

impl Piece<'_> {
    /// Of it, or of a box around it.
    fn corners(&self) -> Vec<Vec3> {
        match self {
            Self::Triangle(corners) => corners.to_vec(),
            Self::Analytic(shape) => vec![shape.bounds().min, shape.bounds().max],
        }
    }

    /// How far it reaches from `center`, at most.
    fn reach(&self, center: Vec3) -> f32 {
        match self {
            Self::Triangle(corners) => corners.map(|c| c.distance(center)).into_iter().fold(0.0, f32::max),
            Self::Analytic(shape @ Analytic::Sphere(_)) => {
                let bounds = shape.bounds();
                bounds.center().distance(center) + 0.5 * bounds.extent().max_element()
            }
            Self::Analytic(shape) => {
                let bounds = shape.bounds();
                bounds.center().distance(center) + bounds.radius()
            }
        }
    }
}

impl Level {
    /// A box around the shapes that `wanted` is true of, in its own frame.
    fn extent(&self, wanted: &impl Fn(u32) -> bool) -> Bounds {
        let mut all = Bounds::EMPTY;
        self.each(|shape, piece| {
            if wanted(shape) {
                all.union(&Bounds::of(piece.corners()));
            }
        });
        all
    }

    /// The shape of each primitive that is no instance, and the primitive.
    fn each(&self, mut see: impl FnMut(u32, Piece<'_>)) {
        for packet in &self.packets {
            for (lane, (&shape, &tag)) in packet.shape.iter().zip(&packet.tag).enumerate() {
                let used = packet.others == 0 || lane < packet.others as usize;
                if shape == u32::MAX || !used {
                    continue;
                }
                let piece = match kind(tag) {
                    Kind::Analytic(i) => Piece::Analytic(&self.analytic[i as usize]),
                    _ => Piece::Triangle([0, 1, 2].map(|corner| packet.triangles.corner(corner, lane))),
                };
                see(shape, piece);
            }
        }
    }
}

/// The box around a box that is placed in the world.
pub(super) fn moved(placement: &Placement, bounds: &Bounds) -> Bounds {
    if bounds.is_empty() {
        return Bounds::EMPTY;
    }
    let (low, high) = (bounds.center() - bounds.extent() * 0.5, bounds.center() + bounds.extent() * 0.5);
    Bounds::of((0..8).map(|i| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        placement.point(Vec3::new(pick(0), pick(1), pick(2)))
    }))
}
