use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde::Serialize;

use crate::film::{Mean, Pixels, Radiance, Rejected, STRIDE};
use crate::integrator::{CameraSample, Integrator, PassStats, PathTracer, PhotonMapper, Scratch, Task};
use crate::math::Vec2;
use crate::photon::trace::Halt;
use crate::sampling::{Sampler, mix};
use crate::scene::View;
use crate::settings::IntegratorKind;

/// When to end; whichever comes first. The default is never.
#[derive(Clone, Copy, Debug, Default)]
pub struct Budget<'a> {
    /// Passes in all, resumed ones included.
    pub passes: Option<u32>,
    /// The first pass of a render is always made, if need be of fewer light paths.
    pub time: Option<Duration>,
    /// Relative standard error of the picture, see `Pixels::relative_error`.
    pub error: Option<f64>,
    /// Set from outside (Ctrl-C) to end at once: the running pass is taken back, unless it is the first.
    pub interrupt: Option<&'a AtomicBool>,
}

impl Budget<'_> {
    /// This many passes, resumed ones included.
    pub fn passes(n: u32) -> Self {
        Self { passes: Some(n), ..Self::default() }
    }

    /// The halt for work in a render begun at `start`; `until` maps its time budget to a deadline.
    fn halt(&self, start: Instant, until: fn(Duration) -> Duration) -> Halt<'_> {
        Halt { stop: self.interrupt, deadline: self.time.and_then(|t| start.checked_add(until(t))) }
    }
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Stop {
    Passes,
    Time,
    Error,
    Interrupted,
}

/// State after a pass.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    pub pixels: &'a Pixels,
    /// Passes in `pixels`.
    pub passes: u32,
    pub elapsed: Duration,
    pub pass: PassStats,
}

/// What was done and how long it took.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Statistics {
    pub passes: u32,
    pub seconds: f64,
    /// Choosing radii and path counts.
    pub prepare_seconds: f64,
    pub trace_seconds: f64,
    pub build_seconds: f64,
    pub camera_seconds: f64,
    pub light_paths: u64,
    pub photons_stored: u64,
    pub rays: u64,
    pub lookups: u64,
    pub photons_gathered: u64,
    /// Largest photon maps and sums held at once.
    pub map_bytes: u64,
    pub film_bytes: u64,
    pub scene_bytes: u64,
    pub first_radius: f32,
    pub last_radius: f32,
    pub first_caustic_radius: f32,
    pub last_caustic_radius: f32,
    /// Samples and photons that were NaN or infinite, and were left out.
    pub rejected: Rejected,
    /// Time was up in the first pass, which was made of fewer light paths: no other pass may be added.
    pub first_pass_cut: bool,
}

/// A finished render.
#[derive(Debug)]
pub struct Outcome {
    /// Sums of `statistics.passes` whole passes. When that is 0, what an interrupted first pass reached.
    pub pixels: Pixels,
    pub statistics: Statistics,
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
    match task.settings.integrator {
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

/// By how much a render may outlast its time. Passes that would do so are not begun, and those that take
/// twice this in excess are given up.
const GRACE: Duration = Duration::from_millis(250);

/// When the running pass of a render that has this time is given up.
fn overdue(time: Duration) -> Duration {
    time.saturating_add(2 * GRACE)
}

/// Share of the time that tracing photons for the first pass may take. The rest is for the map and for
/// the camera.
const FIRST_TRACE: f64 = 0.6;

/// Rows of a block: a unit of parallel work is a band of the picture this high, walked in squares so
/// that neighbouring lookups share cache lines.
const BLOCK: usize = 8;

fn run<I: Integrator>(
    task: Task<'_>,
    integrator: &I,
    budget: Budget<'_>,
    sums: Sums,
    start: Instant,
    progress: &mut dyn FnMut(&Progress<'_>),
) -> Outcome {
    let Sums { mut pixels, passes: done } = sums;
    let mut stats = Statistics {
        prepare_seconds: start.elapsed().as_secs_f64(),
        film_bytes: size_of_val(pixels.as_slice()) as u64,
        scene_bytes: (task.scene.geometry.bytes() + task.scene.textures.bytes()) as u64,
        ..Statistics::default()
    };
    [stats.first_radius, stats.first_caustic_radius] = integrator.first_radii();
    pixels.samples_a_pass = integrator.samples_a_pass();
    let halt = budget.halt(start, overdue);
    // The sums before the running pass, to take it back.
    let mut before = Vec::new();
    let mut passes = done;
    let mut longest = Duration::ZERO;
    let stop = loop {
        let elapsed = start.elapsed();
        if budget.passes.is_some_and(|n| passes >= n) {
            break Stop::Passes;
        }
        if halt.stopped() {
            break Stop::Interrupted;
        }
        // A pass that would end late by more than half of itself is not begun.
        let late = longest.saturating_sub(GRACE).max(longest / 2);
        if budget.time.is_some_and(|t| passes > done && elapsed + late > t) {
            break Stop::Time;
        }
        if passes >= 8 && budget.error.is_some_and(|e| pixels.relative_error(passes) <= e) {
            break Stop::Error;
        }
        let begun = Instant::now();
        before.resize(pixels.len(), [0.0; STRIDE]);
        let (shared, pass) = integrator.begin_pass(passes);
        count(&mut stats, &pass);
        if pass.cut && passes > 0 {
            break if halt.stopped() { Stop::Interrupted } else { Stop::Time };
        }
        let camera = Instant::now();
        let whole = sample_all(
            task.view,
            integrator,
            &shared,
            task.settings.seed,
            passes,
            // The first samples of a picture are made however late it is.
            if passes > 0 { halt } else { Halt { deadline: None, ..halt } },
            &mut pixels,
            &mut before,
            &mut stats,
        );
        drop(shared);
        stats.camera_seconds += camera.elapsed().as_secs_f64();
        if !whole {
            if passes > 0 {
                pixels.as_mut_slice().copy_from_slice(&before);
            }
            break if halt.stopped() { Stop::Interrupted } else { Stop::Time };
        }
        passes += 1;
        pixels.pass_done(passes);
        if pass.cut {
            stats.first_pass_cut = true;
            break Stop::Time;
        }
        // The mean length follows passes that grow cheaper as the radius shrinks.
        longest = begun.elapsed().max(longest.mul_f32(0.9));
        progress(&Progress { pixels: &pixels, passes, elapsed: start.elapsed(), pass });
    };
    stats.passes = passes;
    stats.seconds = start.elapsed().as_secs_f64();
    Outcome { pixels, statistics: stats, stop }
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

/// One sample of every pixel; false when halted before all were made. What the pixels were goes
/// into `before`.
fn sample_all<I: Integrator>(
    view: &View,
    integrator: &I,
    shared: &I::Pass,
    seed: u64,
    pass: u32,
    halt: Halt<'_>,
    pixels: &mut Pixels,
    before: &mut [[f64; STRIDE]],
    stats: &mut Statistics,
) -> bool {
    let [x0, y0, width, height] = view.film.crop.map(|v| v as usize);
    let inverse = Vec2::new(1.0 / view.film.width as f32, 1.0 / view.film.height as f32);
    let band = width * BLOCK;
    let has_aperture = view.sensor.has_aperture();
    let each = integrator.samples_a_pass();
    let counted: Vec<(Scratch, Rejected, bool)> = pixels
        .as_mut_slice()
        .par_chunks_mut(band)
        .zip(before.par_chunks_mut(band))
        .enumerate()
        .map(|(b, (sums, before))| {
            before.copy_from_slice(sums);
            let mut scratch = Scratch::default();
            let mut rejected = Rejected::default();
            let rows = (height - b * BLOCK).min(BLOCK);
            let mut samples = Vec::with_capacity(BLOCK * BLOCK);
            let mut weights = Vec::with_capacity(BLOCK * BLOCK);
            let mut places = Vec::with_capacity(BLOCK * BLOCK);
            for column in (0..width).step_by(BLOCK) {
                if halt.stopped() || halt.late() {
                    return (scratch, rejected, false);
                }
                samples.clear();
                weights.clear();
                places.clear();
                for row in 0..rows {
                    for x in column..(column + BLOCK).min(width) {
                        let (px, py) = (x0 + x, y0 + b * BLOCK + row);
                        // Keyed by the place on the full film: a crop shows the same noise.
                        let pixel = (py as u64) << 32 | px as u64;
                        for number in 0..each {
                            let index = pass.wrapping_mul(each).wrapping_add(number);
                            let mut sampler =
                                Sampler::new(mix(seed ^ mix(pixel)), index).stratified(I::STRATIFIED_PAIRS);
                            let (offset, weight) = view.filter.sample(sampler.next_2d());
                            let film = (Vec2::new(px as f32 + 0.5, py as f32 + 0.5) + offset) * inverse;
                            let aperture = if has_aperture { sampler.next_2d() } else { Vec2::ZERO };
                            let ray = view.sensor.ray(film, aperture);
                            samples.push(CameraSample { ray, sampler, out: Radiance::default() });
                            weights.push(weight);
                        }
                        places.push(row * width + x);
                    }
                }
                integrator.sample(shared, &mut samples, &mut scratch);
                let each = each as usize;
                let pixels = samples.chunks_mut(each).zip(weights.chunks(each)).zip(&places);
                for ((samples, weights), &at) in pixels {
                    let mut mean = Mean::default();
                    for (sample, weight) in samples.iter_mut().zip(weights) {
                        view.response.apply(&mut sample.out);
                        mean.add(&sample.out, weight / each as f32, &mut rejected);
                    }
                    mean.add_to(&mut sums[at]);
                }
            }
            (scratch, rejected, true)
        })
        .collect();
    let mut whole = true;
    for (scratch, rejected, reached) in counted {
        whole &= reached;
        stats.rays += scratch.rays;
        stats.lookups += scratch.gather.lookups;
        stats.photons_gathered += scratch.gather.photons;
        stats.rejected.add(&rejected);
    }
    whole
}
