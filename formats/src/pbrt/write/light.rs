//! Lights of the scene, and of shapes.

use super::Writer;
use super::film::smaller_fov;
use super::text::{Params, transform};
use crate::ir::{
    AreaEmission, ColorInput, ColorSlot, Emitter, EmitterKind, EnvironmentMapping, Fov, FovAxis, LightImage,
    Mapping, Origin, SpotFalloff, TextureEncoding, TextureFilter, TextureKind, Transform,
};
use crate::spectrum::luminance;
use crate::write::WriteError;

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
            EmitterKind::Spot { to_world, intensity, cutoff_angle, beam_width, falloff, texture } => {
                if *falloff == SpotFalloff::Linear {
                    self.out.lose(
                        origin,
                        "a spot with linear falloff in the angle",
                        "smoothstep falloff in the cosine",
                    );
                }
                if texture.is_some() {
                    self.out.lose(origin, "the texture of a spot", "a spot without texture");
                }
                let p = self.color(none, "I", intensity, emission, origin);
                let p = p.float("coneangle", *cutoff_angle);
                ("spot", *to_world, p.float("conedeltaangle", cutoff_angle - beam_width))
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
            EmitterKind::Projector { to_world, irradiance, scale, fov, fov_axis } => {
                let Some(p) = self.projector(irradiance, *scale, (*fov, *fov_axis), origin)? else {
                    return Ok(());
                };
                ("projection", to_world.after(&Transform::scale([-1.0, 1.0, 1.0])), p)
            }
            EmitterKind::Projection { to_world, image, fov, power } => {
                let name = self.out.carry(&image.path, "textures");
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
                    let name = self.out.carry(&image.path, "textures");
                    p = p.string("filename", &name).float_unless("scale", image.scale, 1.0);
                }
                ("goniometric", to_world.after(&POLE), p.float_unless("power", power.unwrap_or(0.0), 0.0))
            }
            other => {
                self.out.lose(origin, format!("a `{}` light", other.name()), "no light");
                return Ok(());
            }
        };
        self.light_source(name, &place, p, origin);
        Ok(())
    }

    fn light_source(&mut self, name: &str, place: &Transform, p: Params, origin: Origin) {
        let mut text = String::new();
        self.place(&mut text, "", origin);
        if *place == Transform::IDENTITY {
            p.write(&mut text, "", "LightSource", &[name]);
        } else {
            text.push_str("AttributeBegin\n");
            transform(&mut text, "\t", place);
            p.write(&mut text, "\t", "LightSource", &[name]);
            text.push_str("AttributeEnd\n");
        }
        self.body.push_str(&text);
    }

    /// The parameters of Mitsuba's projector as pbrt's; `None` after a loss.
    fn projector(
        &mut self,
        irradiance: &ColorInput,
        scale: f64,
        (fov, axis): (Fov, FovAxis),
        origin: Origin,
    ) -> Result<Option<Params>, WriteError> {
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
                let TextureKind::Bitmap(bitmap) = &self.scene.textures[*id].kind else {
                    self.out.lose(origin, "a projector whose picture is not an image", "nothing");
                    return Ok(None);
                };
                if bitmap.mapping != Mapping::Uv(Transform::IDENTITY) {
                    self.out.lose(origin, "the `to_uv` of a projector's picture", "the whole picture");
                }
                if bitmap.filter == TextureFilter::Bilinear {
                    let what = "bilinear interpolation of a projected image";
                    self.out.lose(origin, what, "nearest-pixel lookup");
                }
                let fov = smaller_fov(fov, axis, self.out.aspect(&bitmap.path)?);
                (self.out.slide_intensity(bitmap, half_tangent(fov))?, fov)
            }
        };
        let p = Params::default().string("filename", &name).float("fov", fov).float("scale", scale);
        Ok(Some(p))
    }

    fn environment(
        &mut self,
        image: &LightImage,
        mapping: EnvironmentMapping,
        origin: Origin,
    ) -> Result<String, WriteError> {
        match (mapping, image.encoding) {
            (EnvironmentMapping::EqualArea, TextureEncoding::Auto) => {
                Ok(self.out.carry(&image.path, "textures"))
            }
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

    pub fn emission(&mut self, text: &mut String, e: &AreaEmission) -> Result<(), WriteError> {
        if e.collimated {
            self.out.lose(e.origin, "a lamp that emits along its normal only", "a diffuse lamp");
        }
        let none = Params::default();
        let p = match &e.radiance {
            ColorInput::Color(color) => self.color(none, "L", color, ColorSlot::Emission, e.origin),
            ColorInput::Texture(id) => match &self.scene.textures[*id].kind {
                TextureKind::Bitmap(bitmap) => {
                    let name = self.out.carry(&bitmap.path, "textures");
                    none.string("filename", &name)
                }
                _ => {
                    self.out.lose(e.origin, "the texture of a lamp", "white light");
                    none.rgb("L", [1.0; 3])
                }
            },
        };
        p.float_unless("scale", e.scale, 1.0)
            .float_unless("power", e.power.unwrap_or(0.0), 0.0)
            .boolean_unless("twosided", e.two_sided, false)
            .write(text, "\t", "AreaLightSource", &["diffuse"]);
        Ok(())
    }
}

/// Of a full angle in degrees.
fn half_tangent(fov: f64) -> f64 {
    (fov.to_radians() / 2.0).tan()
}
