//! The scene's integrator → [`Settings`].

use caustica_formats::ir::{self, Scalar};

use crate::photon::kernel::KernelKind;
use crate::settings::{Count, IntegratorKind, Limit, Lookup, Mode, Radius, Settings};

/// Names of Mitsuba's integrators and of ours → settings. The reader has checked names and types; a
/// value out of range keeps the default.
pub fn settings(scene: &ir::Scene) -> Settings {
    let mut s = Settings::default();
    if let Some(sensor) = scene.sensors.get(scene.default_sensor) {
        s.passes = sensor.sampler.sample_count.max(1);
        s.seed = sensor.sampler.seed;
    }
    let Some(integrator) = &scene.integrator else {
        return s;
    };
    match integrator.plugin.as_str() {
        "photonmapper" => {
            // The defaults of Mitsuba 0.6.
            s.mode = Mode::Classic;
            s.lookup = Lookup::Nearest;
            s.kernel = KernelKind::Biweight;
            s.caustic_kernel = KernelKind::Biweight;
            s.photons = Count::Stored(250_000);
            s.caustic_photons = Count::Stored(250_000);
            s.neighbours = 120;
            s.caustic_neighbours = 120;
            s.radius = Radius::Relative(0.05);
            s.caustic_radius = Radius::Relative(0.0125);
        }
        "sppm" | "ppm" => {
            s.rr_depth = 3;
            s.photons = Count::Paths(250_000);
            s.caustic_photons = Count::Paths(250_000);
        }
        "direct" => s.max_depth = Limit(2),
        _ => {}
    }
    for (name, setting) in &integrator.settings {
        apply(&mut s, name, &setting.value);
    }
    s
}

fn apply(s: &mut Settings, name: &str, value: &Scalar) {
    let text = match value {
        Scalar::Boolean(b) => b.to_string(),
        Scalar::Integer(i) => i.to_string(),
        Scalar::Float(f) => f.to_string(),
        Scalar::String(t) => t.clone(),
    };
    // Rows of Mitsuba 0.6 first, then names of our own, which are those of the settings' table.
    let rows: &[(&str, &[(&str, &str)])] = &[
        ("global_photons", &[("photons", "stored:{}")]),
        ("caustic_photons", &[("caustic_photons", "stored:{}")]),
        ("photon_count", &[("photons", "{}"), ("caustic_photons", "{}")]),
        ("max_passes", &[("passes", "{}")]),
        ("samples", &[("passes", "{}")]),
        ("global_lookup_radius", &[("radius", "{}R")]),
        ("caustic_lookup_radius", &[("caustic_radius", "{}R")]),
        ("initial_radius", &[("radius", "{}"), ("caustic_radius", "{}")]),
        ("lookup_size", &[("neighbours", "{}"), ("caustic_neighbours", "{}")]),
        ("global_lookup_size", &[("neighbours", "{}")]),
        ("caustic_lookup_size", &[("caustic_neighbours", "{}")]),
        ("alpha", &[("alpha", "{}"), ("caustic_alpha", "{}")]),
    ];
    let own = [(name, "{}")];
    let targets = rows.iter().find(|(n, _)| *n == name).map_or(&own[..], |(_, t)| *t);
    for (target, template) in targets {
        // −1 passes and radius 0 mean "default"; settings that are not ours (direct_samples, …) are noted
        // by the reader.
        let _ignored = s.set(target, &template.replace("{}", &text));
    }
    if s.integrator != IntegratorKind::PhotonMap && name != "integrator" {
        s.integrator = IntegratorKind::PhotonMap;
    }
}
