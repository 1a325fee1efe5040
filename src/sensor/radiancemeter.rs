use super::{CameraRay, Line, Project, ThinLens, Window};
use crate::math::{Vec2, Vec3};
use crate::sampling::Density;

/// One ray, the axis +Z: all of the film sees the same radiance.
#[derive(Clone, Debug)]
pub struct Radiancemeter;

/// A ray has no width; photons are gathered around its end as for a pixel of a picture 1000 rows high that spans 90°.
const HALF_PIXEL: f32 = 1e-3;

impl Project for Radiancemeter {
    fn ray(&self, _s: Vec2) -> CameraRay {
        CameraRay { o: Vec3::ZERO, d: Vec3::Z }
    }

    fn half_height(&self, distance: f32, _scale: f32) -> f32 {
        HALF_PIXEL * distance
    }

    fn window(&self) -> Window {
        Window { center: Vec2::ZERO, half: Vec2::ZERO }
    }

    fn window_point(&self, p: Vec3) -> Vec2 {
        Vec2::new(p.x, p.y)
    }

    fn start(&self, on_window: Vec2) -> Vec2 {
        on_window
    }

    fn through(&self, p: Vec3, _lens: Vec2, _focus: f32) -> Line {
        Line { at: Vec2::new(p.x, p.y), slope: Vec2::ZERO }
    }

    fn densities(&self, _cos: f32, _scale: f32, _lens: Option<&ThinLens>) -> [Density; 2] {
        [Density::Delta; 2]
    }

    fn is_parallel(&self) -> bool {
        true
    }
}
