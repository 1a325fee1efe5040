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
    /// Wall-clock time. The first pass is always made, with fewer light paths if there is no time for all.
    pub time: Option<Duration>,
    /// Relative standard error of the picture, see `Pixels::relative_error`.
    pub error: Option<f64>,
    /// Set from outside (Ctrl-C) to end at once. The running pass is undone, unless it is the first.
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
    /// Since the render began.
    pub elapsed: Duration,
    /// What the last pass prepared.
    pub pass: PassStats,
}

/// What was done and how long it took.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Statistics {
    /// Passes in the picture, resumed ones included.
    pub passes: u32,
    /// Those of them that were resumed; counts and times are of the others.
    pub resumed_passes: u32,
    /// Wall-clock time of the render without loading.
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
    // The sums before the running pass, so that it can be undone.
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
        // A pass is not begun if more than half of it would be after the deadline.
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
        let bands = Bands {
            view: task.view,
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
        let whole = bands.sample(&mut pixels, &mut before, &mut stats);
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
    (stats.passes, stats.resumed_passes, stats.seconds) = (passes, done, start.elapsed().as_secs_f64());
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

/// What all bands of a pass share.
struct Bands<'a, I: Integrator> {
    view: &'a View,
    integrator: &'a I,
    shared: &'a I::Pass,
    seed: u64,
    pass: u32,
    /// Samples of each pixel.
    each: u32,
    /// Of a pixel, as a share of the film.
    pixel: Vec2,
    has_aperture: bool,
    halt: Halt<'a>,
}

/// Camera samples of a square of pixels, in the order in which they are drawn.
struct Square {
    samples: Vec<CameraSample>,
    /// Of the filter, for each sample.
    weights: Vec<f32>,
    /// Pixels of the band; each has as many samples as the integrator takes in a pass.
    places: Vec<usize>,
}

impl<I: Integrator> Bands<'_, I> {
    /// Samples every pixel; false when halted before all were. What the pixels were goes into `before`.
    fn sample(&self, pixels: &mut Pixels, before: &mut [[f64; STRIDE]], stats: &mut Statistics) -> bool {
        let band = self.view.film.crop[2] as usize * BLOCK;
        let counted: Vec<(Scratch, Rejected, bool)> = pixels
            .as_mut_slice()
            .par_chunks_mut(band)
            .zip(before.par_chunks_mut(band))
            .enumerate()
            .map(|(b, (sums, before))| {
                before.copy_from_slice(sums);
                self.band(b, sums)
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

    /// Adds the samples of band `b` to its sums.
    fn band(&self, b: usize, sums: &mut [[f64; STRIDE]]) -> (Scratch, Rejected, bool) {
        let [_, _, width, height] = self.view.film.crop.map(|v| v as usize);
        let each = self.each as usize;
        let mut scratch = Scratch::default();
        let mut rejected = Rejected::default();
        let rows = (height - b * BLOCK).min(BLOCK);
        let capacity = BLOCK * BLOCK;
        let mut square = Square {
            samples: Vec::with_capacity(capacity),
            weights: Vec::with_capacity(capacity),
            places: Vec::with_capacity(capacity),
        };
        for column in (0..width).step_by(BLOCK) {
            if self.halt.stopped() || self.halt.late() {
                return (scratch, rejected, false);
            }
            self.draw(b, rows, column, &mut square);
            self.integrator.sample(self.shared, &mut square.samples, &mut scratch);
            let pixels = square.samples.chunks_mut(each).zip(square.weights.chunks(each)).zip(&square.places);
            for ((samples, weights), &at) in pixels {
                let mut mean = Mean::default();
                for (sample, weight) in samples.iter_mut().zip(weights) {
                    self.view.response.apply(&mut sample.out);
                    mean.add(&sample.out, weight / each as f32, &mut rejected);
                }
                mean.add_to(&mut sums[at]);
            }
        }
        (scratch, rejected, true)
    }

    /// Camera rays of the square of band `b` that begins at `column`.
    fn draw(&self, b: usize, rows: usize, column: usize, square: &mut Square) {
        let film = &self.view.film;
        let [x0, y0, width, _] = film.crop.map(|v| v as usize);
        square.samples.clear();
        square.weights.clear();
        square.places.clear();
        for row in 0..rows {
            for x in column..(column + BLOCK).min(width) {
                self.draw_pixel(x0 + x, y0 + b * BLOCK + row, square);
                square.places.push(row * width + x);
            }
        }
    }

    #[inline]
    fn draw_pixel(&self, px: usize, py: usize, square: &mut Square) {
        let View { sensor, filter, .. } = self.view;
        // Keyed by the place on the full film: a crop shows the same noise.
        let pixel = (py as u64) << 32 | px as u64;
        for number in 0..self.each {
            let index = self.pass.wrapping_mul(self.each).wrapping_add(number);
            let mut sampler =
                Sampler::new(mix(self.seed ^ mix(pixel)), index).stratified(I::STRATIFIED_PAIRS);
            let (offset, weight) = filter.sample(sampler.next_2d());
            let place = (Vec2::new(px as f32 + 0.5, py as f32 + 0.5) + offset) * self.pixel;
            let aperture = if self.has_aperture { sampler.next_2d() } else { Vec2::ZERO };
            let ray = sensor.ray(place, aperture);
            square.samples.push(CameraSample { ray, sampler, out: Radiance::default() });
            square.weights.push(weight);
        }
    }
}
