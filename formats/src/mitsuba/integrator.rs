//! Integrators: the one a scene asks for, and its settings.

use std::collections::BTreeMap;

use super::object::{ObjectIndex, Value};
use super::props::Props;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Severity, Span};
use crate::ir::{INTEGRATOR_SETTINGS, Integrator, Scalar, ScalarType, Setting};
use crate::plugin::{Plugin, approximated, read, unsupported};

use ScalarType::{Boolean, Float, Integer, String as Text};

type Settings = &'static [(&'static str, ScalarType)];

#[derive(Clone, Copy)]
pub(super) enum Rendering {
    /// Rendered as asked, with these settings beside the common ones.
    Own(Settings),
    /// Rendered by `path`; its own settings do not matter.
    Approximated,
    /// Wraps the integrator that is rendered.
    Wrapper,
    /// A picture of the surfaces in sight: a layer.
    Surface,
}

const AS_PATH: &str = "as `path`";

const A_LAYER: &str = "as a layer of the picture";

pub(super) const INTEGRATORS: &[Plugin<Rendering>] = &[
    read("path", Rendering::Own(INTEGRATOR_SETTINGS)),
    read("direct", Rendering::Own(DIRECT)),
    read("volpath", Rendering::Own(&[])),
    read("volpathmis", Rendering::Own(&[("use_spectral_mis", Boolean)])),
    read("ptracer", Rendering::Own(&[("granularity", Integer), ("brute_force", Boolean)])),
    read("photonmapper", Rendering::Own(PHOTON_MAPPER)),
    read("ppm", Rendering::Own(PROGRESSIVE)),
    read("sppm", Rendering::Own(PROGRESSIVE)),
    approximated("volpath_simple", Rendering::Approximated, AS_PATH),
    approximated("bdpt", Rendering::Approximated, AS_PATH),
    approximated("vpl", Rendering::Approximated, AS_PATH),
    approximated("pssmlt", Rendering::Approximated, AS_PATH),
    approximated("mlt", Rendering::Approximated, AS_PATH),
    approximated("erpt", Rendering::Approximated, AS_PATH),
    approximated("prb", Rendering::Approximated, AS_PATH),
    approximated("prb_basic", Rendering::Approximated, AS_PATH),
    approximated("prbvolpath", Rendering::Approximated, AS_PATH),
    approximated("prb_projective", Rendering::Approximated, AS_PATH),
    approximated("prb_reparam", Rendering::Approximated, AS_PATH),
    approximated("moment", Rendering::Wrapper, "the picture alone"),
    read("aov", Rendering::Wrapper),
    read("multichannel", Rendering::Wrapper),
    approximated("depth", Rendering::Surface, A_LAYER),
    approximated("field", Rendering::Surface, A_LAYER),
    approximated("stokes", Rendering::Wrapper, "the picture alone"),
    approximated("irrcache", Rendering::Wrapper, "as what it wraps"),
    approximated("adaptive", Rendering::Wrapper, "as what it wraps"),
    unsupported("ao"),
    unsupported("motion"),
    unsupported("direct_projective"),
    unsupported("direct_reparam"),
    unsupported("emission_reparam"),
    unsupported("volprim_rf_basic"),
];

/// Those that look through media in Mitsuba.
const IN_VACUUM: &[&str] = &["path", "direct", "ptracer"];

/// Every integrator may have these.
const COMMON: Settings = &[
    ("max_depth", Integer),
    ("rr_depth", Integer),
    ("hide_emitters", Boolean),
    ("timeout", Float),
    ("block_size", Integer),
    ("samples_per_pass", Integer),
];

const DIRECT: Settings =
    &[("shading_samples", Integer), ("emitter_samples", Integer), ("bsdf_samples", Integer)];

const PHOTON_MAPPER: Settings = &[
    ("direct_samples", Integer),
    ("glossy_samples", Integer),
    ("max_specular_depth", Integer),
    ("global_photons", Integer),
    ("caustic_photons", Integer),
    ("volume_photons", Integer),
    ("global_lookup_radius", Float),
    ("caustic_lookup_radius", Float),
    ("lookup_size", Integer),
    ("global_lookup_size", Integer),
    ("caustic_lookup_size", Integer),
    ("volume_lookup_size", Integer),
    ("granularity", Integer),
    ("gather_locally", Boolean),
    ("auto_cancel_gathering", Boolean),
];

const PROGRESSIVE: Settings = &[
    ("initial_radius", Float),
    ("alpha", Float),
    ("photon_count", Integer),
    ("max_passes", Integer),
    ("granularity", Integer),
    ("auto_cancel_gathering", Boolean),
];

impl<'a> Reader<'a> {
    /// Chooses among the scene's integrators; all are read.
    pub fn integrators(&mut self, all: &[(ObjectIndex, Span)]) {
        for (i, (index, span)) in all.iter().enumerate() {
            if i > 0 {
                let text = "a scene may have only one integrator; this is a second one";
                let problem =
                    Diagnostic::new(self.strict(), text, Some(*span)).label(all[0].1, "the first one");
                self.problems.push(problem);
            }
            self.scene.integrator = self.integrator(*index).or_else(|| self.scene.integrator.take());
        }
    }

    pub fn integrator(&mut self, index: ObjectIndex) -> Option<Integrator> {
        let object = &self.objects[index];
        if object.plugin.is_empty() {
            return None;
        }
        let mut props = self.props(index);
        let integrator = match self.plugin(INTEGRATORS, index, "photon mapping renders the scene") {
            Some(Rendering::Own(own)) => {
                let settings = self.settings(&mut props, own);
                if IN_VACUUM.contains(&object.plugin.as_str()) && !self.scene.media.is_empty() {
                    let text = format!("Mitsuba's `{}` ignores media; they are rendered here", object.plugin);
                    let help = "with `volpath` the picture is the same in both";
                    self.problems.push(Diagnostic::warning(text, Some(object.span)).help(help));
                }
                let integrator = Integrator {
                    origin: props.origin(),
                    plugin: object.plugin.clone(),
                    settings,
                    aovs: Vec::new(),
                };
                self.finish(props);
                integrator
            }
            Some(Rendering::Approximated) => {
                let text = format!("integrator `{}` is read as `path`", object.plugin);
                self.problems.push(Diagnostic::warning(text, Some(object.span)));
                self.as_path(props)
            }
            Some(Rendering::Wrapper | Rendering::Surface) => return self.wrapped(props),
            None => self.as_path(props),
        };
        Some(integrator)
    }

    /// `path`, or with media `volpath`, with the settings every integrator has; the others are dropped.
    pub fn as_path(&mut self, mut props: Props<'a>) -> Integrator {
        let mut settings = BTreeMap::new();
        for (name, kind) in &COMMON[..3] {
            let fits = props.object.entries.iter().any(|e| {
                e.name.as_deref() == Some(name)
                    && matches!((&e.value, kind), (Value::Integer(_), Integer) | (Value::Boolean(_), Boolean))
            });
            if fits {
                read_setting(&mut props, name, *kind, &mut settings);
            }
        }
        props.ignore_rest();
        let origin = props.origin();
        self.finish(props);
        let plugin = if self.scene.media.is_empty() { "path" } else { "volpath" };
        Integrator { origin, plugin: plugin.to_owned(), settings, aovs: Vec::new() }
    }

    fn settings(&mut self, props: &mut Props<'a>, own: Settings) -> BTreeMap<String, Setting> {
        let mut settings = BTreeMap::new();
        let ours = matches!(props.object.plugin.as_str(), "path" | "photonmapper" | "ppm" | "sppm");
        let extra: Settings = if ours { INTEGRATOR_SETTINGS } else { &[] };
        for (name, kind) in COMMON.iter().chain(own).chain(extra) {
            if !settings.contains_key(*name) {
                // "auto", "0.05R" and "stored:1000" are neither integers nor floats.
                let as_text = extra.iter().any(|(own, _)| own == name)
                    && props.entry(name).is_some_and(|e| matches!(e.value, Value::String(_)));
                read_setting(props, name, if as_text { Text } else { *kind }, &mut settings);
            }
        }
        if let Some(entry) = props.entry("strict_normals")
            && matches!(entry.value, Value::Boolean(true))
        {
            let text = "`strict_normals` is ignored; Mitsuba 3 does not have it either";
            props.problems.push(Diagnostic::new(Severity::Note, text, Some(entry.name_span)));
        }
        settings
    }
}

fn read_setting(
    props: &mut Props<'_>,
    name: &'static str,
    kind: ScalarType,
    settings: &mut BTreeMap<String, Setting>,
) {
    let span = props.object.entries.iter().find(|e| e.name.as_deref() == Some(name)).map(|e| e.span);
    let value = match kind {
        Boolean => match props.entry(name).map(|e| (&e.value, e)) {
            None => None,
            Some((Value::Boolean(v), _)) => Some(Scalar::Boolean(*v)),
            Some((_, entry)) => props.wrong(entry, "a boolean"),
        },
        Integer => props.optional_integer(name).map(Scalar::Integer),
        Float => props.optional_float(name).map(Scalar::Float),
        Text => props.optional_string(name).map(|(text, _)| Scalar::String(text.to_owned())),
    };
    if let Some(value) = value {
        settings.insert(name.to_owned(), Setting { origin: crate::ir::Origin(span), value });
    }
}
