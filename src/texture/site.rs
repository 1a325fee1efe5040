use crate::math::{Vec2, Vec3};

/// A point of a surface, as textures see it.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Coordinates of the parametrisation.
    pub uv: Vec2,
    /// In the compiled scene.
    pub p: Vec3,
    /// Unit geometric normal.
    pub n: Vec3,
    /// Where on which mesh, for what is stored with it.
    pub on: OnMesh,
}

impl Site {
    /// Of a picture that lies on no surface.
    pub fn flat(uv: Vec2) -> Self {
        Self { uv, p: Vec3::ZERO, n: Vec3::Z, on: OnMesh::NONE }
    }
}

/// Where on a mesh.
#[derive(Clone, Copy, Debug)]
pub struct OnMesh {
    /// Number of the shape.
    pub shape: u32,
    /// Number of the triangle in its mesh.
    pub triangle: u32,
    /// Of the second and third corner.
    pub weights: [f32; 2],
}

impl OnMesh {
    /// No place on a mesh.
    pub const NONE: Self = Self { shape: u32::MAX, triangle: 0, weights: [0.0; 2] };
}
