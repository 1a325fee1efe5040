//! Shapes, shape groups and meshes on disk.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{Bsdf, ColorInput, Id, Origin, Transform};

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
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AreaEmission {
    pub origin: Origin,
    /// Radiance leaving the side of the normal.
    pub radiance: ColorInput,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ShapeKind {
    Mesh(MeshFile),
    Sphere {
        center: [f64; 3],
        radius: f64,
    },
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
