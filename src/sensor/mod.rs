//! Cameras. One file per projection, one for the lens before it; [`Sensor`] holds what they share.

mod importance;
mod orthographic;
mod perspective;
mod radiancemeter;
mod thinlens;

pub use importance::{Importance, Line, SensorSample};
pub use orthographic::Orthographic;
pub use perspective::{Axis, Perspective};
pub use radiancemeter::Radiancemeter;
pub use thinlens::ThinLens;

use crate::math::{Ray, Vec2, Vec3, closed_enum};
use crate::sampling::Density;

closed_enum! {
    /// What every kind of camera can do, in camera space: it looks along +Z, +Y is up, +X is to the left of the picture
    /// (Mitsuba's frame). Neither call fails.
    pub trait Project {
        /// The ray of a sharp picture through film position `s` in [0, 1]² (x right, y down).
        fn ray(&self, s: Vec2) -> CameraRay;

        /// Half of the extent in y that the film shows at `distance` along the axis, in world units; `scale` is the
        /// length of the image of the camera's Y axis.
        fn half_height(&self, distance: f32, scale: f32) -> f32;

        /// What the film shows.
        fn window(&self) -> Window;

        /// The point of the window whose ray passes through `p`, which lies before the camera.
        fn window_point(&self, p: Vec3) -> Vec2;

        /// Where the ray of a point of the window crosses the plane z = 0.
        fn start(&self, on_window: Vec2) -> Vec2;

        /// The line through `p` that leaves the lens, whose focus lies at depth `focus`, at the place `lens` of it.
        fn through(&self, p: Vec3, lens: Vec2, focus: f32) -> Line;

        /// Densities of position and direction of a ray whose cosine to the axis is `cos`, for an even choice over
        /// the film and over the lens; `scale` is the area in the world of a unit of area in camera space.
        fn densities(&self, cos: f32, scale: f32, lens: Option<&ThinLens>) -> [Density; 2];

        /// Whether all rays of a sharp picture run along the axis.
        fn is_parallel(&self) -> bool;
    }

    /// How a film position becomes a ray in camera space.
    #[derive(Clone, Debug)]
    pub enum Projection {
        /// All rays pass one point.
        Perspective(Perspective),
        /// All rays are parallel.
        Orthographic(Orthographic),
        /// There is one ray.
        Radiancemeter(Radiancemeter),
    }
}

/// A camera-space ray: looks along +Z, +Y up, +X to the left of the picture (Mitsuba's frame).
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// On the plane z = 0.
    pub o: Vec3,
    /// Unit.
    pub d: Vec3,
}

/// A rectangle across the optical axis, at distance 1 of a pinhole: what the film shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Where the optical axis would be (0, 0).
    pub center: Vec2,
    /// Half of width and height.
    pub half: Vec2,
}

impl Window {
    /// From pbrt's [x0, x1, y0, y1], whose x grows to the right and whose y grows upwards.
    pub fn from_screen([x0, x1, y0, y1]: [f64; 4]) -> Self {
        let vec = |x: f64, y: f64| Vec2::new(x as f32, y as f32);
        Self { center: vec(-0.5 * (x0 + x1), 0.5 * (y0 + y1)), half: vec(0.5 * (x1 - x0), 0.5 * (y1 - y0)) }
    }

    /// Larger or smaller around the optical axis.
    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        Self { center: self.center * factor, half: self.half * factor }
    }

    /// The point of the window at film position `s` in [0, 1]².
    fn at(&self, s: Vec2) -> Vec2 {
        self.center + (Vec2::ONE - s * 2.0) * self.half
    }

    /// The film position of a point of the window.
    fn inverse(&self, p: Vec2) -> Vec2 {
        (Vec2::ONE - (p - self.center) / self.half) * 0.5
    }

    fn area(&self) -> f32 {
        (4.0 * self.half.x * self.half.y).abs()
    }
}

/// A camera in the world.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// From film positions to rays.
    pub projection: Projection,
    /// `None`: all is sharp.
    pub lens: Option<ThinLens>,
    /// Columns: images of the camera's X, Y and Z axes. Z has unit length; so have X and Y but for
    /// orthographic cameras.
    pub axes: [Vec3; 3],
    /// Of the pinhole, or of the middle of the lens or plane.
    pub position: Vec3,
    /// Nothing nearer or farther along the optical axis is seen.
    pub near: f32,
    /// See `near`.
    pub far: f32,
    /// Added to the film position, in fractions of the film.
    pub principal_point_offset: Vec2,
}

impl Sensor {
    /// Ray through film position `s` in [0,1]² (x right, y down, over the full film).
    #[inline]
    pub fn ray(&self, s: Vec2, aperture: Vec2) -> Ray {
        let s = s + self.principal_point_offset;
        let sharp = self.projection.ray(s);
        let local = self.lens.as_ref().map_or(sharp, |lens| lens.refract(sharp, aperture));
        let d = self.to_world(local.d);
        let per_z = 1.0 / local.d.z;
        let o = self.position + self.to_world(local.o);
        Ray { o: o + d * (self.near * per_z), d, tmax: (self.far - self.near) * per_z }
    }

    /// Whether rays depend on where they cross an aperture.
    pub fn has_aperture(&self) -> bool {
        self.lens.is_some()
    }

    /// Distance of a point along the optical axis, in scene units.
    pub fn depth(&self, p: Vec3) -> f32 {
        self.to_camera(p - self.position).z
    }

    /// Length on a surface facing the camera at `distance` that one pixel of a film `height` high covers.
    pub fn pixel_footprint(&self, height: u32, distance: f32) -> f32 {
        2.0 * self.projection.half_height(distance, self.axes[1].length()) / height as f32
    }
}
