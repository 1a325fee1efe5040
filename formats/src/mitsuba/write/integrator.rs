//! The integrator, where Mitsuba 3 has the one the scene asks for.

use super::Writer;
use super::element::{Element, number};
use crate::ir::{HideEmitters, Integrator, Scalar};

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
                let what = "hide_emitters that hides the light of lamps but not their surfaces";
                self.out.lose(setting.origin, what, "hide_emitters that hides both");
            }
            element = match &setting.value {
                Scalar::Boolean(v) => element.boolean(name, *v),
                Scalar::Integer(v) => element.integer(name, *v),
                Scalar::Float(v) => element.float(name, *v),
                Scalar::String(v) => element.string(name, v),
            };
        }
        element
    }
}

fn shown(value: &Scalar) -> String {
    match value {
        Scalar::Boolean(v) => v.to_string(),
        Scalar::Integer(v) => v.to_string(),
        Scalar::Float(v) => number(*v),
        Scalar::String(v) => v.clone(),
    }
}
