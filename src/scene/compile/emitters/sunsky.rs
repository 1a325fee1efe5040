//! Sun and sky.

use std::sync::Arc;

use caustica_formats::ir::{self, ColorSlot, SunPosition};
use caustica_formats::sky::{self, Daylight};

use super::super::Compiler;
use super::axes;
use crate::emitter::{Dome, Emitter, Environment, EnvironmentMapping, Picture, SunDisc, SunSky};
use crate::math::{Color, Vec3};
use crate::spectrum::{rgb, to_rgb};

/// Narrowest sun in degrees: single precision knows the radius of this one to 10⁻³. Its irradiance does not depend on
/// its size.
const NARROWEST: f64 = 0.012;

pub fn build(b: &mut Compiler<'_>, light: &ir::SunSky, at: ir::Origin) -> Option<Emitter> {
    let albedo = to_rgb(b.color(&light.albedo, ColorSlot::Reflectance, at)).map(f64::from);
    if matches!(light.sun, SunPosition::Days { .. }) {
        let axes = axes(b, &light.to_world.after(&sky::Picture::TO_LOCAL), "the sky", at)?;
        let mean = sky::picture(light, albedo)?;
        let texels = mean.rgb.iter().map(|c| c.map(|v| v as f32)).collect();
        let picture = Picture::new(mean.width, mean.height, texels);
        return Some(Emitter::Environment(Box::new(Environment::new(
            picture,
            EnvironmentMapping::LatLong,
            axes,
        ))));
    }
    let axes = axes(b, &light.to_world, "the sky", at)?;
    let light = ir::SunSky { sun_aperture: light.sun_aperture.max(NARROWEST), ..light.clone() };
    let Some(toward) = sky::sun_direction(&light) else {
        b.error("the direction of the sun must not be zero", at);
        return None;
    };
    let daylight = Daylight::new(&light, toward, albedo);
    let disc = daylight.sun().map(|sun| SunDisc {
        direction: single(sun.direction),
        half_angle: sun.half_angle as f32,
        irradiance: color(sun.irradiance()),
    });
    let below = daylight.shines_below();
    Some(Emitter::SunSky(Box::new(SunSky::new(Arc::new(Formula(daylight)), axes, disc, below))))
}

/// The light of one moment.
#[derive(Debug)]
struct Formula(Daylight);

impl Dome for Formula {
    fn sky(&self, d: Vec3) -> Color {
        color(self.0.sky(double(d)))
    }

    fn sun(&self, d: Vec3) -> Color {
        self.0.sun().map_or(Color::ZERO, |sun| color(sun.radiance(double(d))))
    }
}

fn color(c: [f64; 3]) -> Color {
    rgb(c.map(|v| v as f32))
}

fn single(v: [f64; 3]) -> Vec3 {
    Vec3::from(v.map(|x| x as f32))
}

fn double(v: Vec3) -> [f64; 3] {
    v.to_array().map(f64::from)
}
