//! A shape placed in a level: the world, or a group that is placed by instances.

use caustica_formats::ir::{self, Transform};
use caustica_formats::mesh::Mesh;

use super::super::Compiler;
use super::super::analytic::{self, Quadric};
use super::super::attributes::with_default_uvs;
use super::meshes::{Form, Meshes, add_mesh, form, is_authored, oriented_by_author};
use super::split::{self, Pieces};
use super::{LevelParts, lamps};
use crate::emitter::{Emitter, Surface};
use crate::math::{Bounds, Vec3};
use crate::scene::ShapeRecord;
use crate::scene::geometry::{MAX_INDEX, Placement, Primitive};

/// Adds a shape that is not an instance, placed by `to_level`. The shapes of the world come with the list of
/// lamps; those of groups cannot emit.
pub fn add_shape(
    b: &mut Compiler<'_>,
    meshes: &Meshes,
    shape: &ir::Shape,
    to_level: &Transform,
    level: &mut LevelParts,
    records: &mut Vec<ShapeRecord>,
    emitters: Option<&mut Vec<Emitter>>,
) {
    if to_level.inverse().is_none() {
        b.error("the to_world of this shape is singular", shape.origin);
        return;
    }
    let index = records.len() as u32;
    let material = b.material(shape.bsdf, shape.emission.is_some());
    let mut record = ShapeRecord {
        material,
        emitter: None,
        boundary: b.boundary(shape.media),
        flip: shape.flip_normals,
        oriented: b.oriented(material),
        varies: shines_by_texture(shape) || b.varies(material),
        triangles: Vec::new(),
        authored: Vec::new(),
        normals: Vec::new(),
        uvs: Vec::new(),
    };
    let Some(form) = form(b, meshes, shape, to_level) else { return };
    let mesh = match &form {
        Form::Triangles(mesh) => Some(mesh.as_ref()),
        Form::Quadric(_) => None,
    };
    let varies = record.varies;
    record.varies |= b.options.keep_uvs;
    // Without authored uv, the pieces of a split triangle would have other uv than the whole.
    let own_uvs = |m: &Mesh| !m.uvs.is_empty() || !varies;
    // Only the world has its origin near the camera; groups do not.
    let pieces = mesh.filter(|m| emitters.is_some() && own_uvs(m)).and_then(|m| split::split(m, to_level));
    let mesh = match pieces {
        Some(Pieces { ref mesh, authored }) => {
            record.authored = authored;
            Some(mesh)
        }
        None => mesh,
    };
    b.attach_attributes(material, mesh, index, shape.origin);
    let surface = match &form {
        Form::Triangles(whole) => {
            let mesh = mesh.unwrap_or(whole);
            // Layers may show the texture coordinates of all.
            let uvs_matter = record.varies;
            add_triangles(b, shape, mesh, to_level, index, uvs_matter, level, &mut record)
        }
        Form::Quadric(quadric) => add_quadric(b, shape, quadric, to_level, index, level, &mut record),
    };
    let Ok(surface) = surface else { return };
    if let (Some(emission), Some(surface), Some(emitters)) = (&shape.emission, surface, emitters) {
        lamps::add_lamp(b, emission, shape, surface, &mut record, emitters);
    }
    records.push(record);
}

fn shines_by_texture(shape: &ir::Shape) -> bool {
    shape.emission.as_ref().is_some_and(|e| matches!(e.radiance, ir::ColorInput::Texture(_)))
}

/// An error that is already among the diagnostics.
struct Reported;

/// The triangles of a mesh as shape `index`; its surface where it emits.
fn add_triangles(
    b: &mut Compiler<'_>,
    shape: &ir::Shape,
    mesh: &Mesh,
    to_level: &Transform,
    index: u32,
    uvs_matter: bool,
    level: &mut LevelParts,
    record: &mut ShapeRecord,
) -> Result<Option<Surface>, Reported> {
    if mesh.triangles.len() > MAX_INDEX {
        b.error(format!("a mesh of {} triangles is too large", mesh.triangles.len()), shape.origin);
        return Err(Reported);
    }
    let first = level.primitives.len();
    let oriented;
    let mesh = if is_authored(&shape.kind) {
        let mirrored = to_level.determinant3() < 0.0;
        oriented = if mesh.uvs.is_empty() && uvs_matter {
            oriented_by_author(&with_default_uvs(mesh), mirrored)
        } else {
            oriented_by_author(mesh, mirrored)
        };
        &oriented
    } else {
        mesh
    };
    add_mesh(mesh, to_level, index, uvs_matter || record.oriented, level, record);
    Ok(shape.emission.is_some().then(|| lamps::lamp_mesh(&level.primitives[first..], record)))
}

/// A sphere, disk or cylinder as shape `index`, and its surface.
fn add_quadric(
    b: &mut Compiler<'_>,
    shape: &ir::Shape,
    quadric: &Quadric,
    to_level: &Transform,
    index: u32,
    level: &mut LevelParts,
    record: &mut ShapeRecord,
) -> Result<Option<Surface>, Reported> {
    let Some(quadric) = analytic::place(quadric, to_level, shape.flip_normals) else {
        b.error("the shape's radius, length or axes are degenerate", shape.origin);
        return Err(Reported);
    };
    record.flip = false;
    level.primitives.push(Primitive::analytic(index, level.analytic.len() as u32));
    level.analytic.push(quadric.clone());
    Ok(Some(Surface::Analytic(quadric)))
}

/// A transform in single precision with its inverse; `None` for a singular one.
pub fn placement(m: &Transform) -> Option<Placement> {
    let columns = |m: &Transform| {
        std::array::from_fn(|c| Vec3::new(m.0[0][c] as f32, m.0[1][c] as f32, m.0[2][c] as f32))
    };
    Some(Placement { columns: columns(m), inverse: columns(&m.inverse()?) })
}

/// The box around a placed box.
pub fn transform_bounds(m: &Placement, b: &Bounds) -> Bounds {
    let mut out = Bounds::EMPTY;
    if !b.is_empty() {
        for i in 0..8 {
            let pick = |bit: usize, lo: f32, hi: f32| if i >> bit & 1 == 0 { lo } else { hi };
            out.add(m.point(Vec3::new(
                pick(0, b.min.x, b.max.x),
                pick(1, b.min.y, b.max.y),
                pick(2, b.min.z, b.max.z),
            )));
        }
    }
    out
}
