//! The world: every group, then every shape and instance, and the trees over them.

use std::collections::HashSet;

use caustica_formats::ir::{self, ShapeKind, Transform};

use super::super::{Compiler, analytic};
use super::copies::Copies;
use super::extent::origin;
use super::meshes::{LoadedMeshes, Meshes};
use super::placement::{add_shape, placement, transform_bounds};
use super::{LevelParts, Shapes, contact};
use crate::emitter::{Emitter, SceneSphere};
use crate::math::{Bounds, Vec3};
use crate::scene::geometry::{Geometry, Instance, Level, Primitive};
use crate::scene::{Numbers, Primitives, ShapeRecord};

/// Decides where coordinates of the compiled scene begin. `camera` is where the view stands, in the author's coordinates.
pub fn settle_origin(b: &mut Compiler<'_>, loaded: LoadedMeshes<'_>, camera: Option<[f64; 3]>) -> Meshes {
    let meshes = loaded.checked(b);
    b.origin = origin(b, &meshes, camera);
    meshes
}

/// Places everything.
pub fn build(b: &mut Compiler<'_>, meshes: &Meshes) -> Shapes {
    let origin = b.origin;
    let mut world = World { copies: Copies::of(b, meshes), ..World::default() };
    world.add_groups(b, meshes);
    let to_ours = Transform::translate(origin.map(|x| -x));
    let ir = b.ir;
    let mut authors = vec![ir.origin; world.records.len()];
    for (number, shape) in (1..).zip(&ir.shapes) {
        world.add(b, meshes, shape, &to_ours.after(&shape.to_world));
        authors.resize(world.records.len(), shape.origin);
        world.count(number, shape);
    }
    let World { mut level, records, emitters, groups, instances, instance_bounds, numbers, .. } = world;
    for (shape, gap) in contact::draw_back(&mut level, &records, |r| b.transmits(r.material)) {
        let what = format!("faces of this shape coincide with another's; they are drawn back by {gap:.1e}");
        b.warn(what, authors[shape as usize]);
    }
    let world = Level::new(&level.primitives, level.analytic, &instance_bounds);
    let sphere = sphere(b, &world.bounds);
    Shapes { geometry: Geometry { world, groups, instances }, records, emitters, sphere, origin, numbers }
}

/// What has been placed so far.
#[derive(Default)]
struct World {
    level: LevelParts,
    records: Vec<ShapeRecord>,
    emitters: Vec<Emitter>,
    groups: Vec<Level>,
    /// Of the author's groups: light passes through nothing in it.
    opaque: Vec<bool>,
    instances: Vec<Instance>,
    instance_bounds: Vec<Bounds>,
    /// Group and place of every instance.
    placed: HashSet<(u32, [[u32; 3]; 4])>,
    numbers: Numbers,
    copies: Copies,
}

impl World {
    fn add_groups(&mut self, b: &mut Compiler<'_>, meshes: &Meshes) {
        for (_, group) in b.ir.groups.iter() {
            let mut parts = LevelParts::default();
            let first = self.records.len();
            for shape in &group.shapes {
                if let Some(e) = &shape.emission {
                    b.error("a shape inside a shapegroup cannot emit light", e.origin);
                }
                if matches!(shape.kind, ShapeKind::Instance { .. }) {
                    b.error("an instance cannot stand inside a shapegroup", shape.origin);
                    continue;
                }
                add_shape(b, meshes, shape, &shape.to_world, &mut parts, &mut self.records, None);
                self.count(0, shape);
            }
            self.groups.push(Level::new(&parts.primitives, parts.analytic, &[]));
            self.opaque.push(!self.records[first..].iter().any(|r| b.transmits(r.material)));
        }
    }

    /// What was added since the last call is shape `number` of the author.
    fn count(&mut self, number: u32, shape: &ir::Shape) {
        let primitives = match shape.kind {
            ShapeKind::Cube => Primitives::Cube,
            ShapeKind::Rectangle => Primitives::Rectangle,
            ShapeKind::Sphere { .. } => Primitives::One,
            _ => Primitives::Triangles,
        };
        self.numbers.records.resize(self.records.len(), (number, primitives));
        self.numbers.instances.resize(self.instances.len(), number);
    }

    /// Adds a shape of the world, or an instance of a group.
    fn add(&mut self, b: &mut Compiler<'_>, meshes: &Meshes, shape: &ir::Shape, to_world: &Transform) {
        if let Some(known) = self.copies.group(shape).map(|group| *group) {
            let group = known.unwrap_or_else(|| self.alone(b, meshes, shape));
            if let Some(kept) = self.copies.group(shape) {
                *kept = Some(group);
            }
            return self.add_instance(b, shape, group, to_world);
        }
        match &shape.kind {
            ShapeKind::Instance { group } => self.add_instance(b, shape, group.index() as u32, to_world),
            // A stretched quadric becomes an instance of the plain one; an emitting sphere becomes a mesh,
            // because instances cannot emit.
            kind if analytic::is_quadric(kind)
                && !shape.to_world.is_similarity()
                && !(shape.emission.is_some() && matches!(kind, ShapeKind::Sphere { .. })) =>
            {
                if let Some(e) = &shape.emission {
                    let what = "light from a cylinder that is not scaled evenly";
                    b.unsupported(what, "a dark cylinder", e.origin);
                }
                let group = self.alone(b, meshes, shape);
                self.add_instance(b, shape, group, to_world);
            }
            _ => {
                let emitters = Some(&mut self.emitters);
                add_shape(b, meshes, shape, to_world, &mut self.level, &mut self.records, emitters);
            }
        }
    }

    /// A group of this shape alone, without its place.
    fn alone(&mut self, b: &mut Compiler<'_>, meshes: &Meshes, shape: &ir::Shape) -> u32 {
        let mut parts = LevelParts::default();
        add_shape(b, meshes, shape, &Transform::IDENTITY, &mut parts, &mut self.records, None);
        self.groups.push(Level::new(&parts.primitives, parts.analytic, &[]));
        self.groups.len() as u32 - 1
    }

    fn add_instance(&mut self, b: &mut Compiler<'_>, shape: &ir::Shape, group: u32, to_world: &Transform) {
        let Some(placement) = placement(to_world) else {
            b.error("the to_world of this shape is singular", shape.origin);
            return;
        };
        let bounds = transform_bounds(&placement, &self.groups[group as usize].bounds);
        let place = placement.columns.map(|c| c.to_array().map(f32::to_bits));
        // A second copy of an opaque group at the same place is invisible but would cost every ray a test.
        let again = !self.placed.insert((group, place)) && self.opaque.get(group as usize) == Some(&true);
        if bounds.is_empty() || again {
            return;
        }
        self.level.primitives.push(Primitive::instance(self.instances.len() as u32));
        self.instances.push(Instance { group, placement });
        self.instance_bounds.push(bounds);
    }
}

/// The bounding sphere of the scene; a unit sphere if there is no geometry.
fn sphere(b: &mut Compiler<'_>, bounds: &Bounds) -> SceneSphere {
    if bounds.is_empty() {
        return SceneSphere { center: Vec3::ZERO, radius: 1.0 };
    }
    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
        b.error("the shapes reach farther than 32-bit floats can tell", b.ir.origin);
    }
    // A little larger than the corners need, so that light from infinity starts outside everything.
    SceneSphere { center: bounds.center(), radius: bounds.radius() * 1.001 }
}
