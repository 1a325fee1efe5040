//! `caustica render`.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::picture::PictureArgs;
use super::scene::SceneArgs;
use super::summary::Cost;
use super::threads::ThreadArgs;
use super::view::ViewArgs;
use super::{report, summary};
use crate::math::kernel::KernelKind;
use crate::render::MOST_PASSES;
use crate::serve::View;
use crate::session::{Budget, Outcome, Output, Progress, Saver, Session, Stop, Sums};
use crate::settings::{SETTINGS, Settings};

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    picture: PictureArgs,
    /// End after this many seconds of rendering; what is prepared before the first pass is prepared in full
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    time: Option<Duration>,
    /// End when the standard error of the picture relative to its mean is this small
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    target_error: Option<f64>,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Save the state of the render here after every pass
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
    /// Render the passes A to B - 1 only, counted from 0, for `caustica merge`; a picture of them is written with -o
    #[arg(long, value_name = "A..B", value_parser = range, requires = "checkpoint", conflicts_with = "target_error")]
    pass_range: Option<Range<u32>>,
    /// Go on from the checkpoint [default checkpoint: OUTPUT.checkpoint]
    #[arg(long)]
    resume: bool,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    #[command(flatten)]
    view: ViewArgs,
    /// List the settings of --set with types and defaults
    #[arg(long)]
    help_settings: bool,
    /// Print only errors, and what is missing from the picture
    #[arg(short, long)]
    quiet: bool,
    /// Print the plan and more statistics
    #[arg(short, long)]
    verbose: bool,
}

fn range(text: &str) -> Result<Range<u32>, String> {
    let wrong = || "expected A..B, such as 64..128 for the passes 64 to 127".to_owned();
    let (first, end) = text.split_once("..").ok_or_else(wrong)?;
    match (first.parse::<u32>(), end.parse::<u32>()) {
        (Ok(_), Ok(end)) if end > MOST_PASSES => Err(format!("a render has {MOST_PASSES} passes at most")),
        (Ok(first), Ok(end)) if first < end => Ok(first..end),
        _ => Err(wrong()),
    }
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

/// Renders a scene into files. The exit status is 0, or that of the signal which ended the render.
///
/// # Errors
/// When something asked for is wrong, the scene cannot be opened, or a file cannot be written.
pub fn run(args: &RenderArgs, interrupt: &Interrupt) -> Result<u8, Failure> {
    if args.help_settings {
        return Ok(help_settings()?);
    }
    args.threads.apply()?;
    // Found before the scene is read, which may take long.
    let layers = args.picture.layers()?;
    args.check_range()?;
    let started = Instant::now();
    let session = args.scene.open(args.quiet, layers)?;
    let load = (started.elapsed().as_secs_f64(), report::cpu_seconds());
    session.check_memory()?;
    let output = args.output(&session);
    let saver = args.saver(&session, &output);
    let saving = args.checkpoint.is_some() || args.resume;
    let checkpoint = saving.then_some(saver.path.as_path());
    let others: Vec<&Path> = args.stats.as_deref().into_iter().chain(checkpoint).collect();
    output.check(&session, &others)?;
    let _locks = output.lock(checkpoint.as_slice())?;
    let sums = args.begin(&session, &saver)?;
    args.tell(&session);
    args.tell_lost_layers(&session, &output);
    interrupt.watch();
    let mut saver = saver;
    let budget = args.budget(&session, interrupt);
    let mut view = args.view.open(&session, &budget, output.exposure, interrupt)?;
    let live = Live { saver: saving.then_some(&mut saver), view: view.as_mut(), output: &output };
    let outcome = args.render(&session, sums, budget, live);
    let cost = Cost::new(load, report::cpu_seconds());
    // A picture from before is worth more than a part of the first pass.
    let before = || args.pass_range.is_some() || output.files.iter().any(|file| file.exists());
    let kept = outcome.statistics.passes == 0 && before();
    // The picture first: it is what nobody wants to lose.
    let picture = if kept { Ok(()) } else { output.write(&session.picture(&outcome)) };
    for file in output.files.iter().filter(|_| kept) {
        let why = if outcome.stop == Stop::Interrupted { "interrupted" } else { "time is up" };
        report::line(&format!("{why} in the first pass: nothing was written to {}", file.display()));
    }
    let whole = outcome.statistics.passes > 0 && !outcome.statistics.first_pass_cut;
    let last = whole && (saving || outcome.stop == Stop::Interrupted);
    if last {
        let saved = saver.save(&outcome.pixels, outcome.statistics.passes, true);
        if let (Err(_), Err(problem)) = (&picture, &saved) {
            report::error(&problem.to_string());
        }
        picture.and(saved)?;
    } else {
        picture?;
    }
    let pictures = if kept { &[] } else { &*output.files };
    let checkpoint = last.then_some(format!("{} (checkpoint)", saver.path.display()));
    let written: Vec<String> =
        pictures.iter().map(|file| file.display().to_string()).chain(checkpoint).collect();
    args.summary(&session, &written, &outcome, cost)?;
    if let Some(view) = view {
        view.finish(&session, &outcome, &wrote(&written));
    }
    Ok(if outcome.stop == Stop::Interrupted { interrupt.status() } else { 0 })
}

/// One line for each file.
fn wrote(files: &[String]) -> String {
    files.iter().map(|file| format!("wrote {file}")).collect::<Vec<_>>().join("\n")
}

/// What is done after every pass, besides showing the progress.
struct Live<'a> {
    saver: Option<&'a mut Saver>,
    view: Option<&'a mut View>,
    output: &'a Output,
}

impl Live<'_> {
    fn after_pass(&mut self, session: &Session, p: &Progress<'_>) {
        if let Some(Err(problem)) = self.saver.as_mut().map(|saver| saver.after_pass(p.pixels, p.passes)) {
            report::line(&format!("warning: {problem}; rendering goes on, and this is tried again"));
        }
        let output = self.output;
        let mut save = || match output.write(&session.so_far(p)) {
            Ok(()) => {
                let files: Vec<String> = output.files.iter().map(|f| f.display().to_string()).collect();
                format!("{}\nafter {} passes", wrote(&files), p.passes)
            }
            Err(problem) => problem.to_string(),
        };
        if let Some(view) = &mut self.view {
            view.after_pass(session, p, &mut save);
        }
    }
}

impl RenderArgs {
    /// Of a range there is a picture where one is asked for: parts of a render may share a folder.
    fn output(&self, session: &Session) -> Output {
        if self.pass_range.is_some() && !self.picture.is_asked() {
            return Output::new(session, Vec::new());
        }
        self.picture.output(&session.info())
    }

    /// Makes sure that the passes of the range are among all passes.
    fn check_range(&self) -> Result<(), Failure> {
        match (&self.pass_range, self.scene.passes()) {
            (Some(Range { start, end }), Some(passes)) if *end > passes => Err(Failure::Usage(format!(
                "invalid value `{start}..{end}` for `--pass-range`: the whole render has {passes} passes"
            ))),
            _ => Ok(()),
        }
    }

    fn saver(&self, session: &Session, output: &Output) -> Saver {
        let beside = || output.files.first().map(|file| Saver::default_path(file));
        let path = self.checkpoint.clone().or_else(beside).unwrap_or_default();
        let saver = Saver::new(path, session).of_whole(self.scene.passes().unwrap_or(0));
        match &self.pass_range {
            Some(Range { start, end }) => saver.of_range(*start, *end),
            None => saver,
        }
    }

    /// What the render goes on from.
    fn begin(&self, session: &Session, saver: &Saver) -> Result<Sums, Failure> {
        let saved = if self.resume { saver.resume()? } else { None };
        // A task of many is started with --resume in any case.
        if self.resume && saved.is_none() && self.pass_range.is_none() {
            let path = saver.path.display();
            report::line(&format!("warning: there is no checkpoint `{path}`; beginning with the first pass"));
        }
        let first = self.pass_range.as_ref().map_or(0, |range| range.start);
        let sums = saved.unwrap_or_else(|| Sums::none_from(first, session.view.film.pixel_count()));
        let done = sums.first + sums.passes;
        if let Some(asked) = self.scene.passes().filter(|asked| *asked < done && !self.quiet) {
            report::line(&format!("warning: the checkpoint holds {done} passes; {asked} were asked for"));
        }
        Ok(sums)
    }

    /// Whatever is to be said before rendering.
    fn tell(&self, session: &Session) {
        if self.verbose {
            report::line(&session.plan().to_string());
        }
        if !session.facts.lit {
            let scene = session.path().display();
            report::line(&format!("warning: {scene}: the scene has no light; the picture will be black"));
        }
    }

    /// Says that the scene's own layers are lost where no file can hold them.
    fn tell_lost_layers(&self, session: &Session, output: &Output) {
        let stored =
            output.files.iter().any(|file| file.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")));
        let written = !output.files.is_empty();
        if written && !stored && !session.view.aovs.is_empty() && !self.quiet {
            let scene = session.path().display();
            report::line(&format!(
                "warning: {scene}: the layers that it asks for are stored in .exr files only"
            ));
        }
    }

    fn budget<'a>(&self, session: &Session, interrupt: &'a Interrupt) -> Budget<'a> {
        let limited = self.time.is_some() || self.target_error.is_some();
        let budget = Budget {
            // A time or an error ends the render, unless a number of passes was asked for as well.
            passes: (!limited || self.scene.passes().is_some()).then_some(session.settings.passes),
            time: self.time,
            error: self.target_error,
            whole: false,
            interrupt: Some(interrupt.flag()),
            idle: None,
        };
        match &self.pass_range {
            Some(range) => Budget { passes: Some(range.len() as u32), ..budget },
            None => budget,
        }
    }

    fn render(&self, session: &Session, sums: Sums, budget: Budget<'_>, mut live: Live<'_>) -> Outcome {
        let bar = self.progress_bar(&budget);
        let idle = live.view.as_ref().map(|view| view.idle());
        let budget = Budget { idle: idle.as_deref(), ..budget };
        let mut progress = |p: &Progress<'_>| {
            show(&bar, p, &budget);
            live.after_pass(session, p);
        };
        let outcome = match &self.pass_range {
            Some(range) => session.resume_range(sums, range.end, budget, &mut progress),
            None => session.resume(sums, budget, &mut progress),
        };
        bar.finish_and_clear();
        outcome
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
        session: &Session,
        written: &[String],
        outcome: &Outcome,
        cost: Cost,
    ) -> Result<(), String> {
        if let Some(path) = &self.stats {
            let value = summary::json(session, outcome, cost);
            let text = serde_json::to_string_pretty(&value).map_err(|e| e.to_string())?;
            caustica_formats::image::atomic_write(path, text.as_bytes())
                .map_err(|e| format!("cannot write `{}`: {e}", path.display()))?;
        }
        summary::warnings(outcome).iter().for_each(|line| report::line(line));
        if !self.quiet {
            report::line(&summary::table(outcome, cost.load_seconds));
            if !written.is_empty() {
                report::line(&wrote(written));
            }
        }
        Ok(())
    }
}

fn help_settings() -> Result<u8, String> {
    let defaults = Settings::default();
    let rows: Vec<String> = SETTINGS
        .iter()
        .zip(defaults.values())
        .map(|(row, (_, default))| {
            format!("{:<20} {} [{}; default {default}]", row.name, row.doc, row.expected)
        })
        .collect();
    let kernels: Vec<&str> = KernelKind::ALL.iter().map(|k| k.name()).collect();
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
    // The error estimate reads every pixel: show it at powers of two. It is not known of later passes alone.
    if p.passes.is_power_of_two() && p.passes > 1 {
        let error = p.pixels.relative_error(p.passes);
        let error = if error.is_finite() { format!(", error {:.2} %", 100.0 * error) } else { String::new() };
        bar.set_message(format!("pass {}{error}", p.passes));
    }
}
