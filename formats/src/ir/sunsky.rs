//! The light of the sun and the sky.

use serde::{Deserialize, Serialize};

use super::color::Color;
use super::table::{plain, record};
use super::transform::Transform;

record! {
    /// Sun and sky of a clear day, by the model of Hošek and Wilkie. Radiance is in W·m⁻²·sr⁻¹·nm⁻¹, as in Mitsuba.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct SunSky {
        /// Local → world, local +Z is up; only its rotation counts.
        pub to_world: Transform,
        /// Where the sun stands.
        pub sun: SunPosition,
        /// Haze: 1 (none) to 10.
        pub turbidity: f64,
        /// Reflectance of the ground, which lights the sky.
        pub albedo: Color,
        /// Factor on the light of the sky.
        pub sky_scale: f64,
        /// Factor on the light of the sun.
        pub sun_scale: f64,
        /// Full angle of the sun's disc in degrees; it does not change the irradiance.
        pub sun_aperture: f64,
        /// How bright the sun is.
        pub sun_model: SunModel,
        /// Factor on the angles from the zenith, from 1 to 2: the sky ends that much lower (Mitsuba 0.6).
        pub stretch: f64,
        /// Whether the colours of the horizon go on below it, growing dark towards the nadir (Mitsuba 0.6).
        pub extend: bool,
    }
}

/// Where the sun stands.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SunPosition {
    /// In this direction of the world.
    Direction([f64; 3]),
    /// Where it stands at a time and a place, in the local space of the light (−X is north, −Y east).
    Moment {
        /// On Earth.
        place: Place,
        /// The day.
        day: Day,
        /// Local time since midnight.
        hour: f64,
    },
    /// The mean over hours of several days.
    Days {
        /// On Earth.
        place: Place,
        /// The first day.
        start: Day,
        /// The day after the last.
        end: Day,
        /// The first and the last hour of each day.
        hours: [f64; 2],
        /// Which part of the days the shutter is open: 0 is the first hour of the first day, 1 the last hour of
        /// the last one.
        shutter: [f64; 2],
    },
}

/// A place on Earth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    /// Degrees north of the equator.
    pub latitude: f64,
    /// Degrees east of Greenwich.
    pub longitude: f64,
    /// Local time minus universal time, in hours.
    pub timezone: f64,
}

/// A day of the Gregorian calendar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Day {
    /// Anno Domini.
    pub year: u32,
    /// From 1.
    pub month: u32,
    /// From 1; what is beyond the month's end is in the next one.
    pub day: u32,
}

/// How bright the sun is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SunModel {
    /// Hošek and Wilkie's irradiance, the same radiance all over the disc.
    Even,
    /// Hošek and Wilkie's radiance, darker towards the limb.
    LimbDarkened,
    /// Preetham, Shirley and Smits (Mitsuba 0.6).
    Preetham,
}

plain! { SunPosition, SunModel }

impl SunSky {
    /// The light with Mitsuba 3's defaults.
    pub fn new(sun: SunPosition) -> Self {
        Self {
            to_world: Transform::IDENTITY,
            sun,
            turbidity: 3.0,
            albedo: Color::Gray(0.3),
            sky_scale: 1.0,
            sun_scale: 1.0,
            sun_aperture: Self::APERTURE,
            sun_model: SunModel::Even,
            stretch: 1.0,
            extend: false,
        }
    }

    /// Full angle of the real sun in degrees, as both models of it take it.
    pub const APERTURE: f64 = 0.5358;
}
