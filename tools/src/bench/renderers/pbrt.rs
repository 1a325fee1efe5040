//! pbrt-v4, which reads what `caustica convert` writes, with another size, filter and integrator.

use super::{Job, Made, Programs};
use crate::bench::error::BenchError;
use crate::bench::files;
use crate::bench::process::{self, Cost};
use crate::bench::record::fingerprint;
use std::path::Path;
use std::process::Command;

/// Renders with the `pbrt` on PATH. It does not report its loading time, which therefore comes from renders with one
/// and with two samples a pixel.
pub fn render(
    programs: &Programs,
    integrator: &str,
    parameters: &[(String, String)],
    job: &Job<'_>,
) -> Result<Made, BenchError> {
    let scene = programs.converted(job, "pbrt")?;
    let text = std::fs::read_to_string(&scene).map_err(files::at(&scene))?;
    let (bounces, note) = bounces(&text, integrator, programs.max_depth);
    let text = adapted(&text, job.size, integrator, parameters, bounces);
    let scene = scene.with_extension(format!("{integrator}.pbrt"));
    files::write(&scene, text.as_bytes())?;
    let run = |spp: u32, seed: u64| start(programs, &scene, spp, seed, job.image);
    let key = fingerprint([text.as_bytes()]);
    let known = programs.loads.borrow().get(&key).copied();
    let load = match known {
        Some(load) => load,
        None => {
            let (one, two) = (run(1, OTHER_SEED)?, run(2, OTHER_SEED)?);
            let load = Cost {
                seconds: before_samples(one.seconds, two.seconds),
                cpu_seconds: one.cpu_seconds.zip(two.cpu_seconds).map(|(one, two)| before_samples(one, two)),
                peak_memory_bytes: None,
            };
            programs.loads.borrow_mut().insert(key, load);
            load
        }
    };
    let all = run(job.passes, job.seed)?;
    let seconds = (all.seconds - load.seconds).max(0.0);
    let cpu_seconds = all.cpu_seconds.zip(load.cpu_seconds).map(|(all, load)| (all - load).max(0.0));
    Ok(Made {
        seconds,
        cpu_seconds: cpu_seconds.unwrap_or(seconds),
        peak_memory_bytes: all.peak_memory_bytes,
        passes: u64::from(job.passes),
        note,
    })
}

/// The seed of renders whose pictures do not count.
const OTHER_SEED: u64 = 1 << 20;

/// With loading time a and sample time b, one sample takes a + b and two take a + 2b.
fn before_samples(one: f64, two: f64) -> f64 {
    (2.0 * one - two).clamp(0.0, one)
}

/// Most bounces that pbrt is given.
const MOST_BOUNCES: u64 = 100;
/// The same for `bdpt`, which ends no path early and joins every vertex of a camera path with every one of a light
/// path.
const MOST_BOUNCES_BDPT: u64 = 20;

/// How many bounces paths have at most, and whether those are fewer than the scene or the command line asks for.
/// `max_depth` counts path segments, pbrt's `maxdepth` bounces.
fn bounces(text: &str, integrator: &str, max_depth: Option<i64>) -> (u64, Option<String>) {
    let statement = statements(text).into_iter().find(|statement| statement.starts_with("Integrator"));
    let own =
        statement.and_then(|statement| value(statement, "\"integer maxdepth\"")).and_then(|n| n.parse().ok());
    let asked = match max_depth {
        Some(n) if n < 0 => u64::MAX,
        Some(n) => n.unsigned_abs().saturating_sub(1),
        None => own.unwrap_or(5),
    };
    let (name, most) = match integrator {
        "bdpt" => ("pbrt's bdpt", MOST_BOUNCES_BDPT),
        _ => ("pbrt", MOST_BOUNCES),
    };
    let note = format!("{name} follows paths for {most} bounces at most, where longer ones are asked for");
    (asked.min(most), (asked > most).then_some(note))
}

fn start(programs: &Programs, scene: &Path, spp: u32, seed: u64, image: &Path) -> Result<Cost, BenchError> {
    let mut command = Command::new("pbrt");
    command.args(["--quiet", "--spp", &spp.to_string(), "--seed", &(seed as u32).to_string()]);
    if let Some(n) = programs.threads {
        command.args(["--nthreads", &n.to_string()]);
    }
    command.arg("--outfile").arg(image).arg(scene);
    process::run(&mut command, &programs.watch)
}

/// The scene with another film size, a box filter, 32-bit floats and an integrator. The command line sets the
/// seed.
fn adapted(
    text: &str,
    size: [usize; 2],
    integrator: &str,
    parameters: &[(String, String)],
    bounces: u64,
) -> String {
    let mut out = Vec::new();
    for statement in statements(text) {
        let directive = statement.split_whitespace().next().unwrap_or_default();
        match directive {
            "Integrator" => {
                let mut line = format!("Integrator \"{integrator}\" \"integer maxdepth\" {bounces}");
                for (key, value) in parameters {
                    let kind = if value.contains('.') { "float" } else { "integer" };
                    line += &format!(" \"{kind} {key}\" {value}");
                }
                out.push(line);
            }
            "Film" => {
                let mut line = statement.replace('\n', " ");
                for (name, n) in [("xresolution", size[0]), ("yresolution", size[1])] {
                    let key = format!("\"integer {name}\"");
                    if let Some(old) = value(&line, &key).map(str::to_owned) {
                        line = line.replace(&format!("{key} {old}"), &format!("{key} {n}"));
                    }
                }
                if !line.contains("savefp16") {
                    line += " \"bool savefp16\" false";
                }
                out.push(line);
            }
            "PixelFilter" => {
                out.push("PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5".to_owned())
            }
            "Sampler" => {
                let name = match statement.split('"').nth(1) {
                    // It would round the number of samples down to a power of two.
                    None | Some("zsobol") => "paddedsobol",
                    Some(name) => name,
                };
                out.push(format!("Sampler \"{name}\" \"integer pixelsamples\" 1"));
            }
            _ => out.push(statement.to_owned()),
        }
    }
    out.join("\n") + "\n"
}

/// Splits into statements: a line and the indented lines that continue it.
fn statements(text: &str) -> Vec<&str> {
    let mut starts: Vec<usize> = vec![0];
    let continues = |rest: &str| rest.starts_with([' ', '\t']);
    starts.extend(text.match_indices('\n').map(|(i, _)| i + 1).filter(|i| !continues(&text[*i..])));
    let ends = starts.iter().skip(1).copied().chain([text.len()]);
    starts.iter().zip(ends).map(|(a, b)| text[*a..b].trim_end()).collect()
}

/// The word after a key.
fn value<'a>(statement: &'a str, key: &str) -> Option<&'a str> {
    statement.split_once(key)?.1.split_whitespace().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_rendered_as_the_benchmark_asks() {
        let text = "# made\nIntegrator \"volpath\" \"integer maxdepth\" 7\nFilm \"rgb\"\n\t\"integer xresolution\" 512\n\t\
                    \"integer yresolution\" 512 \"string filename\" \"a.exr\"\nPixelFilter \"gaussian\"\nSampler \
                    \"independent\" \"integer pixelsamples\" 64 \"integer seed\" 3\n\nWorldBegin\nAttributeBegin\n\tShape \
                    \"sphere\"\nAttributeEnd\n";
        let parameters = [("radius".to_owned(), "0.05".to_owned())];
        let expected = "# made\nIntegrator \"sppm\" \"integer maxdepth\" 7 \"float radius\" 0.05\nFilm \"rgb\" \t\"integer \
                        xresolution\" 32 \t\"integer yresolution\" 24 \"string filename\" \"a.exr\" \"bool savefp16\" false\n\
                        PixelFilter \"box\" \"float xradius\" 0.5 \"float yradius\" 0.5\nSampler \"independent\" \"integer \
                        pixelsamples\" 1\n\nWorldBegin\nAttributeBegin\n\tShape \"sphere\"\nAttributeEnd\n\n";
        assert_eq!(adapted(text, [32, 24], "sppm", &parameters, bounces(text, "sppm", None).0), expected);
        assert_eq!(bounces(text, "sppm", None), (7, None));
        assert_eq!(bounces(text, "bdpt", Some(2)), (1, None));
        for (text, asked) in [(text, Some(-1)), ("Integrator \"path\" \"integer maxdepth\" 1000000\n", None)]
        {
            let (most, note) = bounces(text, "path", asked);
            assert_eq!(most, 100);
            assert!(note.is_some_and(|note| note.contains("100 bounces")));
            let (most, note) = bounces(text, "bdpt", asked);
            assert_eq!(most, 20);
            assert!(note.is_some_and(|note| note.contains("bdpt follows paths for 20 bounces")));
        }
        let sobol = adapted("Sampler \"zsobol\" \"integer pixelsamples\" 16\n", [8, 8], "sppm", &[], 5);
        assert_eq!(sobol, "Sampler \"paddedsobol\" \"integer pixelsamples\" 1\n\n");
        assert!((before_samples(1.5, 2.0) - 1.0).abs() < 1e-12);
        assert_eq!((before_samples(1.0, 3.0), before_samples(1.0, 0.9)), (0.0, 1.0));
    }
}
