use crate::math::{Vec2, Vec3};

/// A point of a surface, as textures see it.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    pub uv: Vec2,
    /// In the compiled scene.
    pub p: Vec3,
    /// Unit geometric normal.
    pub n: Vec3,
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
    pub shape: u32,
    pub triangle: u32,
    /// Of the second and third corner.
    pub weights: [f32; 2],
}

impl OnMesh {
    pub const NONE: Self = Self { shape: u32::MAX, triangle: 0, weights: [0.0; 2] };
}
