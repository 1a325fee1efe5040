//! Triangle meshes: bytes ↔ [`Mesh`].

use thiserror::Error;

/// Indexed triangles in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals per vertex; empty when the mesh is flat-shaded.
    pub normals: Vec<[f32; 3]>,
    /// Per vertex; empty when absent.
    pub uvs: Vec<[f32; 2]>,
    pub triangles: Vec<[u32; 3]>,
}

/// Why a mesh could not be read.
#[derive(Debug, Error)]
pub enum MeshError {
    /// Malformed bytes; the text names line, element or byte offset.
    #[error("{0}")]
    Invalid(String),
    /// Well-formed, but outside what we read.
    #[error("{0} is not supported")]
    Unsupported(String),
}

/// Options that change how a file becomes a [`Mesh`].
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshOptions {
    /// Drop the file's normals and compute none.
    pub face_normals: bool,
    /// v → 1 − v.
    pub flip_tex_coords: bool,
    /// Crease angle in degrees (Mitsuba 0.6 `maxSmoothAngle`).
    pub max_smooth_angle: Option<f64>,
}
