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
mod sunsky;
mod table;

pub use aim::{Aim, Aimed, EmissionBounds, Entry, EntrySegment, PathFound, Start, Starts, Targets};
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
pub use sunsky::{Dome, SunDisc, SunSky};

use crate::math::{Color, Ray, Vec2, Vec3, closed_enum};
use crate::sampling::Density;
use crate::texture::{Site, Textures};

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

impl DirectSample {
    /// The shadow ray from a point that has left its surface.
    #[inline(always)]
    pub fn ray_from(&self, o: Vec3) -> Ray {
        match self.target {
            Some(target) => Ray { o, d: target - o, tmax: 1.0 },
            None => Ray::new(o, self.dir),
        }
    }

    /// Light from infinity: a direction, the radiance over its density, and the density.
    fn of_background((dir, value, pdf): (Vec3, Color, f32)) -> Self {
        Self { dir, target: None, value, pdf }
    }
}

/// Where a shadow ray towards a lamp without size ends, seen from the far end of `d`: a surface that the
/// lamp lies in would hide it, or not, by rounding.
fn just_before(lamp: Vec3, d: Vec3) -> Vec3 {
    lamp - d * 1e-5
}

/// The start of a light path, with the densities of its place and of its direction there.
///
/// For every kind, `flux` is the light that leaves `o` along `d`, times `cos`, over both densities:
///
/// | kind | light | `position` | `direction` |
/// |---|---|---|---|
/// | area | radiance | per area of the lamp | per solid angle |
/// | point, spot, projector, projection, goniometric | intensity | delta | per solid angle |
/// | collimated | exitance (W/m²) | per area of the lamp | delta |
/// | constant, environment, sun and sky | radiance | per area of the disk across `d` | per solid angle |
/// | directional | irradiance (W/m²) | per area of the disk across `d` | delta |
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Where the path starts, lifted off the surface of a lamp that has one.
    pub o: Vec3,
    /// Unit.
    pub d: Vec3,
    /// Cosine between `d` and the normal of the area that `position` is a density of; 1 where that area lies
    /// across `d`, and for lamps at a point.
    pub cos: f32,
    /// Power carried by the sample: its expectation is the emitter's power in W per channel.
    pub flux: Color,
    /// Of `o`. The lift of `o` off the lamp's surface does not count.
    pub position: Density,
    /// Of `d`, given `o`.
    pub direction: Density,
    /// Density with which the lamp chooses by itself over that of a choice made by [`EmissionBounds`].
    pub weight: f32,
}

impl Emission {
    /// From a lamp at a point.
    fn from_point(o: Vec3, d: Vec3, flux: Color, direction: f32) -> Self {
        let direction = Density::Finite(direction);
        Self { o, d, cos: 1.0, flux, position: Density::Delta, direction, weight: 1.0 }
    }

    /// The same for a lamp whose own density of `d` is `weight` times that of the choice made.
    fn headed((d, weight): (Vec3, f32), o: Vec3, flux: Color, own: f32) -> Option<Self> {
        let flux = flux * weight;
        (flux.max_element() > 0.0).then(|| Self { weight, ..Self::from_point(o, d, flux, own / weight) })
    }

    /// From all around, for a direction to look along with the radiance over its density, and the density: at a place
    /// on the disk that the scene's sphere shows to it.
    fn of_background(
        (dir, value, pdf): (Vec3, Color, f32),
        bounds: &EmissionBounds<'_>,
        place: Vec2,
    ) -> Self {
        let entry = bounds.enter(-dir, place);
        let flux = value * (bounds.sphere.disk() * entry.weight);
        Self::from_infinity(entry, -dir, flux, Density::Finite(pdf))
    }

    /// From infinity.
    fn from_infinity(entry: Entry, d: Vec3, flux: Color, direction: Density) -> Self {
        Self { o: entry.o, d, cos: 1.0, flux, position: entry.density, direction, weight: entry.weight }
    }
}

/// The sphere around everything, which light from infinity has to cover.
#[derive(Clone, Copy, Debug)]
pub struct SceneSphere {
    /// In the coordinates of the scene.
    pub center: Vec3,
    /// In scene units.
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
        /// light from infinity starts outside of the sphere of `bounds`. `None` where the sample carries no light.
        fn sample_emission(
            &self,
            textures: &Textures,
            bounds: &EmissionBounds<'_>,
            place: Vec2,
            direction: Vec2,
        ) -> Option<Emission>;

        /// Power in W per lane; of light from infinity, what passes through the sphere `scene`. Exact but for
        /// textures, whose mean is sampled. Decides how often the emitter is chosen, and is never 0 for one that
        /// shines.
        fn power(&self, textures: &Textures, scene: &SceneSphere) -> Color;

        /// Radiance that a surface of the emitter sends from `site` along a direction on the side of its shading
        /// normal (`front`) or on the other one. Black for emitters without a surface.
        #[inline(always)]
        fn emitted(&self, _textures: &Textures, _site: &Site, _front: bool) -> Color {
            Color::ZERO
        }

        /// Density per solid angle at `p` with which [`Emitter::sample_direct`] chooses the point `q` of the
        /// emitter's surface, of geometric normal `n`, that a ray from `p` along `d` meets. 0 for emitters without
        /// a surface.
        #[inline(always)]
        fn pdf_direct_surface(&self, _p: Vec3, _d: Vec3, _q: Vec3, _n: Vec3) -> f32 {
            0.0
        }

        /// Radiance arriving from infinity, seen along `d`, and the density per solid angle with which
        /// [`Emitter::sample_direct`] chooses that direction. Black and 0 for emitters that do not fill the sky.
        #[inline(always)]
        fn background(&self, _d: Vec3) -> (Color, f32) {
            (Color::ZERO, 0.0)
        }

        /// A place of the emitter, chosen by `u` about as [`Emitter::sample_direct`] does; `None` where it is
        /// infinitely far.
        fn place(&self, _u: Vec2) -> Option<Vec3> {
            None
        }

        /// Area of the emitter's surface that scattered rays can find shining; 0 for emitters without one.
        fn visible_area(&self) -> f32 {
            0.0
        }

        /// Whether its light comes from infinity: such an emitter covers the whole scene's sphere.
        fn is_infinite(&self) -> bool {
            false
        }
    }

    /// Every kind of emitter.
    #[derive(Clone, Debug)]
    pub enum Emitter {
        /// A shape that shines alike in all directions.
        Area(Area),
        /// A point that shines alike in all directions.
        Point(Point),
        /// A point that shines into a cone.
        Spot(Spot),
        /// Parallel light from infinity.
        Directional(Directional),
        /// The same radiance from all of the sky.
        Constant(Constant),
        /// A picture of the sky.
        Environment(Box<Environment>),
        /// Sun and sky by a formula.
        SunSky(Box<SunSky>),
        /// Mitsuba's projector.
        Projector(Projector),
        /// pbrt's projection light.
        Projection(Box<Projection>),
        /// A point with a measured or painted distribution.
        Goniometric(Box<Goniometric>),
        /// A shape that shines along its normals only.
        Collimated(Box<Collimated>),
    }
}

#[cfg(test)]
mod tests;
