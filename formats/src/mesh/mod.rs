//! Triangle meshes: bytes ↔ [`Mesh`].
//!
//! Polygons become fans around their first corner, degenerate triangles are kept, and vertex
//! normals that are missing or unusable are computed (angle-weighted) unless the mesh is to be flat.

mod attributes;
pub mod builtin;
mod creases;
mod normals;
mod obj;
mod ply;
mod ply_write;
mod serialized;

use thiserror::Error;

use crate::files::{MAX_FILE_BYTES, is_gzip, unpack};
use crate::ir::MeshFormat;
use crate::misnamed;

pub use attributes::Attribute;
pub use obj::{ObjMaterial, ObjParts, obj_parts, read_mtl, read_obj, read_obj_part};
pub use ply::read_ply;
use ply::skipped_attributes;
pub use ply_write::write_ply;
pub use serialized::{read_serialized, serialized_count};

/// Indexed triangles in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// One for each vertex.
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals per vertex; empty when the mesh is flat-shaded.
    pub normals: Vec<[f32; 3]>,
    /// Whether all normals were computed from the triangles. Those face where the winding in the world says, as
    /// Mitsuba computes them after the transform: a mirror turns them. An author's normals keep their side.
    pub computed_normals: bool,
    /// Per vertex; empty when absent.
    pub uvs: Vec<[f32; 2]>,
    /// Three vertices each, counter-clockwise as seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Further values per vertex or triangle.
    pub attributes: Vec<Attribute>,
}

/// Why a mesh could not be read.
#[derive(Debug, Error)]
pub enum MeshError {
    /// Malformed bytes; the text names line, element or byte offset.
    #[error("{0}")]
    Invalid(String),
    /// Well-formed, but not supported.
    #[error("{0} is not supported")]
    Unsupported(String),
}

/// Options that change how a file becomes a [`Mesh`].
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshOptions {
    /// Drop the file's normals and compute none.
    pub face_normals: bool,
    /// Keep the file's normals as they are and compute none.
    pub authored_normals: bool,
    /// v → 1 − v.
    pub flip_tex_coords: bool,
    /// Crease angle in degrees (Mitsuba 0.6 `maxSmoothAngle`): the file's normals are replaced, and
    /// vertices are split where neighbouring faces meet at a larger angle.
    pub max_smooth_angle: Option<f64>,
}

/// Reads a mesh of a known format, which may be gzipped. A mesh without triangles is not an error.
///
/// # Errors
/// When the bytes are not a mesh of this format, with the line, element or offset.
pub fn read(format: MeshFormat, bytes: &[u8], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let unpacked;
    let bytes = if is_gzip(bytes) {
        unpacked = unpack(bytes, MAX_FILE_BYTES).map_err(MeshError::Invalid)?;
        &unpacked
    } else {
        bytes
    };
    let as_expected = match format {
        MeshFormat::Obj | MeshFormat::ObjPart { .. } if is_ply(bytes) => {
            return Err(MeshError::Invalid("it is a PLY file, which shape `ply` reads".to_owned()));
        }
        MeshFormat::Obj | MeshFormat::ObjPart { .. } => true,
        MeshFormat::Ply => bytes.starts_with(b"ply"),
        MeshFormat::Serialized { .. } => bytes.starts_with(&serialized::MAGIC.to_le_bytes()),
    };
    let other =
        if as_expected { misnamed::named(bytes).map(str::to_owned) } else { misnamed::not_binary(bytes) };
    if let Some(what) = other {
        return Err(MeshError::Invalid(format!("it is {what}")));
    }
    match format {
        MeshFormat::Obj => read_obj(bytes, options),
        MeshFormat::ObjPart { index } => read_obj_part(bytes, index, options),
        MeshFormat::Ply => read_ply(bytes, options),
        MeshFormat::Serialized { index } => read_serialized(bytes, index, options),
    }
}

/// Whether a file says that it is PLY: as statements of OBJ these lines would all be skipped.
fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// Attributes that [`read`] leaves out of the mesh, with their number of components.
///
/// # Errors
/// When the header of the file is malformed.
pub fn skipped(format: MeshFormat, bytes: &[u8]) -> Result<Vec<(String, usize)>, MeshError> {
    match format {
        MeshFormat::Ply if is_gzip(bytes) => {
            skipped_attributes(&unpack(bytes, MAX_FILE_BYTES).map_err(MeshError::Invalid)?)
        }
        MeshFormat::Ply => skipped_attributes(bytes),
        MeshFormat::Obj | MeshFormat::ObjPart { .. } | MeshFormat::Serialized { .. } => Ok(Vec::new()),
    }
}

/// Applies the options to what a reader found. `mesh.normals` is empty or holds one entry per
/// vertex, in which anything that cannot be normalised counts as missing.
fn finish(mut mesh: Mesh, options: &MeshOptions) -> Mesh {
    for uv in &mut mesh.uvs {
        if !(uv[0].is_finite() && uv[1].is_finite()) {
            *uv = [0.0; 2];
        }
        if options.flip_tex_coords {
            uv[1] = 1.0 - uv[1];
        }
    }
    if options.face_normals {
        mesh.normals.clear();
        mesh
    } else if options.authored_normals {
        for normal in &mut mesh.normals {
            *normal = normals::unit(normal.map(f64::from)).unwrap_or([0.0; 3]);
        }
        mesh
    } else if let Some(degrees) = options.max_smooth_angle {
        creases::split(&mesh, degrees)
    } else {
        normals::complete(&mut mesh);
        mesh
    }
}

/// Fails on the first triangle that names a vertex which does not exist.
fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let count = mesh.positions.len();
    let bad = mesh.triangles.iter().flatten().position(|&index| index as usize >= count);
    bad.map_or(Ok(()), |corner| {
        let (triangle, index) = (corner / 3, mesh.triangles[corner / 3][corner % 3]);
        Err(MeshError::Invalid(format!(
            "triangle {triangle} refers to vertex {index}, but the mesh has {count} vertices"
        )))
    })
}

#[cfg(test)]
mod tests;
