//! Emitters: those of the scene, and those of shapes.

use super::color::{is_spectrum, is_texture, times};
use super::object::{Class, ObjectIndex, Value};
use super::props::{Nested, Props};
use super::reader::Reader;
use super::sensor::{AXES, fov};
use super::sunsky;
use super::texture::gamma;
use super::turned::turned;
use super::version::Dialect;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    AreaEmission, ColorSlot, Emitter, EmitterKind, EnvironmentMapping, FovAxis, LightImage, SpotFalloff,
    Transform,
};
use crate::plugin::{Plugin, read, unsupported, unsupported_but};

type ReadEmitter = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<EmitterKind>;

/// Emitters that stand in the scene.
pub(super) const EMITTERS: &[Plugin<ReadEmitter>] = &[
    read("point", point),
    read("spot", spot),
    read("directional", directional),
    read("constant", constant),
    read("envmap", envmap),
    read("projector", projector),
    read("sunsky", sunsky::sunsky),
    read("timed_sunsky", sunsky::timed_sunsky),
    read("sky", sunsky::old_sky),
    read("sun", sunsky::old_sun),
    unsupported_but("collimated", "use a small rectangle with a `directionalarea` emitter"),
    // In the table for the sake of suggestions; `top_level_emitter` deals with them.
    unsupported("area"),
    unsupported("directionalarea"),
];

/// Emitters on the surface of a shape; true for those that emit along the normal only.
pub(super) const AREA_EMITTERS: &[Plugin<bool>] = &[read("area", false), read("directionalarea", true)];

/// How often the emitter is chosen, and marks of renderers that sample specular chains; ignored.
const HARMLESS: &[&str] = &["sampling_weight", "caustic_emitter_single", "caustic_emitter_multi"];

impl<'a> Reader<'a> {
    pub fn top_level_emitter(&mut self, index: ObjectIndex) {
        let object = &self.objects[index];
        if object.plugin == "area" || object.plugin == "directionalarea" {
            // It may be defined here only for shapes to refer to.
            if !object.used {
                let text = format!("an {} emitter must be part of a shape", object.plugin);
                self.problems.push(
                    Diagnostic::error(text, Some(object.span))
                        .help("put it, or a <ref> to it, into a <shape>"),
                );
            }
            return;
        }
        self.light(index);
    }

    /// An emitter that is not the surface of a shape, once.
    fn light(&mut self, index: ObjectIndex) {
        if !self.lights.insert(index) {
            return;
        }
        let Some(reader) = self.plugin(EMITTERS, index, "it is skipped") else { return };
        let mut props = self.props(index);
        props.ignore(HARMLESS);
        let medium = self.medium_around(&mut props);
        let kind = reader(self, &mut props);
        let (name, origin) = (props.name(), props.origin());
        self.finish(props);
        self.scene.emitters.extend(kind.map(|kind| Emitter { name, origin, kind, medium }));
    }

    /// What the emitter inside a shape makes of it. Only some emitters shine from the surface; Mitsuba 2 and 3 take
    /// any other as if it stood in the scene, so that the shape's own transform does not move it.
    pub fn shape_emitter(&mut self, nested: Nested) -> Option<AreaEmission> {
        let plugin = self.objects[nested.index].plugin.as_str();
        if AREA_EMITTERS.iter().any(|row| row.name == plugin) || EMITTERS.iter().all(|row| row.name != plugin)
        {
            return self.area_emission(nested.index);
        }
        if self.dialect == Dialect::Old {
            let text = format!("Mitsuba 0.6 takes no emitter of type `{plugin}` inside a shape");
            let problem = Diagnostic::error(text, Some(nested.span));
            self.problems.push(problem.help("put it into the scene, beside the shape"));
            return None;
        }
        self.light(nested.index);
        None
    }

    /// The emission of a shape; `None` after reporting why there is none.
    pub fn area_emission(&mut self, index: ObjectIndex) -> Option<AreaEmission> {
        if let Some(emission) = self.emissions.get(&index) {
            return emission.clone();
        }
        let emission = self.plugin(AREA_EMITTERS, index, "the shape does not emit light").map(|collimated| {
            let mut props = self.props(index);
            if props.has("to_world") {
                props.complain("to_world", "an area emitter takes no `to_world`; place the shape instead");
            }
            props.ignore(HARMLESS);
            props.ignore(&["to_world"]);
            // Light leaves into the medium outside of the shape.
            self.medium_around(&mut props);
            let radiance = self.color_input(&mut props, "radiance", ColorSlot::Emission, 1.0);
            let origin = props.origin();
            self.finish(props);
            AreaEmission { origin, radiance, scale: 1.0, two_sided: false, collimated, power: None }
        });
        self.emissions.insert(index, emission.clone());
        emission
    }

    /// Checks that concern all emitters together.
    pub fn check_emitters(&mut self) {
        let environments: Vec<_> = self.scene.emitters.iter().filter(|e| e.kind.fills_the_sky()).collect();
        if let [first, second, ..] = environments.as_slice() {
            let mut problem = Diagnostic::error(
                "a scene may have only one environment; this is a second one",
                second.origin.0,
            );
            problem.labels.extend(first.origin.0.map(|span| (span, "the first one".to_owned())));
            self.problems.push(problem);
        }
        let shines = self.objects.iter().any(|o| o.class == Class::Emitter);
        if self.dialect == Dialect::Old && !shines && !self.scene.shapes.is_empty() {
            let problem =
                Diagnostic::warning("the scene has no emitter and will be black", self.scene.origin.0);
            self.problems.push(problem.help("Mitsuba 0.6 would add a `sunsky`"));
        }
    }
}

fn point<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    props.exclusive("position", "to_world");
    let to_world = props.transform("to_world");
    let position = props.triple("position").unwrap_or_else(|| to_world.point([0.0; 3]));
    Some(EmitterKind::Point {
        position,
        intensity: reader.color(props, "intensity", ColorSlot::Emission, 1.0),
    })
}

fn spot<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let intensity = reader.color(props, "intensity", ColorSlot::Emission, 1.0);
    let cutoff_angle = props.positive("cutoff_angle", 20.0);
    let beam_width = props.float("beam_width", cutoff_angle * 0.75);
    if !(0.0..=cutoff_angle).contains(&beam_width) {
        props.complain(
            "beam_width",
            format!("`beam_width` must lie between 0 and {cutoff_angle}, the cutoff angle"),
        );
    }
    if cutoff_angle >= 180.0 {
        props.complain("cutoff_angle", "`cutoff_angle` must be below 180 degrees");
    }
    let texture = match props.entry("texture") {
        None => props.only_texture().map(|nested| nested.index),
        Some(entry) => match entry.value {
            Value::Object(index)
                if is_texture(&reader.objects[index]) || is_spectrum(&reader.objects[index]) =>
            {
                Some(index)
            }
            _ => props.wrong(entry, "a texture"),
        },
    };
    let texture = texture.and_then(|index| {
        if is_texture(&reader.objects[index]) {
            return reader.texture(index);
        }
        let text = "the `texture` of a spot must vary, as a bitmap does; a colour belongs into `intensity`";
        props.problems.push(Diagnostic::error(text, Some(reader.objects[index].span)));
        None
    });
    let to_world = props.transform("to_world");
    if !to_world.is_similarity() {
        let text = "`to_world` stretches the cone of the spot, as in Mitsuba 3";
        let place = props.entry("to_world").map(|entry| entry.name_span);
        props.problems.push(Diagnostic::warning(text, place));
    }
    Some(EmitterKind::Spot {
        to_world,
        intensity,
        cutoff_angle,
        beam_width,
        falloff: SpotFalloff::Linear,
        texture,
    })
}

fn directional<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    props.exclusive("direction", "to_world");
    let to_world = props.transform("to_world");
    let direction = props.triple("direction").unwrap_or_else(|| to_world.vector([0.0, 0.0, 1.0]));
    if direction == [0.0; 3] {
        props.complain("direction", "`direction` is zero");
    }
    // Mitsuba 2 and 3 light diffuse surfaces by the length of the direction that `to_world` gives.
    let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scaled = props.has("to_world") && (length - 1.0).abs() > 1e-3 && length.is_normal();
    let mut irradiance = reader.color(props, "irradiance", ColorSlot::Emission, 1.0);
    if scaled && reader.dialect != Dialect::Old {
        let text = format!(
            "`to_world` scales the light: Mitsuba multiplies what diffuse surfaces receive by {length:.4}"
        );
        let place = props.entry("to_world").map(|entry| entry.name_span);
        let help = "to change the light alone, change `irradiance`";
        props.problems.push(Diagnostic::warning(text, place).help(help));
        irradiance = times(irradiance, length);
    }
    Some(EmitterKind::Directional { direction, irradiance })
}

fn constant<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    props.ignore(&["to_world"]);
    Some(EmitterKind::Constant { radiance: reader.color(props, "radiance", ColorSlot::Emission, 1.0) })
}

fn envmap<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let path = reader.asset(props, "environment map");
    let encoding = gamma(props);
    let scale = props.float("scale", 1.0);
    // How Mitsuba samples and stores it.
    props.ignore(&["mis_compensation", "cache"]);
    let to_world = turned(props);
    Some(EmitterKind::Environment {
        to_world,
        image: LightImage { path: path?, encoding, scale, illuminance: None },
        mapping: EnvironmentMapping::LatLong,
    })
}

fn projector<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<EmitterKind> {
    let irradiance = reader.color_input(props, "irradiance", ColorSlot::Emission, 1.0);
    let fov = fov(props);
    let mut to_world = props.transform("to_world");
    let mut scale = props.float("scale", 1.0);
    // Mitsuba divides by the depth in the projector's own units, but multiplies by a cosine to an axis that keeps
    // its length: of the two, one factor of the axis' length is left.
    let axis = to_world.vector([0.0, 0.0, 1.0]);
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length.is_normal() && (length - 1.0).abs() > 1e-4 {
        to_world = to_world.after(&Transform::scale([1.0 / length; 3]));
        scale *= length;
        let text = format!("`to_world` scales the projector: Mitsuba multiplies its light by {length:.4}");
        let place = props.entry("to_world").map(|entry| entry.name_span);
        let help = "to change the light alone, use `scale`";
        props.problems.push(Diagnostic::warning(text, place).help(help));
    }
    Some(EmitterKind::Projector {
        to_world,
        irradiance,
        scale,
        fov,
        fov_axis: props.choice("fov_axis", FovAxis::X, AXES),
    })
}
