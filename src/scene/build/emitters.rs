//! Emitters that are not shapes.

use caustica_formats::ir::{self, ColorSlot, EmitterKind};

use super::{Builder, analytic};
use crate::emitter::{Constant, Directional, Emitter, Environment, EnvironmentMapping, Point, Spot};
use crate::math::{Frame, Vec3};

fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

fn unit(v: [f64; 3]) -> Option<Vec3> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length.is_normal()).then(|| vec3(v.map(|x| x / length)))
}

/// Appends the scene's point-like and infinite lights; returns the environment's index.
pub fn build(b: &mut Builder<'_>, origin: [f64; 3], emitters: &mut Vec<Emitter>) -> Option<u32> {
    let relative = |p: [f64; 3]| vec3([p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]);
    let mut environment = None;
    for e in &b.ir.emitters {
        let at = e.origin;
        let emitter = match &e.kind {
            EmitterKind::Point { position, intensity } => Emitter::Point(Point {
                position: relative(*position),
                intensity: b.color(intensity, ColorSlot::Emission, at),
            }),
            EmitterKind::Spot { to_world, intensity, cutoff_angle, beam_width, texture, .. } => {
                let axes =
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|a| unit(to_world.vector(a)));
                let [Some(s), Some(t), Some(n)] = axes else {
                    b.error("the spot's to_world is singular", at);
                    continue;
                };
                if !(*cutoff_angle > 0.0 && *cutoff_angle < 90.0 && *beam_width >= 0.0) {
                    b.error("a spot's cutoff angle must lie between 0 and 90 degrees", at);
                    continue;
                }
                let texture = texture.map(|t| b.param(&ir::ColorInput::Texture(t), ColorSlot::Emission, at));
                Emitter::Spot(Spot {
                    position: relative(to_world.point([0.0; 3])),
                    frame: Frame { s, t, n },
                    intensity: b.color(intensity, ColorSlot::Emission, at),
                    cutoff: cutoff_angle.to_radians() as f32,
                    beam: beam_width.min(*cutoff_angle).to_radians() as f32,
                    texture,
                })
            }
            EmitterKind::Directional { direction, irradiance } => {
                let Some(direction) = unit(*direction) else {
                    b.error("a directional light needs a direction that is not zero", at);
                    continue;
                };
                Emitter::Directional(Directional {
                    direction,
                    irradiance: b.color(irradiance, ColorSlot::Emission, at),
                })
            }
            EmitterKind::Constant { radiance } => {
                if environment.is_some() {
                    b.error("a scene may have one environment light only", at);
                }
                environment = Some(emitters.len() as u32);
                Emitter::Constant(Constant { radiance: b.color(radiance, ColorSlot::Emission, at) })
            }
            EmitterKind::Environment { to_world, image, mapping } => {
                if environment.is_some() {
                    b.error("a scene may have one environment light only", at);
                }
                let Some(light) = picture_environment(b, to_world, image, *mapping, at) else { continue };
                environment = Some(emitters.len() as u32);
                Emitter::Environment(Box::new(light))
            }
            _ => {
                b.unsupported("this emitter", "nothing", at);
                continue;
            }
        };
        emitters.push(emitter);
    }
    environment
}

fn picture_environment(
    b: &mut Builder<'_>,
    to_world: &ir::Transform,
    image: &ir::LightImage,
    mapping: ir::EnvironmentMapping,
    at: ir::Origin,
) -> Option<Environment> {
    if !analytic::is_similarity(to_world) {
        b.error("the to_world of an environment may turn and mirror it, but not stretch it", at);
        return None;
    }
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|a| unit(to_world.vector(a)));
    let [Some(s), Some(t), Some(n)] = axes else {
        b.error("the environment's to_world is singular", at);
        return None;
    };
    let picture = b.light_image(image, at)?;
    let mapping = match mapping {
        ir::EnvironmentMapping::LatLong => EnvironmentMapping::LatLong,
        ir::EnvironmentMapping::EqualArea => EnvironmentMapping::EqualArea,
    };
    if mapping == EnvironmentMapping::EqualArea && picture.width != picture.height {
        let size = format!("{}×{}", picture.width, picture.height);
        b.error(
            format!("an equal-area environment must be square, but `{}` is {size}", image.path.display()),
            at,
        );
        return None;
    }
    let mut light = Environment::new(picture, mapping, Frame { s, t, n });
    if let Some(wanted) = image.illuminance {
        light.set_illuminance(wanted as f32);
    }
    Some(light)
}
