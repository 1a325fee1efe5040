//! Lights at a place that throw a picture.

use caustica_formats::ir::{self, ColorSlot, EmitterKind};

use super::super::Compiler;
use super::super::sensor::field_of_view;
use super::axes;
use crate::emitter::{Emitter, Frustum, Goniometric, Picture, Projection, Projector};
use crate::math::{Frame, Vec2, Vec3};
use crate::sensor::{Axis, Perspective};
use crate::spectrum::luminance;
use crate::texture::Texture;

pub fn build(
    b: &mut Compiler<'_>,
    kind: &EmitterKind,
    position: impl Fn(&ir::Transform) -> Vec3,
    at: ir::Origin,
) -> Option<Emitter> {
    match kind {
        EmitterKind::Projector { to_world, irradiance, scale, fov, fov_axis } => {
            let (axes, [wider, higher]) = frustum_axes(b, to_world, at)?;
            let irradiance = b.param(irradiance, ColorSlot::Emission, at);
            // A picture keeps its shape; anything else is square.
            let aspect = irradiance.texture(b.textures_of(irradiance)).map_or(1.0, |t| match t {
                Texture::Bitmap(t) => t.width as f64 / t.height as f64,
                _ => 1.0,
            });
            let (angle, axis) = field_of_view(*fov, *fov_axis);
            let [width, height] = Perspective::new(angle, axis, aspect).window.half.to_array();
            let half = Vec2::new(width * wider, height * higher);
            let irradiance = b.scaled(irradiance, *scale as f32);
            let frustum = Frustum { position: position(to_world), axes, half };
            Some(Emitter::Projector(Projector { frustum, irradiance }))
        }
        EmitterKind::Projection { to_world, image, fov, power } => {
            let axes = axes(b, to_world, "the projection", at)?;
            let picture = b.light_image(image, at)?;
            let aspect = picture.width as f64 / picture.height as f64;
            let half = Perspective::new(*fov, Axis::Smaller, aspect).window.half;
            let frustum = Frustum { position: position(to_world), axes, half };
            // pbrt multiplies its power by the scale.
            let power = power.map(|p| (p * image.scale) as f32);
            Some(Emitter::Projection(Box::new(Projection::new(frustum, picture, power))))
        }
        EmitterKind::Goniometric { to_world, intensity, image, power } => {
            let axes = axes(b, to_world, "the goniometric light", at)?;
            let mut intensity = b.color(intensity, ColorSlot::Emission, at);
            let picture = match image {
                Some(image) => b.light_image(image, at)?,
                None => Picture::new(1, 1, vec![[1.0; 3]]),
            };
            if picture.width != picture.height {
                b.error("the equal-area picture of a goniometric light must be square", at);
                return None;
            }
            let place = position(to_world);
            let mut light = Goniometric::new(place, axes, intensity, &picture);
            let emitted = luminance(light.flux()) / luminance(intensity);
            if let Some(wanted) = power.filter(|_| emitted > 0.0) {
                // The power is that of an intensity of 1, as in pbrt.
                intensity *= wanted as f32 / emitted;
                light = Goniometric::new(place, axes, intensity, &picture);
            }
            Some(Emitter::Goniometric(Box::new(light)))
        }
        _ => {
            b.unsupported("this emitter", "nothing", at);
            None
        }
    }
}

/// The axes of a projector whose picture may be stretched along its sides, and by how much against its depth.
fn frustum_axes(b: &mut Compiler<'_>, m: &ir::Transform, at: ir::Origin) -> Option<(Frame, [f32; 2])> {
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| m.vector(axis));
    let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let depth = length(columns[2]);
    let stretch = [length(columns[0]) / depth, length(columns[1]) / depth];
    let even = m.after(&ir::Transform::scale([1.0 / stretch[0], 1.0 / stretch[1], 1.0]));
    let even = if m.is_similarity() || !stretch.iter().all(|s| s.is_normal()) { *m } else { even };
    let axes = axes(b, &even, "the projector", at)?;
    let stretch = if m.is_similarity() { [1.0; 2] } else { stretch.map(|s| s as f32) };
    Some((axes, stretch))
}
