use super::{CameraRay, Project, Window};
use crate::math::{Vec2, Vec3};

/// Parallel projection: all rays run along +Z.
#[derive(Clone, Debug)]
pub struct Orthographic {
    pub window: Window,
}

impl Orthographic {
    /// x in ±1, y in ±1/aspect (Mitsuba).
    pub fn new(aspect: f64) -> Self {
        Self { window: Window { center: Vec2::ZERO, half: Vec2::new(1.0, (1.0 / aspect) as f32) } }
    }
}

impl Project for Orthographic {
    fn ray(&self, s: Vec2) -> CameraRay {
        let p = self.window.at(s);
        CameraRay { o: Vec3::new(p.x, p.y, 0.0), d: Vec3::Z }
    }

    fn half_height(&self, _distance: f32, scale: f32) -> f32 {
        self.window.half.y * scale
    }
}
