//! The integrator, where Mitsuba 3 has the one the scene asks for.

use super::Writer;
use super::element::{Element, number};
use crate::ir::{HideEmitters, Integrator, Scalar, Setting};

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

impl Writer<'_, '_> {
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

    pub fn integrator(&mut self, i: &Integrator) -> Element {
        let row = INTEGRATORS.iter().find(|(name, _)| *name == i.plugin);
        if row.is_none() {
            self.out.lose(i.origin, format!("the integrator `{}`", i.plugin), "`path`");
        }
        let (plugin, known) = row.unwrap_or(&INTEGRATORS[0]);
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
