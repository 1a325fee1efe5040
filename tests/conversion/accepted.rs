//! What the target's own renderer refuses is not written: extreme scenes in both languages, converted to both, read
//! again by us, and loaded and rendered by Mitsuba where it is installed.

use std::path::Path;
use std::process::{Command, Stdio};

use super::extremes::sources;
use super::{Converted, mean_of};

/// Samples a pixel of Mitsuba's pictures, for each of four seeds.
const SAMPLES: u32 = 64;

/// Standard errors of the mean by which pictures that are equal may differ; the errors come from four pictures.
const SIGMAS: f64 = 6.0;

/// Arguments are scenes; a line for each, in their order: the mean for four seeds, or what Mitsuba says.
const SCRIPT: &str = r#"
import sys
try:
    import mitsuba as mi
    import numpy as np
except ImportError:
    sys.exit(77)
mi.set_variant('scalar_rgb')
mi.set_log_level(mi.LogLevel.Error)
for path in sys.argv[2:]:
    try:
        scene = mi.load_file(path)
        pictures = [np.array(mi.render(scene, spp=int(sys.argv[1]), seed=s))[..., :3] for s in range(4)]
        print('mean', *(repr(float(p.mean(dtype=float))) for p in pictures), flush=True)
    except Exception as error:
        print('refused', ' '.join(str(error).split())[-200:], flush=True)
"#;

#[test]
fn what_is_written_can_be_read_again() {
    let mut wrong = Vec::new();
    for (what, source) in sources() {
        for target in ["made.xml", "made.pbrt"] {
            let made = source.convert_to(target);
            if let Err(error) = made.open() {
                wrong.push(format!("{what}, {target}: {error}\n{}", made.text));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Means of Mitsuba's pictures, or what it says.
type Verdict = Result<[f64; 4], String>;

/// `None` without Mitsuba.
fn by_mitsuba(folder: &Path, made: &[Converted]) -> Option<Vec<Verdict>> {
    let paths: Vec<_> = (0..made.len()).map(|i| folder.join(i.to_string())).collect();
    for (scene, path) in made.iter().zip(&paths) {
        for (name, bytes) in &scene.files.0 {
            let file = path.join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, bytes).unwrap();
        }
    }
    let scenes = paths.iter().map(|path| path.join("made.xml"));
    let mut python = Command::new("python3");
    python.arg("-c").arg(SCRIPT).arg(SAMPLES.to_string()).args(scenes).stdin(Stdio::null());
    let run = python.output().ok().filter(|run| run.status.code() != Some(77))?;
    let said = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(run.status.success(), "{said}{}", String::from_utf8_lossy(&run.stderr));
    let verdict = |line: &str| match line.strip_prefix("mean ") {
        Some(means) => {
            let means: Vec<f64> = means.split(' ').map(|v| v.parse().unwrap()).collect();
            Ok(means.try_into().unwrap())
        }
        None => Err(line.to_owned()),
    };
    Some(said.lines().map(verdict).collect())
}

/// Where nothing is lost, the picture has the same mean within 1 % and noise.
#[test]
fn mitsuba_takes_all_that_is_written_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let sources = sources();
    let made: Vec<Converted> = sources.iter().map(|(_, source)| source.convert_to("made.xml")).collect();
    let Some(verdicts) = by_mitsuba(folder.path(), &made) else {
        println!("skipped: the module mitsuba of python3 is not installed");
        return;
    };
    assert_eq!(verdicts.len(), made.len());
    let mut wrong = Vec::new();
    for (((what, source), made), verdict) in sources.iter().zip(&made).zip(verdicts) {
        match verdict {
            Err(said) => wrong.push(format!("{what}: {said}\n{}", made.text)),
            Ok(means) if means.iter().any(|v| !v.is_finite()) => wrong.push(format!("{what}: {means:?}")),
            Ok(means) if made.losses.is_empty() => {
                let ours = [1, 2, 3, 4].map(|seed| mean_of(&source.picture(seed).pixel_values()));
                let middle = |values: [f64; 4]| values.iter().sum::<f64>() / 4.0;
                let error = |values: [f64; 4]| {
                    let squares: f64 = values.iter().map(|v| (v - middle(values)).powi(2)).sum();
                    (squares / 12.0).sqrt()
                };
                let (difference, noise) = (middle(means) - middle(ours), error(means).hypot(error(ours)));
                println!(
                    "{what}: {:+.2} % (noise {:.2} %)",
                    100.0 * difference / middle(ours),
                    100.0 * noise / middle(ours)
                );
                if difference.abs() > 0.01 * middle(ours) + SIGMAS * noise {
                    wrong.push(format!("{what}: {means:?} against {ours:?}\n{}", made.text));
                }
            }
            Ok(_) => println!("{what}: {:?}", made.losses.iter().map(|l| &l.what).collect::<Vec<_>>()),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// They became lamps of one side, with half of the light.
#[test]
fn lamps_of_two_sides_and_powers_are_not_lost() {
    for (what, source) in sources() {
        if what.contains("two sides") || what.contains("power") {
            let made = source.convert_to("made.xml");
            assert!(made.losses.is_empty(), "{what}: {:?}", made.losses);
        }
    }
}

/// Colours above 1 in a texture, maps over a mix, and numbers beyond 32 bits.
#[test]
fn pbrt_gets_what_it_accepts() {
    for (what, source) in sources() {
        let text = source.convert_to("made.pbrt").text;
        let materials = text.split("MakeNamedMaterial").skip(1).map(|m| m.split("\n\n").next().unwrap_or(m));
        for material in materials.map(|m| m.lines().next().unwrap_or_default()) {
            let mix = material.contains("\"mix\"") || material.contains("\"interface\"");
            let relief = material.contains("displacement") || material.contains("normalmap");
            assert!(!(mix && relief), "{what}: {text}");
        }
        for number in text.split_whitespace().filter_map(|word| word.parse::<i64>().ok()) {
            assert!(i32::try_from(number).is_ok(), "{what}: {number}\n{text}");
        }
        for colors in text.split("\"rgb ").skip(1) {
            let inside = colors.split(['[', ']']).nth(1).unwrap_or_default();
            assert!(!inside.contains('-') || inside.contains('e'), "{what}: {inside}");
        }
    }
}
