//! caustica, as `caustica render` on the command line.

use super::{Job, Made, Programs, take_json};
use crate::bench::error::BenchError;
use crate::bench::process;
use std::process::Command;

/// Renders with the given settings.
pub fn render(programs: &Programs, settings: &[(String, String)], job: &Job<'_>) -> Result<Made, BenchError> {
    let stats = job.image.with_extension("stats.json");
    let mut command = Command::new(&programs.caustica);
    command.arg("render").arg(job.scene).arg("-o").arg(job.image).arg("--stats").arg(&stats);
    command.args(["--quiet", "--layers", "none", "--filter", "box"]);
    command.args(["--size", &format!("{}x{}", job.size[0], job.size[1])]);
    command.args(["--seed", &job.seed.to_string()]);
    command.args(["--passes", &job.passes.to_string()]);
    if let Some(n) = programs.threads {
        command.args(["--threads", &n.to_string()]);
    }
    if let Some(n) = programs.max_depth {
        command.args(["--max-depth", &n.to_string()]);
    }
    for (key, value) in settings {
        command.args(["--set", &format!("{key}={value}")]);
    }
    let cost = process::run(&mut command, &programs.watch)?;
    let value = take_json(&stats)?;
    let render = &value["render"];
    let seconds = render["seconds"].as_f64().unwrap_or(cost.seconds);
    Ok(Made {
        seconds,
        cpu_seconds: value["render_cpu_seconds"].as_f64().unwrap_or(seconds),
        peak_memory_bytes: value["peak_memory_bytes"].as_u64(),
        passes: render["passes"].as_u64().unwrap_or(0),
        note: None,
    })
}
