//! Primitives and their trees: one level for the world, one per shape group that is instanced.

mod level;
mod placement;
mod primitive;
mod search;

pub use level::{Face, Level};
pub use placement::{Instance, Placement};
pub use primitive::{Kind, MAX_INDEX, Primitive};

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub t: f32,
    /// Barycentric weights of the second and third corner (triangles).
    pub b1: f32,
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
    pub world: Level,
    pub groups: Vec<Level>,
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
