//! Emitters that are not shapes.

mod pictured;
mod sunsky;

use caustica_formats::ir::{self, ColorSlot, EmitterKind};

use super::Compiler;
use crate::emitter::{
    Constant, Directional, Emitter, Environment, EnvironmentMapping, Falloff, Point, Spot, Stretched,
};
use crate::math::{Frame, Vec3};
use crate::scene::LampMedium;

fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

fn unit(v: [f64; 3]) -> Option<Vec3> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length.is_normal()).then(|| vec3(v.map(|x| x / length)))
}

/// Appends the scene's point-like and infinite lights, and what they stand in; returns the indices of the environments.
pub fn build(
    b: &mut Compiler<'_>,
    origin: [f64; 3],
    emitters: &mut Vec<Emitter>,
    media: &mut Vec<LampMedium>,
) -> Vec<u32> {
    let relative = |p: [f64; 3]| vec3([p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]);
    let mut environments = Vec::new();
    for e in &b.ir.emitters {
        let at = e.origin;
        let medium = b.medium(e.medium);
        let emitter = match &e.kind {
            EmitterKind::Point { position, intensity } => Emitter::Point(Point {
                position: relative(*position),
                intensity: b.color(intensity, ColorSlot::Emission, at),
            }),
            EmitterKind::Spot { to_world, intensity, cutoff_angle, beam_width, texture, falloff } => {
                let Some((frame, stretched)) = spot_axes(b, to_world, at) else { continue };
                // A texture is thrown onto a plane.
                let widest = if texture.is_some() { 90.0 } else { 180.0 };
                if !(*cutoff_angle > 0.0 && *cutoff_angle < widest && *beam_width >= 0.0) {
                    let text = format!("this spot's cutoff angle must lie between 0 and {widest} degrees");
                    b.error(text, at);
                    continue;
                }
                let texture = texture.map(|t| b.param(&ir::ColorInput::Texture(t), ColorSlot::Emission, at));
                Emitter::Spot(Spot {
                    position: relative(to_world.point([0.0; 3])),
                    frame,
                    stretched,
                    intensity: b.color(intensity, ColorSlot::Emission, at),
                    cutoff: cutoff_angle.to_radians() as f32,
                    beam: beam_width.min(*cutoff_angle).to_radians() as f32,
                    falloff: match falloff {
                        ir::SpotFalloff::Linear => Falloff::Linear,
                        ir::SpotFalloff::Smoothstep => Falloff::Smoothstep,
                        ir::SpotFalloff::Quartic => Falloff::Quartic,
                    },
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
                environments.push(emitters.len() as u32);
                Emitter::Constant(Constant { radiance: b.color(radiance, ColorSlot::Emission, at) })
            }
            EmitterKind::Environment { to_world, image, mapping } => {
                let Some(light) = picture_environment(b, to_world, image, *mapping, at) else { continue };
                environments.push(emitters.len() as u32);
                Emitter::Environment(Box::new(light))
            }
            EmitterKind::SunSky(light) => {
                let Some(light) = sunsky::build(b, light, at) else { continue };
                environments.push(emitters.len() as u32);
                light
            }
            kind => {
                let position = |m: &ir::Transform| relative(m.point([0.0; 3]));
                let Some(light) = pictured::build(b, kind, position, at) else { continue };
                light
            }
        };
        emitters.push(emitter);
        media.push(LampMedium::One(medium));
    }
    environments
}

/// The turned (and perhaps mirrored) axes of a light that has directions.
fn axes(b: &mut Compiler<'_>, to_world: &ir::Transform, what: &str, at: ir::Origin) -> Option<Frame> {
    if !to_world.is_similarity() {
        b.error(format!("the to_world of {what} may turn and mirror it, but not stretch it"), at);
        return None;
    }
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|a| unit(to_world.vector(a)));
    let [Some(s), Some(t), Some(n)] = axes else {
        b.error(format!("the to_world of {what} is singular"), at);
        return None;
    };
    Some(Frame { s, t, n })
}

/// The axes of a spot, and the whole map where it stretches the cone.
fn spot_axes(b: &mut Compiler<'_>, m: &ir::Transform, at: ir::Origin) -> Option<(Frame, Option<Stretched>)> {
    if m.is_similarity() {
        return Some((axes(b, m, "the spot", at)?, None));
    }
    let Some(inverse) = m.inverse() else {
        b.error("the to_world of the spot is singular", at);
        return None;
    };
    let columns = |m: &ir::Transform| {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| vec3(m.vector(axis)))
    };
    let axis = unit(m.vector([0.0, 0.0, 1.0]))?;
    let stretched = Stretched { to_world: columns(m), to_local: columns(&inverse) };
    Some((Frame::from_normal(axis), Some(stretched)))
}

fn picture_environment(
    b: &mut Compiler<'_>,
    to_world: &ir::Transform,
    image: &ir::LightImage,
    mapping: ir::EnvironmentMapping,
    at: ir::Origin,
) -> Option<Environment> {
    let axes = axes(b, to_world, "the environment", at)?;
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
    let mut light = Environment::new(picture, mapping, axes);
    if let Some(wanted) = image.illuminance {
        // pbrt multiplies its illuminance by the scale.
        light.set_illuminance((wanted * image.scale) as f32);
    }
    Some(light)
}
