//! The compiled scene: world-space geometry, linear RGB, nothing left that can fail.

pub mod compile;
mod facts;
mod geometry;
mod lamp_choice;
mod lamps;
mod media;
mod shown;
mod surface;
mod view;

pub use facts::Facts;
pub use geometry::{Face, Geometry, Hit, Instance, Kind, Level, NO_INSTANCE, Near, Placement};
pub use lamp_choice::LampChoice;
pub use lamps::LightStart;
pub use media::LampMedium;
pub use shown::{Numbers, Primitives};
pub use surface::{PhotonSide, Surface};
pub use view::View;

use crate::bsdf::Material;
use crate::emitter::{Emitter, SceneSphere};
use crate::medium::{Boundary, Medium};
use crate::sampling::Discrete;
use crate::texture::Textures;

/// A shape's material and what its mesh carries per vertex.
#[derive(Debug)]
pub struct ShapeRecord {
    /// Index into `Scene::materials`.
    pub material: u32,
    /// Index into `Scene::emitters`.
    pub emitter: Option<u32>,
    /// Where it is a boundary between media; elsewhere a ray keeps its medium.
    pub boundary: Option<Boundary>,
    /// Normals are reversed.
    pub flip: bool,
    /// The shading frame follows ∂p/∂u, because the material asks for it.
    pub oriented: bool,
    /// What it looks like depends on texture coordinates, or they are shown.
    pub varies: bool,
    /// Corners as indices into `normals` and `uvs`; empty where both are.
    pub triangles: Vec<[u32; 3]>,
    /// The author's numbers of the triangles, where some were split; empty where not.
    pub authored: Vec<u32>,
    /// Unit, in the frame of the level; empty for flat shading.
    pub normals: Vec<[f32; 3]>,
    /// Empty when absent.
    pub uvs: Vec<[f32; 2]>,
}

/// What rays meet and what shines. Lengths are the author's units; coordinates are relative to `origin`, a
/// point of the author's scene near the camera, so that single precision is finest where it is seen best.
#[derive(Debug)]
pub struct Scene {
    /// What rays can meet.
    pub geometry: Geometry,
    /// By the shape number of a hit.
    pub shapes: Vec<ShapeRecord>,
    /// What shapes refer to.
    pub materials: Vec<Material>,
    /// What materials and emitters refer to.
    pub textures: Textures,
    /// Straight light through thin panes is a passage: it has not scattered, and shadow rays go through.
    pub panes_pass: bool,
    /// Segments of a path that a straight passage through a mask or a boundary of one index costs: 1 as with Mitsuba's
    /// `path`, 0 as with its `volpath` and with pbrt.
    pub passage: u32,
    /// What boundaries and lamps refer to.
    pub media: Vec<Medium>,
    /// Their names, by the author or by number.
    pub medium_names: Vec<String>,
    /// Lamps of all kinds: shapes that emit first.
    pub emitters: Vec<Emitter>,
    /// What each lamp stands in.
    pub lamp_media: Vec<LampMedium>,
    /// By power, for photons.
    pub emission: Discrete,
    /// For direct light: half uniform, half by power, because a weak lamp nearby may matter most; of many
    /// lamps, by their distance as well.
    pub direct: LampChoice,
    /// Emitters that fill the sky; their light adds up.
    pub environments: Vec<u32>,
    /// Around all geometry.
    pub sphere: SceneSphere,
    /// The author's coordinates of (0, 0, 0).
    pub origin: [f64; 3],
    /// How the author's scene counts its shapes.
    pub numbers: Numbers,
}
