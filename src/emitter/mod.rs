//! Emitters: direct sampling (for next event estimation) and photon emission. One file per model.

mod aim;
mod area;
mod collimated;
mod constant;
mod directional;
mod environment;
mod equal_area;
mod frustum;
mod goniometric;
mod picture;
mod point;
mod projection;
mod projector;
mod spot;
mod table;

pub use aim::{Aim, Arena, Arrow};
pub use area::{Area, MeshTriangle, Sides, Surface};
pub use collimated::Collimated;
pub use constant::Constant;
pub use directional::Directional;
pub use environment::{Environment, Mapping as EnvironmentMapping};
pub use frustum::Frustum;
pub use goniometric::Goniometric;
pub use picture::Picture;
pub use point::Point;
pub use projection::Projection;
pub use projector::Projector;
pub use spot::{Falloff, Spot};

use crate::math::{Color, Vec2, Vec3};
use crate::texture::Textures;

/// Light arriving at a point from one sampled direction, before visibility.
#[derive(Clone, Copy, Debug)]
pub struct DirectSample {
    /// Unit, towards the light.
    pub dir: Vec3,
    /// End of the shadow ray (already lifted off the lamp's surface); `None` is infinitely far.
    pub target: Option<Vec3>,
    /// Radiance divided by the density (for delta lights: the irradiance-like factor itself).
    pub value: Color,
    /// Density per solid angle; 0 for lights that a scattered ray cannot hit.
    pub pdf: f32,
}

/// Where a shadow ray towards a lamp without size ends, seen from the far end of `d`: a surface that the
/// lamp lies in would hide it, or not, by rounding.
fn just_before(lamp: Vec3, d: Vec3) -> Vec3 {
    lamp - d * 1e-5
}

/// The start of a light path.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    pub o: Vec3,
    /// Unit.
    pub d: Vec3,
    /// Power carried by the sample: its expectation is the emitter's power in W per channel.
    pub flux: Color,
}

/// The sphere around everything, which light from infinity has to cover.
#[derive(Clone, Copy, Debug)]
pub struct SceneSphere {
    pub center: Vec3,
    pub radius: f32,
}

impl SceneSphere {
    /// Area of the disk it shows to light from infinity.
    pub fn disk(&self) -> f32 {
        std::f32::consts::PI * self.radius * self.radius
    }
}

#[derive(Clone, Debug)]
pub enum Emitter {
    Area(Area),
    Point(Point),
    Spot(Spot),
    Directional(Directional),
    Constant(Constant),
    Environment(Box<Environment>),
    Projector(Projector),
    Projection(Box<Projection>),
    Goniometric(Box<Goniometric>),
    Collimated(Box<Collimated>),
}

impl Emitter {
    /// Light at `p`; `None` when nothing arrives from the sampled place.
    #[inline(always)]
    pub fn sample_direct(&self, textures: &Textures, p: Vec3, u: Vec2) -> Option<DirectSample> {
        match self {
            Self::Area(e) => e.sample_direct(textures, p, u),
            Self::Point(e) => e.sample_direct(p),
            Self::Spot(e) => e.sample_direct(textures, p),
            Self::Directional(e) => e.sample_direct(),
            Self::Constant(e) => e.sample_direct(u),
            Self::Environment(e) => e.sample_direct(u),
            Self::Projector(e) => e.sample_direct(textures, p),
            Self::Projection(e) => e.sample_direct(p),
            Self::Goniometric(e) => e.sample_direct(p),
            Self::Collimated(e) => e.sample_direct(textures, p, u),
        }
    }

    /// Start of a light path with density proportional to nothing in particular: the flux carries the
    /// weight. `None` where the sample carries no light.
    pub fn sample_emission(
        &self,
        textures: &Textures,
        arena: &Arena<'_>,
        place: Vec2,
        direction: Vec2,
    ) -> Option<Emission> {
        match self {
            Self::Area(e) => e.sample_emission(textures, place, direction),
            Self::Point(e) => e.sample_emission(direction),
            Self::Spot(e) => e.sample_emission(textures, direction),
            Self::Directional(e) => e.sample_emission(arena, place),
            Self::Constant(e) => e.sample_emission(arena, place, direction),
            Self::Environment(e) => e.sample_emission(arena, place, direction),
            Self::Projector(e) => e.sample_emission(textures, direction),
            Self::Projection(e) => e.sample_emission(direction),
            Self::Goniometric(e) => e.sample_emission(direction),
            Self::Collimated(e) => e.sample_emission(textures, place),
        }
    }

    /// Whether its light comes from infinity.
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Constant(_) | Self::Environment(_))
    }

    /// Power in W per channel; what light from infinity sends through the scene's sphere. Exact but
    /// for textures, whose mean is sampled.
    pub fn power(&self, textures: &Textures, scene: &SceneSphere) -> Color {
        match self {
            Self::Area(e) => e.power(),
            Self::Point(e) => e.power(),
            Self::Spot(e) => e.power(),
            Self::Directional(e) => e.power(scene),
            Self::Constant(e) => e.power(scene),
            Self::Environment(e) => e.power(scene),
            Self::Projector(e) => e.power(textures),
            Self::Projection(e) => e.power(),
            Self::Goniometric(e) => e.power(),
            Self::Collimated(e) => e.power(textures),
        }
    }
}

#[cfg(test)]
mod tests;
