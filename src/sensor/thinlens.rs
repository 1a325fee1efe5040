use super::CameraRay;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Thin lens: points at depth `focus_distance` are sharp.
#[derive(Clone, Debug)]
pub struct ThinLens {
    /// In scene units.
    pub aperture_radius: f32,
    /// z of the plane of focus.
    pub focus_distance: f32,
}

impl ThinLens {
    /// A ray from another place of the lens to where the sharp one meets the plane of focus.
    pub fn refract(&self, sharp: CameraRay, aperture: Vec2) -> CameraRay {
        let lens = warp::disk(aperture) * self.aperture_radius;
        let o = sharp.o + Vec3::new(lens.x, lens.y, 0.0);
        let focus = sharp.o + sharp.d * (self.focus_distance / sharp.d.z);
        CameraRay { o, d: (focus - o).normalize() }
    }
}
