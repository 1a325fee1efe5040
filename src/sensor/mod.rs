//! Cameras. One file per projection, one for the lens before it; [`Sensor`] holds what they share.

mod orthographic;
mod perspective;
mod thinlens;

pub use orthographic::Orthographic;
pub use perspective::{Axis, Perspective};
pub use thinlens::ThinLens;

use crate::math::{Ray, Vec2, Vec3, closed_enum};

closed_enum! {
    /// What every kind of camera can do, in camera space: it looks along +Z, +Y is up, +X is to the left of the picture
    /// (Mitsuba's frame). Neither call fails.
    pub trait Project {
        /// The ray of a sharp picture through film position `s` in [0, 1]² (x right, y down).
        fn ray(&self, s: Vec2) -> CameraRay;

        /// Half of the extent in y that the film shows at `distance` along the axis, in world units; `scale` is the
        /// length of the image of the camera's Y axis.
        fn half_height(&self, distance: f32, scale: f32) -> f32;
    }

    /// How a film position becomes a ray in camera space.
    #[derive(Clone, Debug)]
    pub enum Projection {
        Perspective(Perspective),
        Orthographic(Orthographic),
    }
}

/// A camera-space ray: looks along +Z, +Y up, +X to the left of the picture (Mitsuba's frame).
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    pub o: Vec3,
    /// Unit.
    pub d: Vec3,
}

/// A rectangle across the optical axis, at distance 1 of a pinhole: what the film shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    pub center: Vec2,
    pub half: Vec2,
}

impl Window {
    /// From pbrt's [x0, x1, y0, y1], whose x grows to the right and whose y grows upwards.
    pub fn from_screen([x0, x1, y0, y1]: [f64; 4]) -> Self {
        let vec = |x: f64, y: f64| Vec2::new(x as f32, y as f32);
        Self { center: vec(-0.5 * (x0 + x1), 0.5 * (y0 + y1)), half: vec(0.5 * (x1 - x0), 0.5 * (y1 - y0)) }
    }

    #[must_use]
    pub fn scaled(self, factor: f32) -> Self {
        Self { center: self.center * factor, half: self.half * factor }
    }

    /// The point of the window at film position `s` in [0, 1]².
    fn at(&self, s: Vec2) -> Vec2 {
        self.center + (Vec2::ONE - s * 2.0) * self.half
    }
}

/// A camera in the world.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub projection: Projection,
    /// `None`: all is sharp.
    pub lens: Option<ThinLens>,
    /// Columns: images of the camera's X, Y and Z axes. Z has unit length; so have X and Y but for
    /// orthographic cameras.
    pub axes: [Vec3; 3],
    pub position: Vec3,
    /// Nothing nearer or farther along the optical axis is seen.
    pub near: f32,
    pub far: f32,
    /// Added to the film position, in fractions of the film.
    pub principal_point_offset: Vec2,
}

impl Sensor {
    /// Ray through film position `s` in [0,1]² (x right, y down, over the full film).
    pub fn ray(&self, s: Vec2, aperture: Vec2) -> Ray {
        let s = s + self.principal_point_offset;
        let sharp = self.projection.ray(s);
        let local = self.lens.as_ref().map_or(sharp, |lens| lens.refract(sharp, aperture));
        let world = |v: Vec3| self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z;
        let d = world(local.d);
        let per_z = 1.0 / local.d.z;
        let o = self.position + world(local.o);
        Ray { o: o + d * (self.near * per_z), d, tmax: (self.far - self.near) * per_z }
    }

    /// Whether rays depend on where they cross an aperture.
    pub fn has_aperture(&self) -> bool {
        self.lens.is_some()
    }

    /// Length on a surface facing the camera at `distance` that one pixel of a film `height` high covers.
    pub fn pixel_footprint(&self, height: u32, distance: f32) -> f32 {
        2.0 * self.projection.half_height(distance, self.axes[1].length()) / height as f32
    }
}
