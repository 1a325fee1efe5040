//! Lights of the scene, and of shapes.

use super::Writer;
use super::film::smaller_fov;
use super::picture::WIDEST;
use super::text::{Params, transform};
use crate::ir::{
    AreaEmission, Color, ColorInput, ColorSlot, Emitter, EmitterKind, EnvironmentMapping, Fov, FovAxis, Id,
    LightImage, Origin, Shape, SpotFalloff, Texture, TextureEncoding, Transform,
};
use crate::sky::Picture;
use crate::spectrum::luminance;
use crate::write::{Cone, WriteError};

/// A goniometric light's pole is +Y of its own space, its picture's +Z.
const POLE: Transform =
    Transform([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);

impl Writer<'_, '_> {
    #[allow(unreachable_patterns, reason = "kinds added later are reported as losses by name")]
    pub fn emitter(&mut self, e: &Emitter) -> Result<(), WriteError> {
        let origin = e.origin;
        let none = Params::default();
        let emission = ColorSlot::Emission;
        let (name, place, p) = match &e.kind {
            EmitterKind::Point { position, intensity } => {
                let p = self.color(none, "I", intensity, emission, origin);
                ("point", Transform::IDENTITY, p.numbers("point3", "from", *position))
            }
            EmitterKind::Spot {
                to_world,
                intensity,
                cutoff_angle,
                beam_width,
                falloff,
                texture: Some(texture),
            } if *cutoff_angle <= WIDEST && self.out.sampled(*texture)?.is_some() => {
                let angles = [*cutoff_angle, *beam_width];
                let p = self.textured_spot(intensity, angles, *falloff, *texture, origin)?;
                ("projection", to_world.after(&Transform::scale([-1.0, 1.0, 1.0])), p)
            }
            EmitterKind::Spot { to_world, intensity, cutoff_angle, beam_width, falloff, texture } => {
                let angles = [*cutoff_angle, *beam_width];
                ("spot", *to_world, self.spot(intensity, angles, *falloff, *texture, origin)?)
            }
            EmitterKind::Directional { direction, irradiance } => {
                let p = self.color(none, "L", irradiance, emission, origin);
                let p = p.numbers("point3", "from", [0.0; 3]).numbers("point3", "to", *direction);
                ("distant", Transform::IDENTITY, p)
            }
            EmitterKind::Constant { radiance } => {
                ("infinite", Transform::IDENTITY, self.color(none, "L", radiance, emission, origin))
            }
            EmitterKind::Environment { to_world, image, mapping } => {
                let name = self.environment(image, *mapping, origin)?;
                let mut p = none.string("filename", &name).float_unless("scale", image.scale, 1.0);
                if let Some(lux) = image.illuminance {
                    p = p.float("illuminance", lux);
                }
                ("infinite", *to_world, p)
            }
            EmitterKind::SunSky(light) => {
                let what = "the sun and the sky as formulas";
                self.out.lose(origin, what, "a picture of them with the same light, the sun blurred by 0.4°");
                let name = self.out.daylight(light, EnvironmentMapping::EqualArea, origin)?;
                ("infinite", light.to_world.after(&Picture::TO_LOCAL), none.string("filename", &name))
            }
            EmitterKind::Projector { to_world, irradiance, scale, fov, fov_axis } => {
                let p = self.projector(irradiance, *scale, (*fov, *fov_axis), origin)?;
                ("projection", to_world.after(&Transform::scale([-1.0, 1.0, 1.0])), p)
            }
            EmitterKind::Projection { to_world, image, fov, power } => {
                let name = self.light_picture(image)?;
                let p = none.string("filename", &name).float("fov", *fov);
                let p = p.float_unless("scale", image.scale, 1.0).float_unless(
                    "power",
                    power.unwrap_or(0.0),
                    0.0,
                );
                ("projection", to_world.after(&Transform::scale([-1.0, 1.0, 1.0])), p)
            }
            EmitterKind::Goniometric { to_world, intensity, image, power } => {
                let mut p = self.color(none, "I", intensity, emission, origin);
                if let Some(image) = image {
                    let name = self.light_picture(image)?;
                    p = p.string("filename", &name).float_unless("scale", image.scale, 1.0);
                }
                ("goniometric", to_world.after(&POLE), p.float_unless("power", power.unwrap_or(0.0), 0.0))
            }
            other => {
                self.out.lose(origin, format!("a `{}` light", other.name()), "no light");
                return Ok(());
            }
        };
        self.light_source(name, &place, p, e);
        Ok(())
    }

    fn light_source(&mut self, name: &str, place: &Transform, p: Params, e: &Emitter) {
        let mut text = String::new();
        self.place(&mut text, "", e.origin);
        let around = e.medium.filter(|_| !e.kind.is_far());
        if *place == Transform::IDENTITY && around.is_none() {
            p.write(&mut text, "", "LightSource", &[name]);
        } else {
            text.push_str("AttributeBegin\n");
            if around.is_some() {
                self.around(&mut text, "\t", around);
            }
            if *place != Transform::IDENTITY {
                transform(&mut text, "\t", place);
            }
            p.write(&mut text, "\t", "LightSource", &[name]);
            text.push_str("AttributeEnd\n");
        }
        self.body.push_str(&text);
    }

    /// A spot of one colour; its angles are half angles in degrees.
    fn spot(
        &mut self,
        intensity: &Color,
        [cutoff_angle, beam_width]: [f64; 2],
        falloff: SpotFalloff,
        texture: Option<Id<Texture>>,
        origin: Origin,
    ) -> Result<Params, WriteError> {
        let what = match falloff {
            SpotFalloff::Smoothstep => None,
            SpotFalloff::Linear => Some("a spot with linear falloff in the angle"),
            SpotFalloff::Quartic => {
                Some("a spot of pbrt-v3, which falls with the fourth power of the cosine")
            }
        };
        if let Some(what) = what {
            let size = Cone::new(cutoff_angle, beam_width, falloff).change(SpotFalloff::Smoothstep);
            self.out.lose_light(origin, what, "smoothstep falloff in the cosine", size);
        }
        let mut p = self.color(Params::default(), "I", intensity, ColorSlot::Emission, origin);
        if let Some(texture) = texture {
            let mean = self.mean_of(texture)?;
            let what = "the texture of a spot that is wide, or whose texture is not by uv";
            self.out.lose(origin, what, format!("its mean, rgb {mean:?}"));
            let rgb = self.out.rgb(intensity, ColorSlot::Emission, origin);
            p = Params::default().rgb("I", std::array::from_fn(|i| rgb[i] * mean[i]));
        }
        Ok(p.float("coneangle", cutoff_angle).float("conedeltaangle", cutoff_angle - beam_width))
    }

    /// The parameters of Mitsuba's projector as pbrt's.
    fn projector(
        &mut self,
        irradiance: &ColorInput,
        scale: f64,
        (fov, axis): (Fov, FovAxis),
        origin: Origin,
    ) -> Result<Params, WriteError> {
        // Mitsuba's has π times the picture on the plane z = 1, where pbrt's has the picture.
        let mut scale = scale * std::f64::consts::PI;
        let (name, fov) = match irradiance {
            ColorInput::Color(color) => {
                let rgb = self.out.rgb(color, ColorSlot::Emission, origin);
                if rgb.iter().any(|v| *v != rgb[0]) {
                    self.out.lose(origin, "the colour of a projector without picture", "its luminance");
                }
                scale *= luminance(rgb);
                let fov = smaller_fov(fov, axis, 1.0);
                (self.out.even_intensity(half_tangent(fov))?, fov)
            }
            ColorInput::Texture(id) => {
                let size = self.out.picture_size(*id)?;
                let fov = smaller_fov(fov, axis, size[0] as f64 / size[1] as f64);
                match self.out.sampled(*id)? {
                    Some(sampled) => (self.out.slide_intensity(*id, &sampled, size, half_tangent(fov))?, fov),
                    None => {
                        let what = "a projector whose picture is not by uv";
                        self.out.lose(origin, what, "an even picture, gray 0.5");
                        scale *= 0.5;
                        (self.out.even_intensity(half_tangent(fov))?, fov)
                    }
                }
            }
        };
        let p = Params::default().string("filename", &name).float("fov", fov).float("scale", scale);
        Ok(p)
    }

    /// The picture of a light: pbrt wants it in colour.
    fn light_picture(&mut self, image: &LightImage) -> Result<String, WriteError> {
        if self.out.is_gray(&image.path) || !self.out.is_well_named(&image.path) {
            return self.out.decode(image);
        }
        Ok(self.out.carry(&image.path, "textures"))
    }

    fn environment(
        &mut self,
        image: &LightImage,
        mapping: EnvironmentMapping,
        origin: Origin,
    ) -> Result<String, WriteError> {
        match (mapping, image.encoding) {
            (EnvironmentMapping::EqualArea, TextureEncoding::Auto) => self.light_picture(image),
            (EnvironmentMapping::EqualArea, _) => self.out.decode(image),
            (EnvironmentMapping::LatLong, _) => {
                self.out.lose(
                    origin,
                    "an environment picture by latitude and longitude",
                    "the same light resampled to equal areas",
                );
                self.out.remap(image, EnvironmentMapping::EqualArea)
            }
        }
    }

    /// The light of a shape, brighter by `factor`.
    pub fn emission(
        &mut self,
        text: &mut String,
        shape: &Shape,
        e: &AreaEmission,
        factor: f64,
    ) -> Result<(), WriteError> {
        if e.collimated {
            self.out.lose(e.origin, "a light that emits along its normal only", "a diffuse light");
        }
        let none = Params::default();
        let p = match &e.radiance {
            ColorInput::Color(color) => self.color(none, "L", color, ColorSlot::Emission, e.origin),
            ColorInput::Texture(id) => self.emitted_picture(*id, shape, e.origin)?,
        };
        let of_power = self.out.lamp_factor(shape, e)?;
        p.float_unless("scale", e.scale * factor * of_power, 1.0)
            .boolean_unless("twosided", e.two_sided, false)
            .write(text, "\t", "AreaLightSource", &["diffuse"]);
        Ok(())
    }
}

/// Of a full angle in degrees.
fn half_tangent(fov: f64) -> f64 {
    (fov.to_radians() / 2.0).tan()
}
