//! Emitters of the scene.

use super::Writer;
use super::element::Element;
use super::sensor::fov;
use super::texture::Said;
use crate::ir::{
    Color, ColorInput, ColorSlot, Emitter, EmitterKind, EnvironmentMapping, Fov, FovAxis, Id, LightImage,
    Origin, SpotFalloff, Texture, TextureEncoding,
};
use crate::write::{Cone, WriteError};

impl Writer<'_, '_> {
    #[allow(unreachable_patterns, reason = "kinds added later are reported as losses by name")]
    pub fn emitter(&mut self, e: &Emitter) -> Result<Option<Element>, WriteError> {
        let origin = e.origin;
        let plugin = |name: &str| Element::plugin("emitter", name).id(e.name.as_deref());
        Ok(Some(match &e.kind {
            EmitterKind::Point { position, intensity } => plugin("point")
                .triple("point", "position", *position)
                .child(self.light("intensity", intensity, 1.0, origin)),
            EmitterKind::Spot { to_world, intensity, cutoff_angle, beam_width, falloff, texture } => {
                let what = match falloff {
                    SpotFalloff::Linear => None,
                    SpotFalloff::Smoothstep => Some("a spot with smoothstep falloff in the cosine"),
                    SpotFalloff::Quartic => Some("a spot that falls with the fourth power of the cosine"),
                };
                if let Some(what) = what {
                    let size = Cone::new(*cutoff_angle, *beam_width, *falloff).change(SpotFalloff::Linear);
                    self.out.lose_light(origin, what, "linear falloff in the angle", size);
                }
                let (intensity, texture) = self.spot_texture(intensity, *texture, origin)?;
                plugin("spot")
                    .transform("to_world", to_world)
                    .child(self.light("intensity", &intensity, 1.0, origin))
                    .float("cutoff_angle", *cutoff_angle)
                    .float_unless("beam_width", *beam_width, cutoff_angle * 0.75)
                    .children(texture)
            }
            EmitterKind::Directional { direction, irradiance } => plugin("directional")
                .triple("vector", "direction", *direction)
                .child(self.light("irradiance", irradiance, 1.0, origin)),
            EmitterKind::Constant { radiance } => {
                plugin("constant").child(self.light("radiance", radiance, 1.0, origin))
            }
            EmitterKind::Environment { to_world, image, mapping } => {
                let name = self.environment(image, *mapping, origin)?;
                let scale = image.scale * self.out.illuminance_factor(image)? * self.light;
                plugin("envmap")
                    .string("filename", &name)
                    .float_unless("scale", scale, 1.0)
                    .transform("to_world", to_world)
            }
            EmitterKind::SunSky(light) => self.sunsky(light, e.name.as_deref(), origin)?,
            EmitterKind::Projector { to_world, irradiance, scale, fov: angle, fov_axis } => {
                let texture = match irradiance {
                    ColorInput::Color(color) => self.light("irradiance", color, 1.0, origin),
                    ColorInput::Texture(id) => self.texture("irradiance", *id)?,
                };
                let factor = match irradiance {
                    ColorInput::Color(_) => *scale,
                    ColorInput::Texture(_) => scale * self.light,
                };
                fov(plugin("projector").transform("to_world", to_world), *angle, *fov_axis)
                    .child(texture)
                    .float_unless("scale", factor, 1.0)
            }
            EmitterKind::Projection { to_world, image, fov: angle, power } => {
                self.projection(plugin("projector").transform("to_world", to_world), image, *angle, *power)?
            }
            EmitterKind::Goniometric { to_world, intensity, image, power } => {
                let mut factor = 1.0;
                if let Some(image) = image {
                    let what = "an intensity that depends on the direction";
                    self.out.lose_light(origin, what, "its mean everywhere", 0.0);
                    factor = image.scale * self.out.mean_light(image)?;
                }
                // pbrt's power is that of an intensity of 1.
                if let Some(power) = power.filter(|_| factor > 0.0) {
                    factor = power / (4.0 * std::f64::consts::PI);
                }
                let element = plugin("point").triple("point", "position", to_world.point([0.0; 3]));
                element.child(self.light("intensity", intensity, factor, origin))
            }
            other => return Ok(self.lost_light(other, origin)),
        }))
    }

    /// Reports a kind that [`Self::emitter`] does not handle.
    fn lost_light(&mut self, kind: &EmitterKind, origin: Origin) -> Option<Element> {
        self.out.lose(origin, format!("a `{}` light", kind.name()), "no light");
        None
    }

    /// The intensity and the texture of a spot; Mitsuba refuses a texture that is the same everywhere.
    fn spot_texture(
        &mut self,
        intensity: &Color,
        texture: Option<Id<Texture>>,
        origin: Origin,
    ) -> Result<(Color, Option<Element>), WriteError> {
        let Some(id) = texture else { return Ok((intensity.clone(), None)) };
        Ok(match self.said(id, [1.0; 3])? {
            Said::Constant(factor) => {
                let rgb = self.rgb(intensity, ColorSlot::Emission, origin);
                (Color::Rgb(std::array::from_fn(|i| rgb[i] * factor[i])), None)
            }
            Said::Plugin(_) => (intensity.clone(), Some(self.texture("texture", id)?)),
        })
    }

    fn projection(
        &mut self,
        element: Element,
        image: &LightImage,
        angle: f64,
        power: Option<f64>,
    ) -> Result<Element, WriteError> {
        let tangent = (angle.to_radians() / 2.0).tan();
        let factor = self.out.projection_factor(image, tangent, power)?;
        let name = self.out.slide_irradiance(image, tangent)?;
        let texture = Element::plugin("texture", "bitmap")
            .with("name", "irradiance")
            .string("filename", &name)
            .boolean_unless("raw", true, false);
        // Mitsuba's has π times the picture on the plane z = 1, where pbrt's has the picture.
        let scale = factor * image.scale * self.light / std::f64::consts::PI;
        Ok(fov(element, Fov::Degrees(angle), FovAxis::Smaller).child(texture).float("scale", scale))
    }

    fn environment(
        &mut self,
        image: &LightImage,
        mapping: EnvironmentMapping,
        origin: Origin,
    ) -> Result<String, WriteError> {
        match (mapping, image.encoding) {
            (EnvironmentMapping::LatLong, TextureEncoding::Auto) => {
                Ok(self.out.carry(&image.path, "textures"))
            }
            (EnvironmentMapping::LatLong, _) => self.out.decode(image),
            (EnvironmentMapping::EqualArea, _) => {
                self.out.lose(
                    origin,
                    "an equal-area environment picture",
                    "the same light resampled by latitude and longitude",
                );
                self.out.remap(image, EnvironmentMapping::LatLong)
            }
        }
    }
}
