//! The integrator, where Mitsuba 3 has the one the scene asks for.

use super::Writer;
use super::element::{Element, number};
use crate::ir::{Aov, AovKind, CoordinateSystem, Film, HideEmitters, Integrator, Scalar, Setting};

/// Integrators of Mitsuba 3 and their parameters.
const INTEGRATORS: &[(&str, &[&str])] = &[
    ("path", COMMON),
    ("volpath", COMMON),
    ("volpathmis", &["max_depth", "rr_depth", "hide_emitters", "timeout", "block_size", "use_spectral_mis"]),
    (
        "direct",
        &["shading_samples", "emitter_samples", "bsdf_samples", "hide_emitters", "timeout", "block_size"],
    ),
    ("ptracer", COMMON),
];

const COMMON: &[&str] = &["max_depth", "rr_depth", "hide_emitters", "timeout", "block_size"];

/// What of pbrt's `gbuffer` film Mitsuba's `aov` has.
const GBUFFER: &str = "Albedo:albedo,P:position,N:geo_normal,Ns:sh_normal,uv:uv";

impl Writer<'_, '_> {
    /// The scene's integrator, or `path`, which Mitsuba has to be told; within an `aov` where layers are asked for.
    pub fn integrator(&mut self, i: Option<&Integrator>) -> Element {
        let aovs = i.map_or(&[][..], |i| &i.aovs);
        let mut nested = match i {
            Some(i) => self.plain_integrator(i),
            None => Element::plugin("integrator", self.usual_integrator()),
        };
        let picture = aovs.iter().find(|aov| aov.kind == AovKind::Picture);
        if let Some(picture) = picture {
            nested = nested.with("name", &picture.name);
        }
        let scene = self.scene;
        let film = scene.sensors.get(scene.default_sensor).map(|sensor| &sensor.film);
        let mut pairs: Vec<String> = aovs.iter().filter_map(|aov| self.pair(aov)).collect();
        pairs.extend(film.and_then(|f| self.gbuffer(f)));
        if pairs.is_empty() && picture.is_none() {
            return nested;
        }
        Element::plugin("integrator", "aov").string("aovs", &pairs.join(",")).child(nested)
    }

    /// NAME:TYPE.
    fn pair(&mut self, aov: &Aov) -> Option<String> {
        let (kind, same) = aov.kind.mitsuba3()?;
        let parts = |c: char| matches!(c, ',' | ':') || c.is_whitespace();
        let name = aov.name.replace(parts, "_");
        if !same {
            let what = format!("layer `{}` of a 0.6 `field` integrator", aov.name);
            self.out.lose(aov.origin, what, format!("`{kind}`"));
        }
        if name != aov.name {
            self.out.lose(aov.origin, format!("the name of layer `{}`", aov.name), format!("`{name}`"));
        }
        Some(format!("{name}:{kind}"))
    }

    fn gbuffer(&mut self, film: &Film) -> Option<String> {
        let system = film.gbuffer?;
        let frame = match system {
            CoordinateSystem::Camera => "the coordinates of the camera, ",
            CoordinateSystem::World => "",
        };
        let what = format!("of the gbuffer film {frame}dzdx, dzdy, and the variances");
        self.out.lose(film.origin, what, "`aov` with its other channels, in the coordinates of the world");
        Some(GBUFFER.to_owned())
    }

    /// The value of a setting, within the range that Mitsuba accepts.
    fn accepted(&mut self, i: &Integrator, name: &str, setting: &Setting) -> Scalar {
        let Scalar::Integer(v) = setting.value else { return setting.value.clone() };
        // Samples of lamps or of materials may be 0, but not both.
        let none = |other: &str| i.settings.get(other).is_some_and(|s| s.value == Scalar::Integer(0));
        let only = name == "bsdf_samples" && none("emitter_samples");
        let least =
            LEAST.iter().find(|(known, _)| *known == name).map_or(i64::from(only), |(_, least)| *least);
        let largest = i64::from(i32::MAX);
        let accepted = match name {
            "max_depth" if v > largest => -1,
            _ => v.clamp(least, largest),
        };
        // No path is so deep.
        if accepted != v && (name, accepted) != ("max_depth", -1) || v < -1 {
            self.out.lose(
                setting.origin,
                format!("the setting {name} = {v}"),
                format!("{name} = {accepted}"),
            );
        }
        Scalar::Integer(accepted)
    }

    /// What renders all of the scene: Mitsuba's `path` looks through media.
    fn usual_integrator(&self) -> &'static str {
        if self.scene.media.is_empty() { "path" } else { "volpath" }
    }

    fn plain_integrator(&mut self, i: &Integrator) -> Element {
        let row = INTEGRATORS.iter().find(|(name, _)| *name == i.plugin);
        let usual = self.usual_integrator();
        if row.is_none() {
            self.out.lose(i.origin, format!("the integrator `{}`", i.plugin), format!("`{usual}`"));
        }
        let (plugin, known) = row.map_or((usual, COMMON), |(name, known)| (*name, *known));
        let mut element = Element::plugin("integrator", plugin);
        for (name, setting) in &i.settings {
            if !known.contains(&name.as_str()) {
                let what = format!("the setting {name} = {}", shown(&setting.value));
                self.out.lose(setting.origin, what, "the default of the renderer");
                continue;
            }
            if name == "hide_emitters"
                && setting.value == Scalar::Boolean(true)
                && self.scene.hide_emitters == HideEmitters::Emission
            {
                let what = "hide_emitters that hides the emission of lights but not their surfaces";
                self.out.lose(setting.origin, what, "hide_emitters that hides both");
            }
            let value = self.accepted(i, name, setting);
            element = match &value {
                Scalar::Boolean(v) => element.boolean(name, *v),
                Scalar::Integer(v) => element.integer(name, *v),
                Scalar::Float(v) => element.float(name, *v),
                Scalar::String(v) => element.string(name, v),
            };
        }
        element
    }
}

/// The least value of settings whose least value is not 0.
const LEAST: [(&str, i64); 3] = [("max_depth", -1), ("rr_depth", 1), ("shading_samples", 1)];

fn shown(value: &Scalar) -> String {
    match value {
        Scalar::Boolean(v) => v.to_string(),
        Scalar::Integer(v) => v.to_string(),
        Scalar::Float(v) => number(*v),
        Scalar::String(v) => v.clone(),
    }
}
