//! caustica, as `caustica render` on the command line.

use super::{Job, Made, Programs, take_json};
use crate::bench::error::BenchError;
use crate::bench::process::{self, Cost};
use crate::bench::record::Budget;
use std::process::Command;

/// Renders with the given settings.
pub fn render(programs: &Programs, settings: &[(String, String)], job: &Job<'_>) -> Result<Made, BenchError> {
    let stats = job.image.with_extension("stats.json");
    let mut command = Command::new(&programs.caustica);
    command.arg("render").arg(job.scene).arg("-o").arg(job.image).arg("--stats").arg(&stats);
    command.args(["--quiet", "--layers", "none", "--filter", "box"]);
    command.args(["--size", &format!("{}x{}", job.size[0], job.size[1])]);
    command.args(["--seed", &job.seed.to_string()]);
    match job.budget {
        Budget::Seconds(s) => command.args(["--time", &s.to_string()]),
        Budget::Passes(n) => command.args(["--passes", &n.to_string()]),
    };
    if let Some(n) = programs.threads {
        command.args(["--threads", &n.to_string()]);
    }
    if let Some(n) = programs.max_depth {
        command.args(["--max-depth", &n.to_string()]);
    }
    for (key, value) in settings {
        command.args(["--set", &format!("{key}={value}")]);
    }
    let cost = process::run(&mut command, programs.limit)?;
    let value = take_json(&stats)?;
    let render = &value["render"];
    Ok(Made {
        seconds: render["seconds"].as_f64().unwrap_or(cost.seconds),
        cpu_seconds: without_loading(cost, value["load_seconds"].as_f64()),
        peak_memory_bytes: value["peak_memory_bytes"].as_u64(),
        passes: render["passes"].as_u64().unwrap_or(0),
        note: None,
    })
}

/// CPU seconds of the process without its loading, which uses one thread.
fn without_loading(cost: Cost, load_seconds: Option<f64>) -> f64 {
    (cost.cpu_seconds.unwrap_or(0.0) - load_seconds.unwrap_or(0.0)).max(0.0)
}
