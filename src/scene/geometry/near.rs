//! What lies near a place.

use super::extent::moved;
use super::primitive::kind;
use super::{Geometry, Kind};
use crate::math::{Bounds, Vec3};
use crate::shape::Analytic;
use crate::shape::triangle::WIDTH;

/// A thing near a place.
#[derive(Clone, Copy, Debug)]
pub enum Near {
    /// A triangle.
    Triangle([Vec3; 3]),
    /// Anything else, by its least distance.
    Other(f32),
}

impl Geometry {
    /// Calls `see` with all that is within `radius` of `p`, and with some that is not, until it returns false.
    pub fn near(&self, p: Vec3, radius: f32, mut see: impl FnMut(Near) -> bool) {
        let level = &self.world;
        level.bvh.near(&Bounds { min: p - radius, max: p + radius }, |packets| {
            level.packets[packets].iter().all(|packet| {
                let used = if packet.others > 0 { packet.others as usize } else { WIDTH };
                (0..used).filter(|&lane| packet.shape[lane] != u32::MAX || packet.others > 0).all(|lane| {
                    see(match kind(packet.tag[lane]) {
                        Kind::Triangle(_) => {
                            Near::Triangle([0, 1, 2].map(|i| packet.triangles.corner(i, lane)))
                        }
                        Kind::Analytic(i) => Near::Other(to_shape(&level.analytic[i as usize], p)),
                        Kind::Instance(i) => {
                            let instance = &self.instances[i as usize];
                            let group = &self.groups[instance.group as usize];
                            Near::Other(to_box(&moved(&instance.placement, &group.bounds), p))
                        }
                    })
                })
            })
        });
    }
}

fn to_box(bounds: &Bounds, p: Vec3) -> f32 {
    (p - p.clamp(bounds.min, bounds.max)).length()
}

fn to_shape(shape: &Analytic, p: Vec3) -> f32 {
    let bounds = shape.bounds();
    match shape {
        Analytic::Sphere(_) => (p.distance(bounds.center()) - 0.5 * bounds.extent().max_element()).abs(),
        _ => to_box(&bounds, p),
    }
}
