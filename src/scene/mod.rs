//! The compiled scene: world-space geometry, linear RGB, nothing left that can fail.

pub mod compile;
mod facts;
mod geometry;
mod lamps;
mod surface;
mod view;

pub use facts::Facts;
pub use geometry::{Face, Geometry, Hit, Instance, Kind, Level, NO_INSTANCE, Placement};
pub use surface::{PhotonSide, Surface};
pub use view::View;

use crate::bsdf::Material;
use crate::emitter::{Emitter, SceneSphere};
use crate::sampling::Discrete;
use crate::texture::Textures;

/// A shape's material and what its mesh carries per vertex.
#[derive(Debug)]
pub struct ShapeRecord {
    pub material: u32,
    /// Index into `Scene::emitters`.
    pub emitter: Option<u32>,
    /// Normals are reversed.
    pub flip: bool,
    /// The shading frame follows ∂p/∂u, because the material asks for it.
    pub oriented: bool,
    pub triangles: Vec<[u32; 3]>,
    /// Unit, in the frame of the level; empty for flat shading.
    pub normals: Vec<[f32; 3]>,
    /// Empty when absent.
    pub uvs: Vec<[f32; 2]>,
}

/// Everything a render needs. Coordinates are relative to `origin`, a point of the author's scene
/// near the camera, so that what is seen close is precise wherever it stands.
#[derive(Debug)]
pub struct Scene {
    pub geometry: Geometry,
    pub shapes: Vec<ShapeRecord>,
    pub materials: Vec<Material>,
    pub textures: Textures,
    pub emitters: Vec<Emitter>,
    /// By power, for photons.
    pub emission: Discrete,
    /// Half uniform, half by power, for direct light: a lamp in sight may be the weakest.
    pub direct: Discrete,
    /// Emitters that fill the sky; their light adds up.
    pub environments: Vec<u32>,
    pub sphere: SceneSphere,
    pub origin: [f64; 3],
}
