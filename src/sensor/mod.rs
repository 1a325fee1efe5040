//! Cameras. One file per lens model; [`Sensor`] holds what they share.

mod perspective;
mod thinlens;

pub use perspective::{Axis, Perspective};
pub use thinlens::ThinLens;

use crate::math::{Ray, Vec2, Vec3};

/// How a film position becomes a ray in camera space.
#[derive(Clone, Debug)]
pub enum Lens {
    Perspective(Perspective),
    ThinLens(ThinLens),
}

/// A camera-space ray: looks along +Z, +Y up, +X to the left of the picture (Mitsuba's frame).
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    pub o: Vec3,
    /// Unit.
    pub d: Vec3,
}

/// A camera in the world.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub lens: Lens,
    /// Columns: images of the camera's X, Y and Z axes.
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
        let local = match &self.lens {
            Lens::Perspective(l) => l.ray(s),
            Lens::ThinLens(l) => l.ray(s, aperture),
        };
        let world = |v: Vec3| self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z;
        let d = world(local.d);
        let per_z = 1.0 / local.d.z;
        let o = self.position + world(local.o);
        Ray { o: o + d * (self.near * per_z), d, tmax: (self.far - self.near) * per_z }
    }

    /// Whether rays depend on where they cross an aperture.
    pub fn has_aperture(&self) -> bool {
        matches!(self.lens, Lens::ThinLens(_))
    }

    /// Length on a surface facing the camera at distance 1 that one pixel of a film `height` high covers.
    pub fn pixel_footprint(&self, height: u32) -> f32 {
        let tan = match &self.lens {
            Lens::Perspective(l) | Lens::ThinLens(ThinLens { pinhole: l, .. }) => l.half_tangent.y,
        };
        2.0 * tan / height as f32
    }
}
