use super::{CameraRay, Line, Project, ThinLens, Window};
use crate::math::{Vec2, Vec3};
use crate::sampling::Density;

/// Parallel projection: all rays run along +Z.
#[derive(Clone, Debug)]
pub struct Orthographic {
    /// What the film shows, in camera space.
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

    fn window(&self) -> Window {
        self.window
    }

    fn window_point(&self, p: Vec3) -> Vec2 {
        Vec2::new(p.x, p.y)
    }

    fn start(&self, on_window: Vec2) -> Vec2 {
        on_window
    }

    fn through(&self, p: Vec3, lens: Vec2, focus: f32) -> Line {
        let slope = -lens / focus;
        Line { at: Vec2::new(p.x, p.y) - slope * p.z, slope }
    }

    /// Even over the window. The place on the lens decides the direction alone: at the depth f of the plane
    /// of focus it covers a solid angle of cos³/f² times its area.
    fn densities(&self, cos: f32, scale: f32, lens: Option<&ThinLens>) -> [Density; 2] {
        let direction = match lens {
            Some(lens) => Density::Finite(lens.focus_distance.powi(2) / (lens.area() * scale * cos.powi(3))),
            None => Density::Delta,
        };
        [Density::Finite(1.0 / (self.window.area() * scale)), direction]
    }

    fn is_parallel(&self) -> bool {
        true
    }
}
