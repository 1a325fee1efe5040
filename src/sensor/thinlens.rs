use super::{CameraRay, Perspective};
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Thin lens: points at depth `focus_distance` are sharp.
#[derive(Clone, Debug)]
pub struct ThinLens {
    pub pinhole: Perspective,
    pub aperture_radius: f32,
    /// z of the plane of focus.
    pub focus_distance: f32,
}

impl ThinLens {
    pub fn ray(&self, s: Vec2, aperture: Vec2) -> CameraRay {
        let central = self.pinhole.ray(s).d;
        let focus = central * (self.focus_distance / central.z);
        let lens = warp::disk(aperture) * self.aperture_radius;
        let o = Vec3::new(lens.x, lens.y, 0.0);
        CameraRay { o, d: (focus - o).normalize() }
    }
}
