//! `caustica render`.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::limits;
use super::load::{Loaded, SceneArgs, stem};
use super::lock::Lock;
use super::output::{self, KNOWN_LAYERS, Output, wants_alpha};
use super::report::{self, count, megabytes};
use super::resume::{self, Saver};
use crate::film::Pixels;
use crate::render::{Budget, Outcome, Progress, Statistics, Stop, render};
use crate::settings::SETTINGS;

#[derive(Debug, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Picture to write: .exr, .png, .hdr or .pfm [default: SCENE.exr here]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Also write a PNG [default name: that of the output]
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    png: Option<Option<PathBuf>>,
    /// Stops of exposure for the PNG
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_hyphen_values = true, value_parser = stops)]
    exposure: f64,
    /// Store 16-bit floats
    #[arg(long)]
    half: bool,
    /// Layers of the EXR: emission, direct, caustic, indirect, variance, samples, all or none
    #[arg(long, value_name = "LIST", default_value = "emission,direct,caustic,indirect")]
    layers: String,
    /// End after this many seconds of rendering
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    time: Option<Duration>,
    /// End when the standard error of the picture relative to its mean is this small
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    target_error: Option<f64>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MAX_THREADS), allow_negative_numbers = true)]
    threads: Option<u32>,
    /// Save the state of the render here after every pass
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Go on from the checkpoint [default checkpoint: OUTPUT.checkpoint]
    #[arg(long)]
    resume: bool,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// List the settings of --set with types and defaults
    #[arg(long)]
    help_settings: bool,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
    /// Print the plan and more statistics
    #[arg(short, long)]
    verbose: bool,
}

/// More would only wait for each other, and every one takes memory before the first ray.
const MAX_THREADS: i64 = 1024;

fn stops(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|e: &f64| e.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

fn error(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|e: &f64| *e > 0.0 && e.is_finite())
        .ok_or_else(|| "expected a positive number, such as 0.01".to_owned())
}

fn seconds(text: &str) -> Result<Duration, String> {
    text.parse()
        .ok()
        .filter(|s: &f64| *s > 0.0)
        .and_then(|s| Duration::try_from_secs_f64(s).ok())
        .ok_or_else(|| "expected a positive number of seconds".to_owned())
}

pub fn run(args: &RenderArgs, interrupt: &Interrupt) -> Result<u8, Failure> {
    if args.help_settings {
        return Ok(help_settings()?);
    }
    if let Some(n) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(n as usize).build_global().map_err(|e| e.to_string())?;
    }
    let started = Instant::now();
    let loaded = args.scene.load(args.quiet)?;
    let load_seconds = started.elapsed().as_secs_f64();
    limits::check(&loaded)?;
    let output = args.output(&loaded).map_err(Failure::Usage)?;
    output.check()?;
    let mut saver = Saver::new(args.checkpoint_path(&output), &loaded);
    let saving = args.checkpoint.is_some() || args.resume;
    let written = args.stats.iter().chain(saving.then_some(&saver.path));
    written.clone().try_for_each(|file| output::check_place(file))?;
    let every: Vec<&Path> = output.files.iter().chain(written).map(PathBuf::as_path).collect();
    output::check_distinct(&every, &loaded.inputs)?;
    let _locks: Vec<_> = output
        .files
        .iter()
        .chain(saving.then_some(&saver.path))
        .map(|file| Lock::take(file))
        .collect::<Result<_, _>>()?;
    let saved = if args.resume { saver.resume()? } else { None };
    let (pixels, done) = saved.unwrap_or_else(|| (Pixels::new(loaded.view.film.pixel_count()), 0));
    let asked = args.scene.spp.or(args.scene.passes);
    if let Some(asked) = asked.filter(|asked| *asked < done && !args.quiet) {
        report::line(&format!("warning: the checkpoint holds {done} passes; {asked} were asked for"));
    }
    if args.verbose {
        report::line(&loaded.plan.to_string());
    }
    if loaded.scene.emitters.is_empty() && !args.quiet {
        let scene = loaded.path.display();
        report::line(&format!("warning: {scene}: the scene has no light; the picture will be black"));
    }

    interrupt.watch();
    let limited = args.time.is_some() || args.target_error.is_some();
    let budget = Budget {
        // A time or an error ends the render, unless a number of passes was asked for as well.
        passes: (!limited || asked.is_some()).then_some(loaded.settings.passes),
        time: args.time,
        error: args.target_error,
        interrupt: Some(interrupt.flag()),
    };
    let bar = args.progress_bar(&budget);
    let mut on_pass = |p: &Progress<'_>| {
        show(&bar, p, &budget);
        if saving {
            saver.after_pass(p.pixels, p.passes);
        }
    };
    let outcome = render(loaded.task(), budget, pixels, done, &mut on_pass);
    bar.finish_and_clear();
    let passes = outcome.statistics.passes;
    // A picture from before is worth more than a part of the first pass.
    let kept = passes == 0 && output.files.iter().any(|file| file.exists());
    // The picture first: it is what nobody wants to lose.
    let picture = if kept {
        Ok(())
    } else {
        output.write(&loaded, &outcome.pixels, passes, &radii(&outcome.statistics))
    };
    for file in output.files.iter().filter(|_| kept) {
        report::line(&format!("interrupted in the first pass: nothing was written to {}", file.display()));
    }
    let whole = passes > 0 && !outcome.statistics.first_pass_cut;
    if whole && (saving || outcome.stop == Stop::Interrupted) {
        let saved = saver.save(&outcome.pixels, passes, true);
        if let (Err(_), Err(problem)) = (&picture, &saved) {
            report::error(problem);
        }
        picture.and(saved)?;
    } else {
        picture?;
    }
    let written = if kept { &[] } else { &*output.files };
    args.summary(&loaded, written, &outcome, load_seconds)?;
    Ok(if outcome.stop == Stop::Interrupted { interrupt.status() } else { 0 })
}

impl RenderArgs {
    fn output(&self, loaded: &Loaded) -> Result<Output, String> {
        let main =
            self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.exr", stem(&loaded.path))));
        let mut files = vec![main.clone()];
        match &self.png {
            Some(Some(file)) => files.push(file.clone()),
            Some(None) => files.push(main.with_extension("png")),
            None => {}
        }
        files.dedup_by_key(|file| output::real(file));
        let mut layers = Vec::new();
        for name in self.layers.split(',').map(str::trim).filter(|n| !n.is_empty()) {
            match name {
                "none" => {}
                "all" => layers.extend(KNOWN_LAYERS.map(str::to_owned)),
                known if KNOWN_LAYERS.contains(&known) => layers.push(known.to_owned()),
                other => {
                    return Err(format!(
                        "there is no layer `{other}`; there are {}",
                        KNOWN_LAYERS.join(", ")
                    ));
                }
            }
        }
        layers.dedup();
        let tonemap = loaded.film.tonemap;
        Ok(Output {
            files,
            layers,
            half: self.half,
            exposure: self.exposure + tonemap.map_or(0.0, |t| t.exposure),
            gamma: tonemap.and_then(|t| t.gamma),
            alpha: wants_alpha(&loaded.film),
        })
    }

    fn checkpoint_path(&self, output: &Output) -> PathBuf {
        self.checkpoint.clone().unwrap_or_else(|| resume::default_path(&output.files[0]))
    }

    fn progress_bar(&self, budget: &Budget<'_>) -> ProgressBar {
        if self.quiet {
            return ProgressBar::hidden();
        }
        let length = match (budget.passes, budget.time) {
            (Some(n), None) => u64::from(n),
            (_, Some(t)) => t.as_millis() as u64,
            (None, None) => 0,
        };
        let bar = ProgressBar::new(length);
        // The template is a constant of ours.
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} % {msg} [{elapsed} < {eta}]") {
            bar.set_style(style);
        }
        bar
    }

    fn summary(
        &self,
        loaded: &Loaded,
        written: &[PathBuf],
        outcome: &Outcome,
        load_seconds: f64,
    ) -> Result<(), String> {
        let s = &outcome.statistics;
        if let Some(path) = &self.stats {
            let value = serde_json::json!({
                "scene": loaded.path.display().to_string(),
                "scene_hash": loaded.hash,
                "threads": rayon::current_num_threads(),
                "load_seconds": load_seconds,
                "peak_memory_bytes": report::peak_memory(),
                "relative_standard_error": finite(outcome.pixels.relative_error(s.passes)),
                "stop": outcome.stop,
                "render": s,
                "settings": loaded.settings.values().collect::<std::collections::BTreeMap<_, _>>(),
            });
            let text = serde_json::to_string_pretty(&value).map_err(|e| e.to_string())?;
            caustica_formats::image::atomic_write(path, text.as_bytes())
                .map_err(|e| format!("cannot write `{}`: {e}", path.display()))?;
        }
        for (cause, n) in s.rejected.causes().into_iter().filter(|(_, n)| *n > 0) {
            report::line(&format!("warning: left out {n} {cause}"));
        }
        if s.light_paths > 0 && s.photons_stored == 0 {
            let paths = count(s.light_paths as f64);
            report::line(&format!(
                "warning: none of {paths} light paths left a photon: what lamps do not light directly is missing, \
                 if there is any (--integrator path tells)"
            ));
        }
        if !self.quiet {
            report::line(&self.table(outcome, load_seconds));
            for file in written {
                report::line(&format!("wrote {}", file.display()));
            }
        }
        Ok(())
    }

    fn table(&self, outcome: &Outcome, load_seconds: f64) -> String {
        let s = &outcome.statistics;
        let per =
            |n: u64, seconds: f64| if seconds > 0.0 { count(n as f64 / seconds) } else { "0".to_owned() };
        let mut rows = vec![
            ("passes", format!("{} in {:.2} s (loading {load_seconds:.2} s)", s.passes, s.seconds)),
            ("rays", format!("{} ({}/s)", count(s.rays as f64), per(s.rays, s.seconds))),
        ];
        if s.light_paths > 0 {
            rows.push((
                "photons",
                format!("{} stored ({}/s)", count(s.photons_stored as f64), per(s.photons_stored, s.seconds)),
            ));
            rows.push((
                "lookups",
                format!(
                    "{} ({}/s of camera time), {:.1} photons each",
                    count(s.lookups as f64),
                    per(s.lookups, s.camera_seconds),
                    s.photons_gathered as f64 / s.lookups.max(1) as f64
                ),
            ));
            rows.push((
                "phases",
                format!(
                    "prepare {:.2} s, photons {:.2} s, maps {:.2} s, camera {:.2} s",
                    s.prepare_seconds, s.trace_seconds, s.build_seconds, s.camera_seconds
                ),
            ));
        }
        if s.first_radius > 0.0 {
            rows.push(("radius", format!("{:.4e} to {:.4e}", s.first_radius, s.last_radius)));
        }
        if s.first_caustic_radius > 0.0 {
            rows.push((
                "caustic radius",
                format!("{:.4e} to {:.4e}", s.first_caustic_radius, s.last_caustic_radius),
            ));
        }
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
            rows.push((
                "standard error",
                format!("{:.3} % of the mean", 100.0 * outcome.pixels.relative_error(s.passes)),
            ));
        }
        let ended = match outcome.stop {
            Stop::Passes => "all passes done",
            Stop::Time if s.first_pass_cut => {
                "time is up: the only pass has fewer light paths than asked for, and no checkpoint"
            }
            Stop::Time => "time is up",
            Stop::Error => "target error reached",
            Stop::Interrupted if s.passes == 0 => {
                "interrupted in the first pass, from which nothing can go on; black is what it did not reach"
            }
            Stop::Interrupted => "interrupted; --resume goes on from the checkpoint",
        };
        rows.push(("ended", ended.to_owned()));
        rows.iter().map(|(n, v)| format!("{n:<15} {v}")).collect::<Vec<_>>().join("\n")
    }
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn help_settings() -> Result<u8, String> {
    let defaults = crate::settings::Settings::default();
    let rows: Vec<String> = SETTINGS
        .iter()
        .zip(defaults.values())
        .map(|(row, (_, default))| format!("{:<20} {} [{}; default {default}]", row.name, row.doc, row.wants))
        .collect();
    let kernels: Vec<&str> = crate::math::kernel::KernelKind::ALL.iter().map(|k| k.name()).collect();
    report::data(&format!("{}\n\nkernels: {}", rows.join("\n"), kernels.join(", ")))?;
    Ok(0)
}

fn show(bar: &ProgressBar, p: &Progress<'_>, budget: &Budget<'_>) {
    if bar.is_hidden() {
        return;
    }
    match budget.time {
        Some(_) => bar.set_position(p.elapsed.as_millis() as u64),
        None => bar.set_position(u64::from(p.passes)),
    }
    // The error estimate reads every pixel: show it at powers of two.
    if p.passes.is_power_of_two() && p.passes > 1 {
        bar.set_message(format!(
            "pass {}, error {:.2} %",
            p.passes,
            100.0 * p.pixels.relative_error(p.passes)
        ));
    }
}

fn radii(s: &Statistics) -> Vec<(String, String)> {
    [("firstRadius", s.first_radius), ("firstCausticRadius", s.first_caustic_radius)]
        .into_iter()
        .filter(|(_, r)| *r > 0.0)
        .map(|(n, r)| (n.to_owned(), r.to_string()))
        .collect()
}
