//! The scene's integrator → [`Settings`].

use caustica_formats::ir::{Scalar, Setting};

use super::Compiler;

use crate::math::kernel::KernelKind;
use crate::settings::{Count, Limit, Lookup, Mode, Neighbours, Radius, SettingError, Settings};

/// Names of Mitsuba's integrators and of ours → settings. The reader has checked names and types.
pub fn settings(b: &mut Compiler<'_>) -> Settings {
    let scene = b.ir;
    let mut s = Settings::default();
    if let Some(sensor) = scene.sensors.get(b.options.sensor.unwrap_or(scene.default_sensor)) {
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
            s.volume_photons = Count::Stored(250_000);
            s.neighbours = Neighbours(120);
            s.caustic_neighbours = Neighbours(120);
            s.volume_neighbours = 120;
            s.radius = Radius::Relative(0.05);
            s.caustic_radius = Radius::Relative(0.0125);
        }
        "sppm" | "ppm" => {
            s.rr_depth = 3;
            s.photons = Count::Paths(250_000);
            s.caustic_photons = Count::Paths(250_000);
            s.volume_photons = Count::Paths(250_000);
        }
        "direct" => s.max_depth = Limit(2),
        _ => {}
    }
    for (name, setting) in &integrator.settings {
        apply(b, &mut s, &integrator.plugin, name, setting);
    }
    s
}

/// Mitsuba's names and what they set here; `{}` is the value.
const ROWS: &[(&str, &[(&str, &str)])] = &[
    ("global_photons", &[("photons", "stored:{}")]),
    ("photon_count", &[("photons", "{}"), ("caustic_photons", "{}"), ("volume_photons", "{}")]),
    ("max_passes", &[("passes", "{}")]),
    ("samples", &[("passes", "{}")]),
    ("global_lookup_radius", &[("radius", "{}R")]),
    ("caustic_lookup_radius", &[("caustic_radius", "{}R")]),
    ("initial_radius", &[("radius", "{}"), ("caustic_radius", "{}")]),
    ("lookup_size", &[("neighbours", "{}"), ("caustic_neighbours", "{}")]),
    ("global_lookup_size", &[("neighbours", "{}")]),
    ("caustic_lookup_size", &[("caustic_neighbours", "{}")]),
    ("volume_lookup_size", &[("volume_neighbours", "{}")]),
];

/// Pairs of name and value by which Mitsuba asks for its own default.
const DEFAULTS: &[(&str, f64)] = &[("initial_radius", 0.0), ("max_passes", -1.0)];

/// Parameters of Mitsuba's integrators that have no counterpart in ours and do not change what the
/// picture converges to.
const WITHOUT_EFFECT: &[&str] = &[
    "direct_samples",
    "glossy_samples",
    "max_specular_depth",
    "granularity",
    "gather_locally",
    "auto_cancel_gathering",
    "timeout",
    "block_size",
    "samples_per_pass",
    "shading_samples",
    "emitter_samples",
    "bsdf_samples",
    "strict_normals",
    "use_spectral_mis",
];

fn apply(b: &mut Compiler<'_>, s: &mut Settings, plugin: &str, name: &str, setting: &Setting) {
    let text = match &setting.value {
        Scalar::Boolean(v) => v.to_string(),
        Scalar::Integer(v) => v.to_string(),
        Scalar::Float(v) => v.to_string(),
        Scalar::String(v) => v.clone(),
    };
    let default = DEFAULTS.iter().any(|(n, v)| *n == name && text.parse() == Ok(*v));
    if default || WITHOUT_EFFECT.contains(&name) {
        return;
    }
    // Mitsuba's photon mapper counts photons, not paths. Text is in our words.
    let number = !matches!(setting.value, Scalar::String(_));
    let stored = number && plugin == "photonmapper" && matches!(name, "caustic_photons" | "volume_photons");
    let own = [(name, if stored { "stored:{}" } else { "{}" })];
    let all = [("alpha", "{}"), ("caustic_alpha", "{}"), ("volume_alpha", "{}")];
    let targets = match ROWS.iter().find(|(n, _)| *n == name) {
        Some((_, targets)) => targets,
        // One α serves all maps in Mitsuba.
        None if name == "alpha" && number && plugin.ends_with("ppm") => &all[..],
        None => &own[..],
    };
    for (target, template) in targets {
        match s.set(target, &template.replace("{}", &text)) {
            Ok(()) => {}
            Err(SettingError::Unknown { .. }) => {
                b.warn(format!("integrator parameter `{name}` has no effect here"), setting.origin);
            }
            Err(e) => b.error(e.to_string(), setting.origin),
        }
    }
}
