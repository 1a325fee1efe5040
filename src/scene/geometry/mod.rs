//! Primitives and their trees: one level for the world, one per shape group that is instanced.

mod extent;
mod level;
mod near;
mod placement;
mod primitive;
mod search;

pub use level::{Face, Level};
pub use near::Near;
pub use placement::{Instance, Placement};
pub use primitive::{Kind, MAX_INDEX, Primitive};

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Ray parameter, in lengths of the ray's direction.
    pub t: f32,
    /// Barycentric weight of the second corner of a triangle.
    pub b1: f32,
    /// The same for the third corner.
    pub b2: f32,
    /// Packet of the level, and the lane in it.
    packet: u32,
    lane: u32,
    /// Instance the primitive was reached through; [`NO_INSTANCE`] for the world itself.
    pub instance: u32,
}

/// [`Hit::instance`] of what stands in the world itself.
pub const NO_INSTANCE: u32 = u32::MAX;

/// Everything rays can meet.
#[derive(Debug)]
pub struct Geometry {
    /// Everything that is placed once, and the instances.
    pub world: Level,
    /// What instances place.
    pub groups: Vec<Level>,
    /// By the instance number of a hit.
    pub instances: Vec<Instance>,
}

impl Geometry {
    /// Level that holds the primitive of `hit`.
    pub fn level(&self, instance: u32) -> &Level {
        match self.instances.get(instance as usize) {
            Some(i) => &self.groups[i.group as usize],
            None => &self.world,
        }
    }

    /// Memory held by trees and packets.
    pub fn bytes(&self) -> usize {
        self.world.bytes() + self.groups.iter().map(Level::bytes).sum::<usize>()
    }
}
