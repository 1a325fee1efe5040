//! pbrt-v4, which reads what `caustica convert` writes, with another size, filter and integrator.

use super::{Job, Made, Programs};
use crate::bench::error::BenchError;
use crate::bench::files;
use crate::bench::process::{self, Cost};
use crate::bench::record::Budget;
use std::path::Path;
use std::process::Command;

/// Renders with the `pbrt` on PATH. It does not report its loading time, so a render with one sample is
/// measured too: the difference of both is the time of the other samples.
pub fn render(
    programs: &Programs,
    integrator: &str,
    parameters: &[(String, String)],
    job: &Job<'_>,
) -> Result<Made, BenchError> {
    let scene = programs.converted(job, "pbrt")?;
    let text = std::fs::read_to_string(&scene).map_err(files::at(&scene))?;
    let (bounces, note) = bounces(&text, programs.max_depth);
    let text = adapted(&text, job.size, integrator, parameters, bounces);
    let scene = scene.with_extension(format!("{integrator}.pbrt"));
    files::write(&scene, text.as_bytes())?;
    let run = |spp: u32, seed: u64| start(programs, &scene, spp, seed, job.image);
    let one = run(1, job.seed + (1 << 20))?;
    let spp = match job.budget {
        Budget::Passes(n) => n,
        Budget::Seconds(seconds) => {
            let (mut spp, mut taken) = (1, 0.0);
            while taken < 0.1 * seconds && spp < 1 << 16 {
                spp *= 2;
                taken = run(spp, job.seed + (1 << 20))?.seconds - one.seconds;
            }
            ((f64::from(spp - 1) * seconds / taken).round() as u32).max(1)
        }
    };
    let all = run(spp, job.seed)?;
    // With loading time a and sample time b, a + b and a + n·b are measured; n·b is wanted.
    let samples = |of: fn(&Cost) -> f64| match spp {
        0 | 1 => of(&all),
        n => ((of(&all) - of(&one)) * f64::from(n) / f64::from(n - 1)).max(0.0),
    };
    Ok(Made {
        seconds: samples(|c| c.seconds),
        cpu_seconds: samples(|c| c.cpu_seconds.unwrap_or(0.0)),
        peak_memory_bytes: all.peak_memory_bytes,
        passes: u64::from(spp),
        note,
    })
}

/// Most bounces that pbrt is given: its `bdpt` would allot memory for all of them, and never end.
const MOST_BOUNCES: u64 = 100;

/// How many bounces paths have at most, and whether those are fewer than the scene or the command line asks for.
/// `max_depth` counts path segments, pbrt's `maxdepth` bounces.
fn bounces(text: &str, max_depth: Option<i64>) -> (u64, Option<String>) {
    let integrator = statements(text).into_iter().find(|statement| statement.starts_with("Integrator"));
    let own = integrator
        .and_then(|statement| value(statement, "\"integer maxdepth\""))
        .and_then(|n| n.parse().ok());
    let asked = match max_depth {
        Some(n) if n < 0 => u64::MAX,
        Some(n) => n.unsigned_abs().saturating_sub(1),
        None => own.unwrap_or(5),
    };
    let note =
        format!("pbrt follows paths for {MOST_BOUNCES} bounces at most, where longer ones are asked for");
    (asked.min(MOST_BOUNCES), (asked > MOST_BOUNCES).then_some(note))
}

fn start(programs: &Programs, scene: &Path, spp: u32, seed: u64, image: &Path) -> Result<Cost, BenchError> {
    let mut command = Command::new("pbrt");
    command.args(["--quiet", "--spp", &spp.to_string(), "--seed", &(seed as u32).to_string()]);
    if let Some(n) = programs.threads {
        command.args(["--nthreads", &n.to_string()]);
    }
    command.arg("--outfile").arg(image).arg(scene);
    process::run(&mut command, programs.limit)
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
                let name = statement.split('"').nth(1).unwrap_or("zsobol");
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
        assert_eq!(adapted(text, [32, 24], "sppm", &parameters, bounces(text, None).0), expected);
        assert_eq!(bounces(text, None), (7, None));
        assert_eq!(bounces(text, Some(2)), (1, None));
        for (text, asked) in [(text, Some(-1)), ("Integrator \"path\" \"integer maxdepth\" 1000000\n", None)]
        {
            let (bounces, note) = bounces(text, asked);
            assert_eq!(bounces, 100);
            assert!(note.is_some_and(|note| note.contains("100 bounces")));
        }
    }
}
