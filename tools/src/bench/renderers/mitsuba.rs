//! Mitsuba 3, through its Python module.

use super::{Job, Made, Programs, python, take_json};
use crate::bench::error::BenchError;
use crate::bench::process;
use std::process::Command;

/// Renders with a variant and an integrator.
pub fn render(
    programs: &Programs,
    variant: &str,
    integrator: &str,
    job: &Job<'_>,
) -> Result<Made, BenchError> {
    let stats = job.image.with_extension("stats.json");
    let is_xml = job.scene.extension().is_some_and(|e| e.eq_ignore_ascii_case("xml"));
    let scene = if is_xml { job.scene.to_path_buf() } else { programs.converted(job, "xml")? };
    let order = serde_json::json!({
        "scene": scene, "variant": variant, "integrator": integrator, "size": job.size, "seed": job.seed,
        "spp": job.passes, "max_depth": programs.max_depth, "image": job.image, "stats": stats,
    });
    let mut command = Command::new(&programs.python.program);
    command.arg("-c").arg(python::SCRIPT).arg(order.to_string());
    if let Some(n) = programs.threads {
        command.env("MI_DEFAULT_THREADS", n.to_string());
    }
    process::run(&mut command, &programs.watch).map_err(|e| match e {
        // The command itself is a whole script.
        BenchError::Render { message, .. } => {
            BenchError::Render { command: format!("mitsuba {variant} {integrator}"), message }
        }
        BenchError::Stopped { seconds, .. } => {
            BenchError::Stopped { command: format!("mitsuba {variant} {integrator}"), seconds }
        }
        other => other,
    })?;
    let value = take_json(&stats)?;
    Ok(Made {
        seconds: value["seconds"].as_f64().unwrap_or(0.0),
        cpu_seconds: value["cpu_seconds"].as_f64().unwrap_or(0.0),
        peak_memory_bytes: value["peak_memory_bytes"].as_u64(),
        passes: value["passes"].as_u64().unwrap_or(0),
        note: None,
    })
}
