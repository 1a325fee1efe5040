use super::{CameraRay, Line, Project, ThinLens, Window};
use crate::math::{Vec2, Vec3};
use crate::sampling::Density;

/// Pinhole camera.
#[derive(Clone, Debug)]
pub struct Perspective {
    /// At distance 1: half its size is the tangent of half the field of view.
    pub window: Window,
}

/// Which extent a field-of-view angle spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Its width.
    X,
    /// Its height.
    Y,
    /// From corner to corner.
    Diagonal,
    /// The smaller of width and height.
    Smaller,
    /// The larger of width and height.
    Larger,
}

impl Perspective {
    /// `fov` is the full angle in degrees along `axis`; `aspect` = width / height.
    pub fn new(fov: f64, axis: Axis, aspect: f64) -> Self {
        let t = (fov.to_radians() * 0.5).tan();
        let x = match axis {
            Axis::X => t,
            Axis::Y => t * aspect,
            Axis::Diagonal => t * aspect / (1.0 + aspect * aspect).sqrt(),
            Axis::Smaller => t * aspect.max(1.0),
            Axis::Larger => t * aspect.min(1.0),
        };
        let half = Vec2::new(x as f32, (x / aspect) as f32);
        Self { window: Window { center: Vec2::ZERO, half } }
    }
}

impl Project for Perspective {
    fn ray(&self, s: Vec2) -> CameraRay {
        let p = self.window.at(s);
        CameraRay { o: Vec3::ZERO, d: Vec3::new(p.x, p.y, 1.0).normalize() }
    }

    fn half_height(&self, distance: f32, _scale: f32) -> f32 {
        self.window.half.y * distance
    }

    fn window(&self) -> Window {
        self.window
    }

    fn window_point(&self, p: Vec3) -> Vec2 {
        Vec2::new(p.x, p.y) / p.z
    }

    fn start(&self, _on_window: Vec2) -> Vec2 {
        Vec2::ZERO
    }

    fn through(&self, p: Vec3, lens: Vec2, _focus: f32) -> Line {
        Line { at: lens, slope: (Vec2::new(p.x, p.y) - lens) / p.z }
    }

    /// Even over the window, which at distance 1 covers a solid angle of cos³ times its area.
    fn densities(&self, cos: f32, scale: f32, lens: Option<&ThinLens>) -> [Density; 2] {
        let position = match lens {
            Some(lens) => Density::Finite(1.0 / (lens.area() * scale)),
            None => Density::Delta,
        };
        [position, Density::Finite(1.0 / (self.window.area() * cos.powi(3)))]
    }

    fn is_parallel(&self) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Horizontal angles printed by Mitsuba 3.9.1 for fov = 40 on 400×200 and 200×400.
    #[test]
    fn fov_axes_match_mitsuba() {
        let rows = [
            (Axis::X, 40.0, 40.0),
            (Axis::Y, 72.10477, 20.62821),
            (Axis::Diagonal, 36.06479, 18.49019),
            (Axis::Smaller, 72.10477, 40.0),
            (Axis::Larger, 40.0, 20.62821),
        ];
        for (axis, wide, tall) in rows {
            for (aspect, expected) in [(2.0, wide), (0.5, tall)] {
                let got = 2.0 * Perspective::new(40.0, axis, aspect).window.half.x.atan().to_degrees();
                assert!((got - expected).abs() < 1e-4, "{axis:?} {aspect}: {got}");
            }
        }
    }

    /// Mitsuba 3.9.1: fov 90 on a 4×2 film, film (0,0) and (1,1).
    #[test]
    fn film_corners_match_mitsuba() {
        let p = Perspective::new(90.0, Axis::X, 2.0);
        let a = p.ray(Vec2::ZERO).d;
        let b = p.ray(Vec2::ONE).d;
        assert!((a - Vec3::new(2.0, 1.0, 2.0) / 3.0).length() < 1e-6);
        assert!((b - Vec3::new(-2.0, -1.0, 2.0) / 3.0).length() < 1e-6);
    }

    /// pbrt's window for a film of 2:1 is [-2, 2, -1, 1], the shorter side spanning the angle; half of it
    /// shows the left half of the picture.
    #[test]
    fn a_screen_window_cuts_the_picture_out() {
        let whole = Perspective::new(60.0, Axis::Smaller, 2.0);
        let tan = 30f32.to_radians().tan();
        let same = Window::from_screen([-2.0, 2.0, -1.0, 1.0]).scaled(tan);
        assert!((same.half - whole.window.half).length() < 1e-6 && same.center == Vec2::ZERO);
        let left = Perspective { window: Window::from_screen([-2.0, 0.0, -1.0, 1.0]).scaled(tan) };
        for s in [Vec2::ZERO, Vec2::ONE, Vec2::new(0.3, 0.8)] {
            let there = whole.ray(Vec2::new(0.5 * s.x, s.y)).d;
            assert!((left.ray(s).d - there).length() < 1e-6);
        }
    }
}
