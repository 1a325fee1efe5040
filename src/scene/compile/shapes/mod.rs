//! Shapes → world-space primitives, instances and area emitters.

mod contact;
mod copies;
mod extent;
mod lamps;
mod meshes;
mod placement;
mod split;
mod world;

use caustica_formats::ir;

use super::Compiler;
use crate::emitter::{Emitter, SceneSphere};
use crate::scene::geometry::{Geometry, Primitive};
use crate::scene::{Numbers, ShapeRecord};
use crate::shape::Analytic;

pub use meshes::load_meshes;
pub use world::{build, settle_origin};

/// What the shapes of a scene become.
pub struct Shapes {
    pub geometry: Geometry,
    pub records: Vec<ShapeRecord>,
    /// Area emitters, in shape order.
    pub emitters: Vec<Emitter>,
    pub sphere: SceneSphere,
    /// The author's coordinates of our (0, 0, 0).
    pub origin: [f64; 3],
    pub numbers: Numbers,
}

/// What a level is built from.
#[derive(Default)]
struct LevelParts {
    primitives: Vec<Primitive>,
    analytic: Vec<Analytic>,
}

/// Compiles the materials of all shapes first, so that their pictures can be decoded while meshes load.
pub fn build_materials(b: &mut Compiler<'_>) {
    for shape in every_shape(b.ir) {
        b.material(shape.bsdf, shape.emission.is_some());
    }
}

/// Of the world and of all groups.
fn every_shape(ir: &ir::Scene) -> impl Iterator<Item = &ir::Shape> {
    ir.shapes.iter().chain(ir.groups.iter().flat_map(|(_, g)| g.shapes.iter()))
}
