//! Lights: those of the scene, and those of shapes.

use std::f64::consts::PI;
use std::path::PathBuf;

use super::color::{Use, linear, scaled};
use super::directive::ParamType;
use super::params::Params;
use super::reader::Reader;
use super::texture::upside_down;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    AreaEmission, Bitmap, Color, ColorInput, ColorSlot, Emitter, EmitterKind, EnvironmentMapping, LightImage,
    Mapping, SpotFalloff, Texture, TextureEncoding, TextureFilter, TextureKind, Transform, WrapMode,
};
use crate::plugin::{Plugin, Status, find, read};
use crate::spectrum::luminance;

use ParamType as T;

type ReadLight = fn(&mut Reader<'_>, &mut Params) -> Option<EmitterKind>;

pub(super) const LIGHTS: &[Plugin<ReadLight>] = &[
    read("point", point),
    read("distant", distant),
    read("spot", spot),
    read("goniometric", goniometric),
    read("projection", projection),
    read("infinite", infinite),
];

pub(super) const AREA_LIGHTS: &[Plugin<()>] = &[read("diffuse", ())];

impl Reader<'_> {
    pub fn light(&mut self, mut p: Params) {
        let Some(reader) = self.plugin(LIGHTS, &mut p, "it is skipped") else { return self.done(p) };
        let kind = reader(self, &mut p);
        let origin = p.origin();
        self.done(p);
        let outside = self.state.media[1];
        self.scene.emitters.extend(kind.map(|kind| {
            // Light from everywhere around the scene comes through no medium at first.
            let medium = outside.filter(|_| !kind.is_far());
            Emitter { name: None, origin, kind, medium }
        }));
    }

    /// The emission that the current area light gives a shape, which is `lamps` times as large as pbrt knows of a lamp of it.
    pub fn area_emission(&mut self, lamps: Option<f64>) -> Option<AreaEmission> {
        let mut p = self.state.area_light.as_deref()?.clone();
        if !matches!(find(AREA_LIGHTS, &p.kind), Some(Status::Read(()))) {
            self.plugin(AREA_LIGHTS, &mut p, "the shape does not emit light");
            self.done(p);
            return None;
        }
        let origin = p.origin();
        let image = if p.has("filename") { self.asset(&mut p, "filename", "image") } else { None };
        p.ignore(&["filename"]);
        if p.has("filename") && p.has("L") {
            p.complain("filename", "an area light takes either `L` or `filename`, not both");
        }
        let (color, scale) = if self.policy.is_three() {
            (Some(self.old_color(&mut p, "L")), 1.0)
        } else {
            (self.color(&mut p, "L", Use::Illuminant), p.float("scale", 1.0))
        };
        let power = area_power(&mut p, color.as_ref(), lamps);
        let radiance = match image {
            Some(path) => {
                let kind = TextureKind::Bitmap(uv_image(path));
                ColorInput::Texture(self.scene.textures.push(Texture { name: None, origin, kind }))
            }
            None => ColorInput::Color(color.unwrap_or_else(|| Reader::white_light(&p))),
        };
        let emission = AreaEmission {
            origin,
            radiance,
            scale,
            two_sided: p.boolean("twosided", false),
            collimated: false,
            power,
        };
        self.done(p);
        Some(emission)
    }

    /// A light's colour in pbrt-v3: the spectrum as it is, times the colour `scale`.
    fn old_color(&mut self, p: &mut Params, name: &'static str) -> Color {
        let color = self.color(p, name, Use::Unbounded).unwrap_or(Color::Rgb([1.0; 3]));
        let Some(scale) = self.color(p, "scale", Use::Unbounded) else { return color };
        let [r, g, b] = linear(&scale, ColorSlot::Emission).unwrap_or([1.0; 3]);
        if r == g && g == b && !matches!(color, Color::Library(_)) {
            return scaled(color, r);
        }
        let rgb = linear(&color, ColorSlot::Emission).unwrap_or([1.0; 3]);
        Color::Rgb([rgb[0] * r, rgb[1] * g, rgb[2] * b])
    }

    /// What pbrt-v3 multiplies a light's picture by: a number here, and the mean of a colour.
    fn old_picture_scale(&mut self, p: &mut Params, name: &'static str) -> f64 {
        let color = self.old_color(p, name);
        let rgb = linear(&color, ColorSlot::Emission).unwrap_or([1.0; 3]);
        let mean = rgb.iter().sum::<f64>() / 3.0;
        if rgb.iter().any(|c| (c - mean).abs() > 1e-3 * mean.abs()) {
            let [r, g, b] = rgb;
            let text = format!(
                "the colour ({r:.4}, {g:.4}, {b:.4}) of a light with a picture is left out: its mean is kept"
            );
            p.problems.push(Diagnostic::warning(text, Some(p.span)));
        }
        mean
    }

    /// `I` or `L` times `scale`, and times what `power` asks for where that is more than zero.
    fn intensity(
        &mut self,
        p: &mut Params,
        name: &'static str,
        of_power: Option<(&'static str, f64)>,
    ) -> Color {
        if self.policy.is_three() {
            return self.old_color(p, name);
        }
        let color = self.color(p, name, Use::Illuminant).unwrap_or_else(|| Reader::white_light(p));
        let mut scale = p.float("scale", 1.0);
        if let Some((power, emitted)) = of_power
            && let Some(wanted) = p.optional_float(power).filter(|power| *power > 0.0)
        {
            scale *= wanted / emitted;
        }
        scaled(color, scale)
    }

    fn light_image(&mut self, p: &mut Params, name: &'static str) -> Option<LightImage> {
        let path = self.asset(p, name, "image")?;
        Some(LightImage { path, encoding: TextureEncoding::Auto, scale: 1.0, illuminance: None })
    }
}

/// What the whole shape emits where `power` is given (`DiffuseAreaLight::Create`): each of pbrt's lamps emits it, times the
/// luminance of a colour.
fn area_power(p: &mut Params, color: Option<&Color>, lamps: Option<f64>) -> Option<f64> {
    let power = p.optional_float("power").filter(|power| *power > 0.0)?;
    let brightness = color.and_then(|color| linear(color, ColorSlot::Emission)).map_or(1.0, luminance);
    if lamps.is_none() {
        let text = "`power` is that of the whole mesh here; in pbrt each of its faces emits as much";
        p.warn("power", text);
    }
    Some(power * brightness * lamps.unwrap_or(1.0))
}

fn uv_image(path: PathBuf) -> Bitmap {
    Bitmap {
        path,
        filter: TextureFilter::Bilinear,
        wrap_u: WrapMode::Clamp,
        wrap_v: WrapMode::Clamp,
        encoding: TextureEncoding::Auto,
        channel: None,
        mapping: upside_down(Mapping::Uv(Transform::IDENTITY)),
        scale: 1.0,
        invert: false,
    }
}

fn point(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    let from = p.triple("from", T::Point3).unwrap_or_default();
    let ctm = &r.state.ctm[0];
    let position = if r.policy.is_three() {
        // pbrt-v3 moves by `from` in the world, after the transform.
        let origin = ctm.point([0.0; 3]);
        std::array::from_fn(|i| origin[i] + from[i])
    } else {
        ctm.point(from)
    };
    Some(EmitterKind::Point { position, intensity: r.intensity(p, "I", Some(("power", 4.0 * PI))) })
}

fn distant(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    let from = p.triple("from", T::Point3).unwrap_or_default();
    let to = p.triple("to", T::Point3).unwrap_or([0.0, 0.0, 1.0]);
    let direction = r.state.ctm[0].vector(std::array::from_fn(|i| to[i] - from[i]));
    let irradiance = r.intensity(p, "L", Some(("illuminance", 1.0)));
    if direction == [0.0; 3] {
        p.complain("to", "the light has no direction: `from` and `to` are the same point");
        return None;
    }
    Some(EmitterKind::Directional { direction, irradiance })
}

fn spot(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    let from = p.triple("from", T::Point3).unwrap_or_default();
    let to = p.triple("to", T::Point3).unwrap_or([0.0, 0.0, 1.0]);
    let cone = p.float("coneangle", 30.0);
    let delta = p.float("conedeltaangle", 5.0);
    if !(cone > 0.0 && cone <= 180.0) {
        p.complain("coneangle", format!("`coneangle` must lie between 0 and 180 degrees, not {cone}"));
        return None;
    }
    if !(0.0..=cone).contains(&delta) {
        let text = format!("`conedeltaangle` must lie between 0 and {cone}, the cone angle, not {delta}");
        p.complain("conedeltaangle", text);
        return None;
    }
    let (cos_beam, cos_cone) = ((cone - delta).to_radians().cos(), cone.to_radians().cos());
    let falloff = if r.policy.is_three() { SpotFalloff::Quartic } else { SpotFalloff::Smoothstep };
    // The integral of the smoothstep over the sphere: half of the rim counts.
    let emitted = 2.0 * PI * ((1.0 - cos_beam) + (cos_beam - cos_cone) / 2.0);
    let intensity = r.intensity(p, "I", Some(("power", emitted)));
    let Some(aim) = aim(from, to) else {
        p.complain("to", "the light has no direction: `from` and `to` are the same point");
        return None;
    };
    Some(EmitterKind::Spot {
        to_world: r.state.ctm[0].after(&aim),
        intensity,
        cutoff_angle: cone,
        beam_width: cone - delta,
        falloff,
        texture: None,
    })
}

/// Local +Z to the direction from `from` to `to`, about which the light is the same all around.
fn aim(from: [f64; 3], to: [f64; 3]) -> Option<Transform> {
    let up = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let d: [f64; 3] = std::array::from_fn(|i| (to[i] - from[i]).abs());
    let up = if d[1] > d[0].max(d[2]) { up[1] } else { up[0] };
    Transform::look_at(from, to, up)
}

fn goniometric(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    let intensity = r.intensity(p, "I", None);
    if p.has("mapname") && r.policy.is_three() {
        let span = p.span_of("mapname");
        r.unsupported(
            "the latitude-longitude picture of a goniometric light",
            "the light shines evenly",
            span,
        );
        p.ignore(&["mapname"]);
    }
    let image = if p.has("filename") { r.light_image(p, "filename") } else { None };
    p.ignore(&["filename"]);
    if !p.has("filename") && !p.has("mapname") {
        p.problems
            .push(Diagnostic::warning("a goniometric light without an image is a point light", Some(p.span)));
    }
    // The light's pole is +Y of its own space, the image's +Z.
    let swap =
        Transform([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);
    let power = p.optional_float("power").filter(|power| *power > 0.0);
    Some(EmitterKind::Goniometric { to_world: r.state.ctm[0].after(&swap), intensity, image, power })
}

fn projection(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    let old = r.policy.is_three();
    let name = if old { "mapname" } else { "filename" };
    let image = r.light_image(p, name);
    let scale = if old { r.old_picture_scale(p, "I") } else { p.float("scale", 1.0) };
    let fov = p.float("fov", if old { 45.0 } else { 90.0 });
    let power = if old { None } else { p.optional_float("power").filter(|power| *power > 0.0) };
    if !(fov > 0.0 && fov < 180.0) {
        p.complain("fov", format!("`fov` must lie between 0 and 180 degrees, not {fov}"));
        return None;
    }
    // pbrt's +X is on the right of the picture, ours on the left.
    let to_world = r.state.ctm[0].after(&Transform::scale([-1.0, 1.0, 1.0]));
    Some(EmitterKind::Projection { to_world, image: LightImage { scale, ..image? }, fov, power })
}

fn infinite(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    if p.has("portal") {
        r.unsupported(
            "the portal of an infinite light",
            "the light comes from all directions",
            p.span_of("portal"),
        );
        p.ignore(&["portal"]);
    }
    if p.has("mapname") {
        return old_environment(r, p);
    }
    if !p.has("filename") {
        p.ignore(&["filename"]);
        return Some(EmitterKind::Constant { radiance: r.intensity(p, "L", Some(("illuminance", PI))) });
    }
    let path = r.asset(p, "filename", "image");
    if r.color(p, "L", Use::Illuminant).is_some() {
        p.complain("L", "an infinite light takes either `L` or `filename`, not both");
    }
    let scale = p.float("scale", 1.0);
    let illuminance = p.optional_float("illuminance").filter(|lux| *lux > 0.0);
    let image = LightImage { path: path?, encoding: TextureEncoding::Auto, scale, illuminance };
    Some(EmitterKind::Environment { to_world: r.state.ctm[0], image, mapping: EnvironmentMapping::EqualArea })
}

/// The latitude-longitude map of pbrt-v3.
fn old_environment(r: &mut Reader<'_>, p: &mut Params) -> Option<EmitterKind> {
    let (name, span) = p.optional_string("mapname")?;
    if name.is_empty() {
        return Some(EmitterKind::Constant { radiance: r.intensity(p, "L", None) });
    }
    let path = r.located(p, "image", &name, span);
    let scale = if r.policy.is_three() { r.old_picture_scale(p, "L") } else { p.float("scale", 1.0) };
    let image = LightImage { path: path?, encoding: TextureEncoding::Auto, scale, illuminance: None };
    let to_world = r.state.ctm[0].after(&LAT_LONG);
    Some(EmitterKind::Environment { to_world, image, mapping: EnvironmentMapping::LatLong })
}

/// From Mitsuba's axes of a latitude-longitude map (+Y up, +Z in the middle, −Z at the left edge, +X a
/// quarter in) to pbrt-v3's (+Z up, +X at the left edge, +Y a quarter in).
const LAT_LONG: Transform =
    Transform([[0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);
