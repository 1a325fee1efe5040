use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::aovs::Eye;
use super::bands::{Bands, Before};
use crate::film::{Aov, Pixels, Rejected};
use crate::integrator::{Integrator, PassStats, PathTracer, PhotonMapper, Scratch, Task, VolumePathTracer};
use crate::math::Vec2;
use crate::photon::trace::Halt;
use crate::settings::IntegratorKind;

/// When to end; whichever comes first. The default is never.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget<'a> {
    /// Passes in all, resumed ones included.
    pub passes: Option<u32>,
    /// Wall-clock time. The first pass is always made, with fewer light paths if there is no time for all.
    pub time: Option<Duration>,
    /// Relative standard error of the picture, see `Pixels::relative_error`.
    pub error: Option<f64>,
    /// Set from outside (Ctrl-C) to end at once. The running pass is undone, unless it is the first.
    pub interrupt: Option<&'a AtomicBool>,
    /// Nanoseconds for which the callback has paused the render so far: no part of its time.
    pub idle: Option<&'a AtomicU64>,
}

impl Budget<'_> {
    /// This many passes, resumed ones included.
    pub fn passes(n: u32) -> Self {
        Self { passes: Some(n), ..Self::default() }
    }

    /// The halt for work in a render begun at `start`; `until` maps its time budget to a deadline.
    fn halt(&self, start: Instant, until: fn(Duration) -> Duration) -> Halt<'_> {
        let deadline = self.time.and_then(|t| start.checked_add(until(t)));
        Halt { stop: self.interrupt, deadline, idle: self.idle }
    }

    /// Time of the render begun at `start`, without pauses.
    fn elapsed(&self, start: Instant) -> Duration {
        let idle = self.idle.map_or(0, |idle| idle.load(Ordering::Relaxed));
        start.elapsed().saturating_sub(Duration::from_nanos(idle))
    }
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Stop {
    /// All passes are done.
    Passes,
    /// The time is up.
    Time,
    /// The error is small enough.
    Error,
    /// Stopped from outside.
    Interrupted,
}

/// State after a pass.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Sums of all passes so far.
    pub pixels: &'a Pixels,
    /// Passes in `pixels`.
    pub passes: u32,
    /// Since the render began, without pauses.
    pub elapsed: Duration,
    /// What the last pass prepared.
    pub pass: PassStats,
    /// Of all passes so far; the time as a whole is `elapsed`.
    pub statistics: &'a Statistics,
}

/// What was done and how long it took.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Statistics {
    /// Passes in the picture, resumed ones included.
    pub passes: u32,
    /// Those of them that were resumed; counts and times are of the others.
    pub resumed_passes: u32,
    /// Wall-clock time of the render without loading and without pauses.
    pub seconds: f64,
    /// Choosing radii and path counts.
    pub prepare_seconds: f64,
    /// Tracing photons.
    pub trace_seconds: f64,
    /// Sorting photons into maps.
    pub build_seconds: f64,
    /// Camera paths with their lookups.
    pub camera_seconds: f64,
    /// Light paths traced.
    pub light_paths: u64,
    /// Photons stored in maps.
    pub photons_stored: u64,
    /// Rays of light and camera paths, shadow rays included.
    pub rays: u64,
    /// Density estimates.
    pub lookups: u64,
    /// Photons found by them.
    pub photons_gathered: u64,
    /// Largest photon maps held at once.
    pub map_bytes: u64,
    /// Sums of all pixels.
    pub film_bytes: u64,
    /// Geometry with its trees, and textures.
    pub scene_bytes: u64,
    /// Search radius of the global map in pass 0; 0 without a map.
    pub first_radius: f32,
    /// The same in the last pass.
    pub last_radius: f32,
    /// Search radius of the caustic map in pass 0; 0 without a map.
    pub first_caustic_radius: f32,
    /// The same in the last pass.
    pub last_caustic_radius: f32,
    /// Samples and photons that were NaN or infinite, and were left out.
    pub rejected: Rejected,
    /// The time was up in the first pass, which has fewer light paths than asked for; no further pass may
    /// be added to it.
    pub first_pass_cut: bool,
}

/// A finished render.
#[derive(Debug)]
pub struct Outcome {
    /// Sums of `statistics.passes` whole passes; if that is 0, of the pixels that an interrupted first pass
    /// reached.
    pub pixels: Pixels,
    /// Counts and times.
    pub statistics: Statistics,
    /// Why the render ended.
    pub stop: Stop,
}

/// What some passes have summed up.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// For every rendered pixel, row by row.
    pub pixels: Pixels,
    /// How many passes are in them, from the first.
    pub passes: u32,
}

impl Sums {
    /// Of no passes, for so many pixels.
    pub fn none(pixels: usize) -> Self {
        Self { pixels: Pixels::new(pixels), passes: 0 }
    }
}

/// Renders passes on top of `sums`, in order, and calls `progress` after each.
pub fn render(
    task: Task<'_>,
    budget: Budget<'_>,
    sums: Sums,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Outcome {
    let start = Instant::now();
    let kind = task.settings.integrator;
    // What media emit leaves no photons.
    if task.facts.media_emit || (task.facts.media && kind == IntegratorKind::Path) {
        return run(task, &VolumePathTracer::new(task), budget, sums, start, progress);
    }
    match kind {
        IntegratorKind::Path => {
            let integrator = PathTracer::new(task);
            run(task, &integrator, budget, sums, start, progress)
        }
        IntegratorKind::PhotonMap => {
            let later = budget.halt(start, overdue);
            let first = if sums.passes == 0 { budget.halt(start, |t| t.mul_f64(FIRST_TRACE)) } else { later };
            let integrator = PhotonMapper::halting(task, [first, later]);
            run(task, &integrator, budget, sums, start, progress)
        }
    }
}

/// How much longer than its time a render may take. Passes that would take longer are not begun; a pass
/// that overruns by twice this is abandoned.
const GRACE: Duration = Duration::from_millis(250);

/// When the running pass is abandoned in a render with this time budget.
fn overdue(time: Duration) -> Duration {
    time.saturating_add(2 * GRACE)
}

/// Share of the time that tracing photons for the first pass may take. The rest is for the map and for
/// the camera.
const FIRST_TRACE: f64 = 0.6;

fn run<I: Integrator>(
    task: Task<'_>,
    integrator: &I,
    budget: Budget<'_>,
    sums: Sums,
    start: Instant,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Outcome {
    let Sums { mut pixels, passes: done } = sums;
    pixels.hold_aovs(Aov::numbers_of(&task.view.aovs));
    let mut stats = Statistics { resumed_passes: done, ..prepared(task, &pixels, start) };
    [stats.first_radius, stats.first_caustic_radius] = integrator.first_radii();
    pixels.samples_a_pass = integrator.samples_a_pass();
    let halt = budget.halt(start, overdue);
    // The sums before the running pass, so that it can be undone.
    let mut before = Before::default();
    let mut passes = done;
    let mut longest = Duration::ZERO;
    let stop = loop {
        let elapsed = budget.elapsed(start);
        if budget.passes.is_some_and(|n| passes >= n) {
            break Stop::Passes;
        }
        if halt.stopped() {
            break Stop::Interrupted;
        }
        // A pass is not begun if more than half of it would be after the deadline.
        let late = longest.saturating_sub(GRACE).max(longest / 2);
        if budget.time.is_some_and(|t| passes > done && elapsed + late > t) {
            break Stop::Time;
        }
        if passes >= 8 && budget.error.is_some_and(|e| pixels.relative_error(passes) <= e) {
            break Stop::Error;
        }
        let begun = Instant::now();
        before.resize(&pixels);
        let (shared, pass) = integrator.begin_pass(passes);
        count(&mut stats, &pass);
        if pass.cut && passes > 0 {
            break if halt.stopped() { Stop::Interrupted } else { Stop::Time };
        }
        let camera = Instant::now();
        let bands = Bands {
            task,
            view: task.view,
            eye: Eye::new(task.scene, task.view),
            images: integrator.images(),
            integrator,
            shared: &shared,
            seed: task.settings.seed,
            pass: passes,
            each: integrator.samples_a_pass(),
            pixel: Vec2::new(1.0 / task.view.film.width as f32, 1.0 / task.view.film.height as f32),
            has_aperture: task.view.sensor.has_aperture(),
            // The first samples of a picture are made however late it is.
            halt: if passes > 0 { halt } else { Halt { deadline: None, ..halt } },
        };
        let whole = count_camera(&mut stats, &bands.sample(&mut pixels, &mut before));
        drop(shared);
        stats.camera_seconds += camera.elapsed().as_secs_f64();
        if !whole {
            if passes > 0 {
                before.restore(&mut pixels);
            }
            break if halt.stopped() { Stop::Interrupted } else { Stop::Time };
        }
        (passes, stats.passes) = (passes + 1, passes + 1);
        pixels.pass_done(passes);
        if pass.cut {
            stats.first_pass_cut = true;
            break Stop::Time;
        }
        // The mean length follows passes that grow cheaper as the radius shrinks.
        longest = begun.elapsed().max(longest.mul_f32(0.9));
        let elapsed = budget.elapsed(start);
        progress(&Progress { pixels: &pixels, passes, elapsed, pass, statistics: &stats });
    };
    (stats.passes, stats.seconds) = (passes, budget.elapsed(start).as_secs_f64());
    Outcome { pixels, statistics: stats, stop }
}

/// What is known before the first pass.
fn prepared(task: Task<'_>, pixels: &Pixels, start: Instant) -> Statistics {
    let film = size_of_val(pixels.as_slice()) + size_of_val(pixels.aovs());
    Statistics {
        prepare_seconds: start.elapsed().as_secs_f64(),
        film_bytes: film as u64,
        scene_bytes: (task.scene.geometry.bytes() + task.scene.textures.bytes()) as u64,
        ..Statistics::default()
    }
}

fn count(stats: &mut Statistics, pass: &PassStats) {
    stats.trace_seconds += pass.trace_seconds;
    stats.build_seconds += pass.build_seconds;
    stats.light_paths += pass.light_paths;
    stats.photons_stored += pass.photons;
    stats.rays += pass.photon_rays;
    stats.rejected.add(&pass.rejected);
    stats.map_bytes = stats.map_bytes.max(pass.map_bytes);
    if pass.radius > 0.0 || pass.caustic_radius > 0.0 {
        (stats.last_radius, stats.last_caustic_radius) = (pass.radius, pass.caustic_radius);
    }
}

/// Counts what the bands of a pass took; false when one was not sampled whole.
fn count_camera(stats: &mut Statistics, bands: &[(Scratch, Rejected, bool)]) -> bool {
    for (scratch, rejected, _) in bands {
        stats.rays += scratch.rays;
        stats.lookups += scratch.gather.lookups;
        stats.photons_gathered += scratch.gather.photons;
        stats.rejected.add(rejected);
    }
    bands.iter().all(|(_, _, whole)| *whole)
}
