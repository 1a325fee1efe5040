//! Radiance of one moment.

use std::f64::consts::{FRAC_PI_2, PI};

use super::days::Days;
use super::{data, place, preetham};
use crate::ir::{SunModel, SunPosition, SunSky};
use crate::spectrum::wavelength_rgb;

/// From mean values at eleven wavelengths to linear Rec. 709: Mitsuba's factor for the sun over its integral of ȳ.
const SUN_TO_RGB: f64 = 467.069_280_386 / 106.750_259_399_414_06;

/// The integral of ȳ that Mitsuba divides the sky's RGB by.
const SKY_TO_RGB: f64 = 1.0 / 106.750_259_399_414_06;

/// Radiance by direction. Directions are of unit length and local: +Z is up.
#[derive(Clone, Debug)]
pub struct Daylight {
    /// Black where the sun stands below the horizon.
    sky: Option<[Channel; 3]>,
    /// Angles of the sky.
    stretch: f64,
    extend: bool,
    /// Towards the sun, as far from the zenith as it stands in the sky without `stretch`.
    toward_sun: [f64; 3],
    sun: Option<Sun>,
}

/// One channel of the sky.
#[derive(Clone, Copy, Debug)]
struct Channel {
    parameters: [f64; data::PARAMETERS],
    factor: f64,
}

/// The disc of the sun.
#[derive(Clone, Debug)]
pub struct Sun {
    /// Of its middle.
    pub direction: [f64; 3],
    /// Half of its full angle, in radians.
    pub half_angle: f64,
    light: Disc,
    factor: f64,
}

#[derive(Clone, Copy, Debug)]
enum Disc {
    /// Down to the horizon.
    Even([f64; 3]),
    LimbDarkened {
        turbidity: f64,
    },
    /// Also below the horizon.
    Everywhere([f64; 3]),
}

/// The direction to the sun in the local space of the light; of days, at the middle of the time that the shutter is
/// open. `None` for a direction or a `to_world` without length.
pub fn sun_direction(light: &SunSky) -> Option<[f64; 3]> {
    match light.sun {
        SunPosition::Direction(world) => unit(light.to_world.inverse()?.vector(world)),
        SunPosition::Moment { place, day, hour } => Some(place::sun(place, day, hour).direction()),
        SunPosition::Days { .. } => Some(Days::of(&light.sun)?.at(0.5)),
    }
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    length.is_normal().then(|| v.map(|x| x / length))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Solid angle of a cone.
fn cone(half_angle: f64) -> f64 {
    4.0 * PI * (0.5 * half_angle).sin().powi(2)
}

impl Daylight {
    /// The light with the sun at the unit vector `toward_sun` (see [`sun_direction`]) over a ground of linear colour
    /// `albedo`.
    pub fn new(light: &SunSky, toward_sun: [f64; 3], albedo: [f64; 3]) -> Self {
        let height = height(toward_sun);
        let turbidity = light.turbidity.clamp(1.0, 10.0);
        let channel = |c: usize| {
            let (parameters, factor) = data::sky(c, turbidity, albedo[c].clamp(0.0, 1.0), height);
            Channel { parameters, factor: factor * SKY_TO_RGB * light.sky_scale }
        };
        let sky = (height >= 0.0 && light.sky_scale > 0.0).then(|| [0, 1, 2].map(channel));
        let sun = (light.sun_scale > 0.0).then(|| Sun::new(light, toward_sun, turbidity)).flatten();
        Self { sky, stretch: light.stretch, extend: light.extend, toward_sun, sun }
    }

    /// Radiance of the sky towards `d`, never negative.
    pub fn sky(&self, d: [f64; 3]) -> [f64; 3] {
        let Some(channels) = &self.sky else { return [0.0; 3] };
        let plain = self.stretch == 1.0 && !self.extend;
        if plain && d[2] < 0.0 {
            return [0.0; 3];
        }
        let (d, fade) = if plain { (d, 1.0) } else { self.below(d) };
        if fade == 0.0 {
            return [0.0; 3];
        }
        let cos_gamma = dot(d, self.toward_sun).clamp(-1.0, 1.0);
        let (cosine, gamma) = (d[2].max(0.0), cos_gamma.acos());
        std::array::from_fn(|c| {
            let Channel { parameters: p, factor } = &channels[c];
            let round = 1.0 + p[8] * p[8] - 2.0 * p[8] * cos_gamma;
            let glow = (1.0 + cos_gamma * cos_gamma) / (round * round.sqrt());
            let horizon = 1.0 + p[0] * (p[1] / (cosine + 0.01)).exp();
            let rest = p[2]
                + p[3] * (p[4] * gamma).exp()
                + p[5] * cos_gamma * cos_gamma
                + p[6] * glow
                + p[7] * cosine.sqrt();
            (horizon * rest * factor * fade).max(0.0)
        })
    }

    /// The direction whose colour Mitsuba 0.6 shows at `d` of a stretched or extended sky, and the factor on it.
    fn below(&self, d: [f64; 3]) -> ([f64; 3], f64) {
        let sine = d[0].hypot(d[1]);
        let zenith = sine.atan2(d[2]);
        let fade = if self.extend {
            let t = (2.0 - zenith / FRAC_PI_2).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        } else {
            1.0
        };
        let mut angle = zenith / self.stretch;
        if angle >= FRAC_PI_2 {
            if !self.extend {
                return (d, 0.0);
            }
            angle = FRAC_PI_2 - 1e-4;
        }
        let (sin, cos) = angle.sin_cos();
        let flat = if sine > 0.0 { [d[0] / sine, d[1] / sine] } else { [1.0, 0.0] };
        ([flat[0] * sin, flat[1] * sin, cos], fade)
    }

    /// The sun, if it shines.
    pub fn sun(&self) -> Option<&Sun> {
        self.sun.as_ref()
    }

    /// Whether the sky shines below the horizon.
    pub fn shines_below(&self) -> bool {
        self.stretch > 1.0 || self.extend
    }
}

/// Of a unit vector above the horizon, in radians.
fn height(d: [f64; 3]) -> f64 {
    d[2].atan2(d[0].hypot(d[1]))
}

impl Sun {
    fn new(light: &SunSky, toward_sun: [f64; 3], turbidity: f64) -> Option<Self> {
        let height = height(toward_sun);
        let half_angle = (0.5 * light.sun_aperture).to_radians();
        let real = cone((0.5 * SunSky::APERTURE).to_radians());
        let light_of = match light.sun_model {
            SunModel::Even | SunModel::LimbDarkened if height < 0.0 => return None,
            SunModel::Even => {
                let rgb = to_rgb(data::irradiance(turbidity, height));
                Disc::Even(rgb.map(|v| v.max(0.0) / real))
            }
            SunModel::LimbDarkened => Disc::LimbDarkened { turbidity },
            SunModel::Preetham => Disc::Everywhere(preetham::radiance(FRAC_PI_2 - height, turbidity)),
        };
        let zenith = (FRAC_PI_2 - height) * light.stretch;
        let flat = toward_sun[0].hypot(toward_sun[1]);
        let direction = if light.stretch == 1.0 || flat == 0.0 {
            toward_sun
        } else {
            let (sin, cos) = zenith.sin_cos();
            [toward_sun[0] / flat * sin, toward_sun[1] / flat * sin, cos]
        };
        // A larger disc is dimmer: the irradiance stays.
        let factor = light.sun_scale * real / cone(half_angle);
        Some(Self { direction, half_angle, light: light_of, factor })
    }

    /// Radiance towards `d`, which lies on the disc; never negative.
    pub fn radiance(&self, d: [f64; 3]) -> [f64; 3] {
        let rgb = match self.light {
            Disc::Everywhere(rgb) => rgb,
            _ if d[2] < 0.0 => [0.0; 3],
            Disc::Even(rgb) => rgb,
            Disc::LimbDarkened { turbidity } => {
                let sine = chord(d, self.direction).min(1.0) / self.half_angle.sin();
                let middle = data::radiance(turbidity, height(d));
                let left = data::darkening((1.0 - sine * sine).max(0.0).sqrt());
                to_rgb(std::array::from_fn(|l| middle[l] * left[l])).map(|v| v.max(0.0))
            }
        };
        rgb.map(|v| v * self.factor)
    }

    /// Irradiance on a plane that faces it; exact for an even disc above the horizon, otherwise to 10⁻³.
    pub fn irradiance(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (_, light) in self.places(64) {
            (0..3).for_each(|c| sum[c] += light[c]);
        }
        sum
    }

    /// `side`² places of the disc, of equal solid angles, each with its share of the irradiance.
    pub(super) fn places(&self, side: usize) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        let part = cone(self.half_angle) / (side * side) as f64;
        let at = move |k: usize| (k as f64 + 0.5) / side as f64;
        (0..side * side).map(move |i| {
            let d = self.place([at(i % side), at(i / side)]);
            (d, self.radiance(d).map(|v| v * part))
        })
    }

    /// Of the unit square, a direction on the disc; equal areas stay equal.
    fn place(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        // 1 − cos without cancellation.
        let below = 2.0 * (0.5 * self.half_angle).sin().powi(2) * u;
        let (cos, sin) = (1.0 - below, (below * (2.0 - below)).sqrt());
        let (y, x) = (2.0 * PI * v).sin_cos();
        let n = self.direction;
        let helper = if n[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
        let s = unit(cross(helper, n)).unwrap_or(helper);
        let t = cross(n, s);
        std::array::from_fn(|i| n[i] * cos + (s[i] * x + t[i] * y) * sin)
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Sine of the angle between unit vectors, also of a tiny one.
fn chord(a: [f64; 3], b: [f64; 3]) -> f64 {
    let c = cross(a, b);
    dot(c, c).sqrt()
}

fn to_rgb(spectrum: [f64; data::WAVELENGTHS]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (value, l) in spectrum.into_iter().zip(0..) {
        let rgb = wavelength_rgb(360.0 + 40.0 * f64::from(l));
        (0..3).for_each(|c| sum[c] += rgb[c] * value);
    }
    // The mean of eleven wavelengths: of 320 nm nothing is seen.
    sum.map(|v| v / 11.0 * SUN_TO_RGB)
}
