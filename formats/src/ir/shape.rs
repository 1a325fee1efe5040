//! Shapes, shape groups and meshes on disk.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Origin;
use super::arena::{Id, Store, Stored};
use super::bsdf::Bsdf;
use super::medium::MediumInterface;
use super::table::{file, kinds, plain, record};
use super::texture::{ColorInput, FloatInput};
use super::transform::Transform;

record! {
    /// A surface, or many as an instance of a group.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Shape {
        /// The author's id, if any.
        pub name: Option<String>,
        /// Where it was written.
        pub origin: Origin,
        /// The surface and its parameters.
        pub kind: ShapeKind,
        /// Object → world, or → group.
        pub to_world: Transform,
        /// `None`: the format's default (diffuse 0.5, black under an area light).
        pub bsdf: Option<Id<Bsdf>>,
        /// Makes the shape a lamp.
        pub emission: Option<AreaEmission>,
        /// Reverses geometric and shading normals.
        pub flip_normals: bool,
        /// Opacity of the shape itself (pbrt's `alpha`); a BSDF may be masked as well.
        pub alpha: Option<FloatInput>,
        /// The media that it parts; `None` where a ray stays in the medium it is in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        pub media: Option<MediumInterface>,
    }
}

record! {
    /// The light that leaves a shape's surface.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct AreaEmission {
        /// Where it was written.
        pub origin: Origin,
        /// Radiance leaving the side of the normal.
        pub radiance: ColorInput,
        /// Factor on `radiance`.
        pub scale: f64,
        /// Also on the other side.
        pub two_sided: bool,
        /// Along the normal only (Mitsuba's `directionalarea`).
        pub collimated: bool,
        /// pbrt: rescales the lamp to emit this many watts (mean of the channels' luminance) in all.
        pub power: Option<f64>,
    }
}

kinds! {
    /// A surface and its parameters.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum ShapeKind {
        /// A mesh in a file of its own.
        "mesh" => Mesh(file: MeshFile),
        /// A mesh written into the scene file itself.
        "inline mesh" => Inline(mesh: Arc<InlineMesh>),
        /// A whole sphere.
        "sphere" => Sphere {
            /// In object space.
            center: [f64; 3],
            /// In object space.
            radius: f64,
        },
        /// A part of a sphere at the origin, of a disk, or of a cylinder about +Z, as pbrt cuts them.
        "partial quadric" => Partial(quadric: PartialQuadric),
        /// [-1, 1]² at z = 0, normal +Z.
        "rectangle" => Rectangle,
        /// [-1, 1]³.
        "cube" => Cube,
        /// Unit disk at z = 0, normal +Z.
        "disk" => Disk,
        /// Open cylinder.
        "cylinder" => Cylinder {
            /// Middle of one end.
            p0: [f64; 3],
            /// Middle of the other end.
            p1: [f64; 3],
            /// In object space.
            radius: f64,
        },
        /// `to_world` of the shape applies after the transforms inside the group.
        "instance" => Instance {
            /// What stands here once more.
            group: Id<ShapeGroup>,
        },
    }
}

file! { MeshFile }
plain! { PartialQuadric }

/// pbrt's quadrics with their cuts; angles in degrees, u = φ/phi_max.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum PartialQuadric {
    /// About the origin.
    Sphere {
        /// Of the whole sphere.
        radius: f64,
        /// Lower cut.
        z_min: f64,
        /// Upper cut.
        z_max: f64,
        /// End of the sweep about +Z.
        phi_max: f64,
    },
    /// At z = `height`.
    Disk {
        /// z of its plane.
        height: f64,
        /// Outer radius.
        radius: f64,
        /// Radius of the hole.
        inner_radius: f64,
        /// End of the sweep about +Z.
        phi_max: f64,
    },
    /// About +Z, open.
    Cylinder {
        /// Of the circle.
        radius: f64,
        /// Lower end.
        z_min: f64,
        /// Upper end.
        z_max: f64,
        /// End of the sweep about +Z.
        phi_max: f64,
    },
}

/// Vertices in object space, in the precision of a mesh file; empty lists are absent. The shape's side
/// is that of the normals, or else of the winding in object space (as [`MeshFile::authored_normals`]).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InlineMesh {
    /// One for each vertex.
    pub positions: Vec<[f32; 3]>,
    /// One for each vertex, or none.
    pub normals: Vec<[f32; 3]>,
    /// One for each vertex, or none.
    pub uvs: Vec<[f32; 2]>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
    /// Author's surface this was made from, for comments (`bilinearmesh`, `loopsubdiv`).
    pub made_from: Option<String>,
}

/// Shapes that instances refer to; they are seen nowhere else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeGroup {
    /// The author's id, if any.
    pub name: Option<String>,
    /// Where it was written.
    pub origin: Origin,
    /// In the group's space.
    pub shapes: Vec<Shape>,
}

impl Stored for ShapeGroup {
    const STORE: Store = Store::Groups;
}

/// A triangle mesh in a file of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// As found by the resolver (relative to the scene's folder where possible).
    pub path: PathBuf,
    /// How to read it.
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

/// Formats of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MeshFormat {
    /// Wavefront OBJ, all of it.
    Obj,
    /// The faces of an OBJ that have one of its materials.
    ObjPart {
        /// Among the materials of the file, in the order of their first face.
        index: u32,
    },
    /// Stanford PLY.
    Ply,
    /// Mitsuba's own container.
    Serialized {
        /// Of the mesh in the file.
        index: u32,
    },
}
