use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use serde::Serialize;

use super::bands::Bands;
use super::effort::Effort;
use super::noise::{Noise, even_passes};
use crate::film::{Aov, Common, MOST_ADDITIONS, PassSums, Pixels, Rejected, SoFar, Waiting};
use crate::integrator::{Integrator, PassStats, PathTracer, PhotonMapper, Scratch, Task, VolumePathTracer};
use crate::photon::trace::Halt;
use crate::settings::IntegratorKind;

/// When to end; whichever comes first. The default is never.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget<'a> {
    /// Passes in all, resumed ones included; [`MOST_PASSES`] at most.
    pub passes: Option<u32>,
    /// Wall-clock time. The first pass is always made, with fewer light paths if there is no time for all; unless
    /// `whole` says otherwise.
    pub time: Option<Duration>,
    /// Make whole passes only, and none where the time is up before. Passes other than the first of a render are always
    /// whole.
    pub whole: bool,
    /// Relative standard error of the picture, see `Pixels::relative_error`.
    pub error: Option<f64>,
    /// Set from outside (Ctrl-C) to end at once. The running pass is undone, unless it is the first.
    pub interrupt: Option<&'a AtomicBool>,
    /// Nanoseconds for which the callback has paused the render so far: no part of its time.
    pub idle: Option<&'a AtomicU64>,
}

/// Passes of a render: more are not begun. A pass adds no more than a mean to each sum, and some light by splats.
pub const MOST_PASSES: u32 = MOST_ADDITIONS / 2;

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
    /// Sums of all passes so far, which are made when they are looked at.
    pub pixels: &'a SoFar<'a>,
    /// Passes in `pixels`.
    pub passes: u32,
    /// Since the render began, without pauses.
    pub elapsed: Duration,
    /// What the last pass prepared.
    pub pass: PassStats,
    /// Of all passes so far.
    pub statistics: &'a Statistics,
}

/// What was done and how long it took.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Statistics {
    /// The first pass in the picture, from 0.
    pub first_pass: u32,
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
    /// The first pass in them, from 0.
    pub first: u32,
    /// How many passes are in them.
    pub passes: u32,
}

impl Sums {
    /// Of no passes, for so many pixels.
    pub fn none(pixels: usize) -> Self {
        Self::none_from(0, pixels)
    }

    /// The same, for passes from `first` on.
    pub fn none_from(first: u32, pixels: usize) -> Self {
        Self { pixels: Pixels::new(pixels), first, passes: 0 }
    }
}

/// Renders passes on top of `sums`, in order, and calls `progress` after each. What a pass is depends on its number
/// only, and on the noise of the first passes, which are made again where they are not in this render.
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
            let cut = may_be_cut(&budget, &sums);
            let first = if cut { budget.halt(start, |t| t.mul_f64(FIRST_TRACE)) } else { later };
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

/// Whether the next pass is made however late it is, with fewer light paths if need be.
fn may_be_cut(budget: &Budget<'_>, sums: &Sums) -> bool {
    !budget.whole && sums.first == 0 && sums.passes == 0
}

fn run<I: Integrator>(
    task: Task<'_>,
    integrator: &I,
    budget: Budget<'_>,
    sums: Sums,
    start: Instant,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Outcome {
    let mut cuttable = may_be_cut(&budget, &sums);
    let Sums { mut pixels, first, passes: done } = sums;
    pixels.hold_aovs(Aov::numbers_of(&task.view.aovs));
    pixels.common = common(integrator);
    let mut effort = Effort::new(task, integrator, &pixels);
    // What the running pass adds, so that a pass which is cut adds nothing, and passes before it.
    let mut waiting = Waiting::new(pixels.len(), pixels.numbers_of_aovs());
    let mut stats = Statistics { first_pass: first, resumed_passes: done, ..prepared(task, start) };
    [stats.first_radius, stats.first_caustic_radius] = pixels.common.first_radii;
    let halt = budget.halt(start, overdue);
    let most = budget.passes.unwrap_or(MOST_PASSES).min(MOST_PASSES.saturating_sub(first));
    let mut passes = done;
    let mut longest = Duration::ZERO;
    let stop = loop {
        if passes >= most {
            break Stop::Passes;
        }
        if halt.stopped() {
            break Stop::Interrupted;
        }
        // A pass is not begun if more than half of it would be after the deadline.
        let late = budget.elapsed(start) + longest.saturating_sub(GRACE).max(longest / 2);
        if budget.time.is_some_and(|t| passes > done && late > t) {
            break Stop::Time;
        }
        if passes >= 8 && budget.error.is_some_and(|e| pixels.relative_error(passes) <= e) {
            break Stop::Error;
        }
        let (begun, number) = (Instant::now(), first + passes);
        if !effort.settle(number, &mut pixels, halt) {
            break halted(halt);
        }
        let (shared, pass) = integrator.begin_pass(number);
        count(&mut stats, &pass);
        if pass.cut && !cuttable {
            break halted(halt);
        }
        // The first samples of a picture are made however late it is.
        let halt_camera = if cuttable { Halt { deadline: None, ..halt } } else { halt };
        let bands = Bands::new(task, integrator, &shared, number, &pixels.counts().each, halt_camera);
        let whole = sample(&bands, waiting.running(), effort.noise_of(number), &mut stats);
        drop(shared);
        // Of the first pass of all even a part is a picture.
        if whole || cuttable {
            waiting.keep();
        }
        if !whole {
            break halted(halt);
        }
        passes += 1;
        // The noise is estimated at powers of two.
        if waiting.is_full() || budget.error.is_some() || (first + passes).is_power_of_two() {
            waiting.add_to(&mut pixels);
        }
        pixels.pass_done(first, first + passes);
        if pass.cut {
            stats.first_pass_cut = true;
            break Stop::Time;
        }
        cuttable = false;
        // The mean length follows passes that grow cheaper as the radius shrinks.
        longest = begun.elapsed().max(longest.mul_f32(0.9));
        let elapsed = budget.elapsed(start);
        stats.so_far(passes, elapsed, pixels.bytes() + waiting.bytes() + effort.bytes());
        waiting.show(&mut pixels, |pixels| {
            progress(&Progress { pixels, passes, elapsed, pass, statistics: &stats });
        });
    };
    waiting.add_to(&mut pixels);
    stats.so_far(passes, budget.elapsed(start), pixels.bytes() + waiting.bytes());
    Outcome { pixels, statistics: stats, stop }
}

/// Why a pass was not made whole.
fn halted(halt: Halt<'_>) -> Stop {
    if halt.stopped() { Stop::Interrupted } else { Stop::Time }
}

fn common(integrator: &impl Integrator) -> Common {
    Common {
        samples_a_pass: integrator.samples_a_pass(),
        even_passes: even_passes(integrator),
        first_radii: integrator.first_radii(),
    }
}

/// Makes the camera samples of a pass; false when not all were made.
fn sample<I: Integrator>(
    bands: &Bands<'_, I>,
    sums: &mut PassSums,
    noise: &mut [Noise],
    stats: &mut Statistics,
) -> bool {
    let start = Instant::now();
    let whole = count_camera(stats, &bands.sample(sums, noise));
    stats.camera_seconds += start.elapsed().as_secs_f64();
    whole
}

impl Statistics {
    /// After some passes.
    fn so_far(&mut self, passes: u32, elapsed: Duration, film: usize) {
        (self.passes, self.seconds, self.film_bytes) = (passes, elapsed.as_secs_f64(), film as u64);
    }
}

/// What is known before the first pass.
fn prepared(task: Task<'_>, start: Instant) -> Statistics {
    Statistics {
        prepare_seconds: start.elapsed().as_secs_f64(),
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
