//! Emitters: direct sampling (for next event estimation) and photon emission. One file per model; [`Light`] is
//! the contract, [`Emitter`] the table.

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
pub use spot::{Falloff, Spot, Stretched};

use crate::math::{Color, Vec2, Vec3, closed_enum};
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

closed_enum! {
    /// What every emitter can do. Lengths and areas are in world units, radiometric quantities per colour lane;
    /// directions are of unit length and in world space.
    ///
    /// An emitter that cannot be met by a ray (a point, a single direction) answers with `pdf` 0, and its `value`
    /// holds the whole of its delta.
    pub trait Light {
        /// Light at `p` from one place of the emitter, chosen by `u`: of density `pdf` per solid angle at `p`. The
        /// mean of `value` over `u`, times f and the cosine at `p`, is the light reflected; visibility is left to the
        /// caller. `None` when nothing arrives from the chosen place: its back side, or beyond the cone of a spot.
        #[inline(always)]
        fn sample_direct(&self, textures: &Textures, p: Vec3, u: Vec2) -> Option<DirectSample>;

        /// Start of a light path: `place` chooses where, `direction` whither. The flux is the power per unit of
        /// `place` and `direction` (its mean over both is [`Emitter::power`]), the cosine at the lamp included, and
        /// light from infinity starts outside of the sphere of `arena`. `None` where the sample carries no light.
        fn sample_emission(
            &self,
            textures: &Textures,
            arena: &Arena<'_>,
            place: Vec2,
            direction: Vec2,
        ) -> Option<Emission>;

        /// Power in W per lane; of light from infinity, what passes through the sphere `scene`. Exact but for
        /// textures, whose mean is sampled. Decides how often the emitter is chosen, and is never 0 for one that
        /// shines.
        fn power(&self, textures: &Textures, scene: &SceneSphere) -> Color;

        /// Whether its light comes from infinity: such an emitter covers the whole scene's sphere.
        fn is_infinite(&self) -> bool {
            false
        }
    }

    /// Every kind of emitter.
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
}

#[cfg(test)]
mod tests;
