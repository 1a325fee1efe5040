//! Copies of one large mesh in many places.

use std::collections::HashMap;
use std::path::PathBuf;

use caustica_formats::ir::{self, ShapeKind};
use caustica_formats::mesh::Mesh;

use super::super::Compiler;
use super::every_shape;
use super::meshes::{Meshes, cache_key};
use crate::math::{Bounds, Vec3};

/// Copies of a mesh become instances of one when they have so many triangles beyond the first copy: sorting those into
/// the tree of the world takes half a second and 200 MB.
const MANY: usize = 1_000_000;

/// In a mesh with fewer triangles, going from one tree to another costs rays more than it saves.
const LARGE: usize = 1_000;

/// A mesh farther from its own origin than this many times its size is placed in double precision.
const FAR: f32 = 16.0;

/// What is the same in all copies.
type Key = ((PathBuf, String), Option<ir::Id<ir::Bsdf>>, bool);

fn key(shape: &ir::Shape) -> Option<Key> {
    let ShapeKind::Mesh(file) = &shape.kind else { return None };
    // A mirror turns the winding, and an uneven scale the normals between those of the corners; lamps stand alone.
    let placed = shape.to_world.is_similarity() && shape.to_world.determinant3() > 0.0;
    (placed && shape.emission.is_none()).then(|| (cache_key(file), shape.bsdf, shape.flip_normals))
}

/// Whether single precision tells its corners apart as well in its own space as in the world.
fn is_centered(mesh: &Mesh) -> bool {
    let bounds = Bounds::of(mesh.positions.iter().map(|p| Vec3::from(*p)));
    bounds.magnitude() <= FAR * bounds.extent().max_element()
}

/// The groups that copies are instances of, each made when its first copy is placed.
#[derive(Default)]
pub struct Copies(HashMap<Key, Option<u32>>);

impl Copies {
    /// None where light passes through anything: faces that lie flush are told apart among the triangles of the world
    /// only.
    pub fn of(b: &mut Compiler<'_>, meshes: &Meshes) -> Self {
        let ir = b.ir;
        let clear = every_shape(ir).any(|shape| {
            let material = b.material(shape.bsdf, shape.emission.is_some());
            b.transmits(material)
        });
        if clear {
            return Self::default();
        }
        let mut counts: HashMap<Key, usize> = HashMap::new();
        ir.shapes.iter().filter_map(key).for_each(|key| *counts.entry(key).or_default() += 1);
        let many = |(key, copies): (Key, usize)| {
            let mesh = meshes.get(&key.0)?.as_ref()?;
            let triangles = mesh.triangles.len();
            let more = (copies - 1).saturating_mul(triangles);
            (triangles >= LARGE && more >= MANY && is_centered(mesh)).then_some((key, None))
        };
        Self(counts.into_iter().filter_map(many).collect())
    }

    /// Where the group of a shape is kept, if the shape is one of many copies.
    pub fn group(&mut self, shape: &ir::Shape) -> Option<&mut Option<u32>> {
        if self.0.is_empty() {
            return None;
        }
        self.0.get_mut(&key(shape)?)
    }
}
