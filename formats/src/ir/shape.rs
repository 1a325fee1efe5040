//! Shapes, shape groups and meshes on disk.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Bsdf, ColorInput, FloatInput, Id, Origin, Transform};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// The author's id, if any.
    pub name: Option<String>,
    pub origin: Origin,
    pub kind: ShapeKind,
    pub to_world: Transform,
    /// `None`: the format's default (diffuse 0.5, black under an area light).
    pub bsdf: Option<Id<Bsdf>>,
    /// Makes the shape a lamp.
    pub emission: Option<AreaEmission>,
    /// Reverses geometric and shading normals.
    pub flip_normals: bool,
    /// Opacity of the shape itself (pbrt's `alpha`); a BSDF may be masked as well.
    pub alpha: Option<FloatInput>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaEmission {
    pub origin: Origin,
    /// Radiance leaving the side of the normal.
    pub radiance: ColorInput,
    pub scale: f64,
    pub two_sided: bool,
    /// Along the normal only (Mitsuba's `directionalarea`).
    pub collimated: bool,
    /// pbrt: rescales the lamp to emit this many watts (mean of the channels' luminance) in all.
    pub power: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShapeKind {
    Mesh(MeshFile),
    /// A mesh written into the scene file itself.
    Inline(Arc<InlineMesh>),
    Sphere {
        center: [f64; 3],
        radius: f64,
    },
    /// A part of a sphere at the origin, of a disk, or of a cylinder about +Z, as pbrt cuts them.
    Partial(PartialQuadric),
    /// [-1, 1]² at z = 0, normal +Z.
    Rectangle,
    /// [-1, 1]³.
    Cube,
    /// Unit disk at z = 0, normal +Z.
    Disk,
    /// Open cylinder from `p0` to `p1`.
    Cylinder {
        p0: [f64; 3],
        p1: [f64; 3],
        radius: f64,
    },
    /// `to_world` of the shape applies after the transforms inside the group.
    Instance {
        group: Id<ShapeGroup>,
    },
}

/// pbrt's quadrics with their cuts; angles in degrees, u = φ/phi_max.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PartialQuadric {
    Sphere { radius: f64, z_min: f64, z_max: f64, phi_max: f64 },
    Disk { height: f64, radius: f64, inner_radius: f64, phi_max: f64 },
    Cylinder { radius: f64, z_min: f64, z_max: f64, phi_max: f64 },
}

/// Vertices in object space, in the precision of a mesh file; empty lists are absent. The shape's side
/// is that of the normals, or else of the winding in object space (as [`MeshFile::authored_normals`]).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InlineMesh {
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub triangles: Vec<[u32; 3]>,
    /// Author's surface this was made from, for comments (`bilinearmesh`, `loopsubdiv`).
    pub made_from: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeGroup {
    pub name: Option<String>,
    pub origin: Origin,
    pub shapes: Vec<Shape>,
}

/// A triangle mesh in a file of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// As found by the resolver (relative to the scene's folder where possible).
    pub path: PathBuf,
    pub format: MeshFormat,
    /// Flat shading; normals of the file are ignored.
    pub face_normals: bool,
    /// pbrt: normals are used where the file has them and never computed; the shape's side is that of
    /// those normals, or else of the winding in object space.
    pub authored_normals: bool,
    /// v → 1 − v.
    pub flip_tex_coords: bool,
    /// Mitsuba 0.6 `maxSmoothAngle`: crease angle in degrees.
    pub max_smooth_angle: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MeshFormat {
    Obj,
    Ply,
    /// Mitsuba's own container; the index of the mesh in the file.
    Serialized {
        index: u32,
    },
}
