use crate::math::{Vec2, Vec3};

/// A point of a surface, as textures see it.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    pub uv: Vec2,
    /// In the compiled scene.
    pub p: Vec3,
    /// Unit geometric normal.
    pub n: Vec3,
}

impl Site {
    /// Of a picture that lies on no surface.
    pub fn flat(uv: Vec2) -> Self {
        Self { uv, p: Vec3::ZERO, n: Vec3::Z }
    }
}
