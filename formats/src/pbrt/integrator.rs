//! Integrators: pbrt's names and parameters as the settings of ours.

use std::collections::BTreeMap;

use super::params::Params;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ir::{Integrator, Origin, Scalar, Setting, has_passages};
use crate::plugin::{self, Plugin, read, unsupported};

type Settings = BTreeMap<String, Setting>;

/// Fills in settings and names the integrator.
type ReadIntegrator = fn(&mut Params, &mut Settings) -> &'static str;

const AS_PATH: &str = "as `path`";

/// Integrators of surfaces, and of media as well, by their names in both languages.
const PATH: &str = "path";
const VOLPATH: &str = "volpath";

pub(super) const INTEGRATORS: &[Plugin<ReadIntegrator>] = &[
    read("path", |_, _| PATH),
    read("volpath", |_, _| VOLPATH),
    read("simplepath", simple_path),
    plugin::approximated("simplevolpath", |p, _| approximated(p, VOLPATH), AS_PATH),
    plugin::approximated("lightpath", |p, _| approximated(p, PATH), AS_PATH),
    plugin::approximated("randomwalk", |p, _| approximated(p, PATH), AS_PATH),
    plugin::approximated("bdpt", bdpt, AS_PATH),
    plugin::approximated("mlt", mlt, AS_PATH),
    read("sppm", sppm),
    unsupported("ambientocclusion"),
    unsupported("function"),
];

/// What stands for unlimited depth: pbrt has no infinity, and no path survives this many bounces.
pub(super) const UNLIMITED: i64 = 1_000_000;

/// Most bounces where the file does not say.
const BOUNCES: u32 = 5;

impl Reader<'_> {
    /// The scene's integrator. A file that names none has pbrt's `volpath`, and its limit to the bounces.
    pub fn integrator(&mut self) {
        let Some(mut p) = self.head.integrator.take() else {
            let depth = Setting { origin: Origin(None), value: Scalar::Integer(i64::from(BOUNCES) + 1) };
            self.scene.integrator = Some(Integrator {
                origin: Origin(None),
                plugin: VOLPATH.to_owned(),
                settings: BTreeMap::from([("max_depth".to_owned(), depth)]),
                aovs: Vec::new(),
            });
            return;
        };
        let origin = p.origin();
        let mut settings = Settings::new();
        let Some(reader) = self.plugin(INTEGRATORS, &mut p, "photon mapping is used") else {
            return self.done(p);
        };
        let plugin = reader(&mut p, &mut settings);
        // pbrt counts bounces, we count the segments of a path.
        let bounces = i64::from(p.count("maxdepth", BOUNCES, 0));
        let depth = if bounces >= UNLIMITED { -1 } else { bounces + 1 };
        let place = Origin(Some(p.span_of("maxdepth")));
        settings.insert("max_depth".to_owned(), Setting { origin: place, value: Scalar::Integer(depth) });
        // pbrt shoots one photon a pixel where nothing else is asked for.
        if plugin == "sppm"
            && !settings.contains_key("photon_count")
            && let Some(film) = self.scene.sensors.last().map(|sensor| &sensor.film)
        {
            let value = Scalar::Integer(i64::from(film.width) * i64::from(film.height));
            settings.insert("photon_count".to_owned(), Setting { origin, value });
        }
        if p.boolean("regularize", false) {
            p.warn("regularize", "`regularize` is ignored: rough surfaces are unchanged");
        }
        p.ignore(&["lightsampler"]);
        self.done(p);
        self.scene.integrator =
            Some(Integrator { origin, plugin: plugin.to_owned(), settings, aovs: Vec::new() });
    }

    /// Once all is known: where there are no media, and no straight passages, which Mitsuba's `path` counts, pbrt's usual
    /// `volpath` is Mitsuba's usual `path`.
    pub fn check_integrator(&mut self) {
        let media = !self.scene.media.is_empty();
        let passages = has_passages(&self.scene);
        let Some(integrator) = &mut self.scene.integrator else { return };
        match integrator.plugin.as_str() {
            PATH | VOLPATH if !media => {
                integrator.plugin = if passages { VOLPATH } else { PATH }.to_owned();
            }
            plugin @ (PATH | "sppm") if media => {
                let text = format!("pbrt's `{plugin}` ignores media; they are rendered here");
                let warning = Diagnostic::warning(text, integrator.origin.0);
                self.problems.push(warning.help("with `volpath` the picture is the same in both"));
            }
            _ => {}
        }
    }
}

fn simple_path(p: &mut Params, _: &mut Settings) -> &'static str {
    // They change the noise, not the picture.
    p.ignore(&["samplelights", "samplebsdf"]);
    PATH
}

fn approximated(p: &mut Params, plugin: &'static str) -> &'static str {
    let text = format!("integrator `{}` is read as `path`", p.kind);
    p.problems.push(Diagnostic::warning(text, Some(p.span)));
    plugin
}

fn bdpt(p: &mut Params, _: &mut Settings) -> &'static str {
    p.ignore(&["visualizestrategies", "visualizeweights"]);
    approximated(p, VOLPATH)
}

fn mlt(p: &mut Params, _: &mut Settings) -> &'static str {
    p.ignore(&["bootstrapsamples", "chains", "mutationsperpixel", "largestepprobability", "sigma"]);
    approximated(p, VOLPATH)
}

/// Iterations are the sampler's samples a pixel.
fn sppm(p: &mut Params, settings: &mut Settings) -> &'static str {
    let origin = |p: &Params, name: &str| Origin(Some(p.span_of(name)));
    let radius = Setting { origin: origin(p, "radius"), value: Scalar::Float(p.positive("radius", 1.0)) };
    settings.insert("initial_radius".to_owned(), radius);
    if p.policy.is_three() {
        // By either name; the sampler has no say.
        let given = [p.optional_integer("iterations"), p.optional_integer("numiterations")];
        let count = given.into_iter().flatten().find(|count| *count > 0).unwrap_or(64);
        let place = if p.has("iterations") { "iterations" } else { "numiterations" };
        let value = Scalar::Integer(i64::from(count));
        settings.insert("max_passes".to_owned(), Setting { origin: origin(p, place), value });
    }
    if let Some(photons) = p.optional_integer("photonsperiteration").filter(|count| *count > 0) {
        let value = Scalar::Integer(i64::from(photons));
        settings
            .insert("photon_count".to_owned(), Setting { origin: origin(p, "photonsperiteration"), value });
    }
    p.ignore(&["seed"]);
    // Hachisuka and Jensen's γ, which is not a parameter in pbrt.
    let value = Scalar::Float(2.0 / 3.0);
    settings.insert("alpha".to_owned(), Setting { origin: p.origin(), value });
    "sppm"
}
