//! What is said about a finished render: a table for people, JSON for machines.

use crate::render::{MOST_PASSES, Outcome, Stop};
use crate::session::Session;
use crate::session::units::{count, megabytes};

use super::report;

/// The table that `render` prints.
pub fn table(outcome: &Outcome, load_seconds: f64) -> String {
    let s = &outcome.statistics;
    let made = s.passes - s.resumed_passes;
    let passes = match s.resumed_passes {
        0 => format!("{made}"),
        resumed => format!("{} = {resumed} of the checkpoint + {made}", s.passes),
    };
    let mut rows = vec![
        ("passes", format!("{passes} in {:.2} s (loading {load_seconds:.2} s)", s.seconds)),
        ("rays", format!("{} ({}/s)", count(s.rays as f64), rate(s.rays, s.seconds))),
    ];
    if made == 0 {
        rows.truncate(1);
    }
    if s.light_paths > 0 {
        rows.extend(photon_rows(outcome));
    }
    let radii = [
        ("radius", s.first_radius, s.last_radius),
        ("caustic radius", s.first_caustic_radius, s.last_caustic_radius),
    ];
    // The last radius is known of a pass that was made here.
    let radii = radii.into_iter().filter(|(_, first, last)| *first > 0.0 && *last > 0.0);
    rows.extend(radii.map(|(name, first, last)| (name, format!("{first:.4e} to {last:.4e}"))));
    let memory =
        report::peak_memory().map_or_else(String::new, |m| format!("{} at the peak; ", megabytes(m)));
    rows.push((
        "memory",
        format!(
            "{memory}maps {}, film {}, scene {}",
            megabytes(s.map_bytes),
            megabytes(s.film_bytes),
            megabytes(s.scene_bytes)
        ),
    ));
    if s.passes > 1 {
        let error = 100.0 * outcome.pixels.relative_error(s.passes);
        let text = if error.is_finite() {
            format!("{error:.3} % of the mean")
        } else if outcome.pixels.mean_luminance(s.passes) > 0.0 {
            "not known of these passes alone".to_owned()
        } else {
            "none: all is black".to_owned()
        };
        rows.push(("standard error", text));
    }
    rows.push(("ended", ended(outcome).to_owned()));
    rows.iter().map(|(n, v)| format!("{n:<15} {v}")).collect::<Vec<_>>().join("\n")
}

fn rate(n: u64, seconds: f64) -> String {
    if seconds > 0.0 { count(n as f64 / seconds) } else { "0".to_owned() }
}

fn photon_rows(outcome: &Outcome) -> [(&'static str, String); 3] {
    let s = &outcome.statistics;
    let stored = count(s.photons_stored as f64);
    [
        ("photons", format!("{stored} stored ({}/s)", rate(s.photons_stored, s.seconds))),
        (
            "lookups",
            format!(
                "{} ({}/s of camera time), {:.1} photons each",
                count(s.lookups as f64),
                rate(s.lookups, s.camera_seconds),
                s.photons_gathered as f64 / s.lookups.max(1) as f64
            ),
        ),
        (
            "phases",
            format!(
                "prepare {:.2} s, photons {:.2} s, maps {:.2} s, camera {:.2} s",
                s.prepare_seconds, s.trace_seconds, s.build_seconds, s.camera_seconds
            ),
        ),
    ]
}

fn ended(outcome: &Outcome) -> &'static str {
    let s = &outcome.statistics;
    match outcome.stop {
        Stop::Passes if s.first_pass + s.passes >= MOST_PASSES => "it has all passes that a render can have",
        Stop::Passes => "all passes done",
        Stop::Time if s.first_pass_cut => {
            "time is up: the only pass has fewer light paths than asked for, and there is no checkpoint"
        }
        Stop::Time if s.passes == 0 => "time is up before the first pass was done",
        Stop::Time => "time is up",
        Stop::Error => "target error reached",
        Stop::Interrupted if s.passes == 0 => {
            "interrupted in the first pass: there is nothing to resume, and pixels of a new picture that it did not reach are black"
        }
        Stop::Interrupted => "interrupted; --resume goes on from the checkpoint",
    }
}

/// What was left out of the picture and why, and light that may be missing: one text a line.
pub fn warnings(outcome: &Outcome) -> Vec<String> {
    let s = &outcome.statistics;
    let left_out = s.rejected.causes().into_iter().filter(|(_, n)| *n > 0);
    let mut lines: Vec<String> =
        left_out.map(|(cause, n)| format!("warning: left out {n} {cause}")).collect();
    if s.light_paths > 0 && s.photons_stored == 0 {
        let paths = count(s.light_paths as f64);
        lines.push(format!(
            "warning: none of {paths} light paths stored a photon: unless nothing in the scene lights anything else, \
             indirect light is missing; compare with `--integrator path`"
        ));
    }
    lines
}

/// What the process took, beside the render's own seconds.
#[derive(Clone, Copy)]
pub struct Cost {
    pub load_seconds: f64,
    /// Processor time of all threads up to the end of loading; `None` where the system does not tell.
    load_cpu_seconds: Option<f64>,
    /// The same from there to the end of the last pass.
    render_cpu_seconds: Option<f64>,
}

impl Cost {
    /// From the wall and the processor time of loading, and the processor time at the end of the render.
    pub fn new((load_seconds, load_cpu_seconds): (f64, Option<f64>), rendered: Option<f64>) -> Self {
        let render_cpu_seconds = rendered.zip(load_cpu_seconds).map(|(all, load)| all - load);
        Self { load_seconds, load_cpu_seconds, render_cpu_seconds }
    }
}

/// The object that `--stats` writes.
pub fn json(session: &Session, outcome: &Outcome, cost: Cost) -> serde_json::Value {
    let error = outcome.pixels.relative_error(outcome.statistics.passes);
    serde_json::json!({
        "scene": session.path().display().to_string(),
        "scene_hash": session.hash(),
        "threads": rayon::current_num_threads(),
        "load_seconds": cost.load_seconds,
        "load_cpu_seconds": cost.load_cpu_seconds,
        "render_cpu_seconds": cost.render_cpu_seconds,
        "peak_memory_bytes": report::peak_memory(),
        "relative_standard_error": error.is_finite().then_some(error),
        "stop": outcome.stop,
        "render": outcome.statistics,
        "settings": session.settings.values().collect::<std::collections::BTreeMap<_, _>>(),
    })
}
