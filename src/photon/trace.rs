//! Light paths: from the lamps through the scene, leaving photons on rough surfaces.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use super::{Photon, Stored};
use crate::bsdf::{self, Event, Transport, adjoint_correction};
use crate::emitter::Aim;
use crate::film::Rejected;
use crate::math::{Color, Ray, Vec3};
use crate::sampling::{Sampler, mix};
use crate::scene::{LightStart, Scene};
use crate::transport::roulette::Length;
use crate::transport::walk::{self, Lamps, Next};
use crate::transport::{Owner, PathClass, Smallness, Vertex, roulette};

/// Which photons to trace.
#[derive(Clone, Copy, Debug)]
pub struct TraceJob {
    /// Random sequence of this (seed, pass, map).
    pub key: u64,
    /// Paths to start. Each carries the scene's power divided by this.
    pub paths: u64,
    /// Photons of other owners are not stored.
    pub owner: Owner,
    /// Photons of every class are stored, as indirect ones.
    pub all: bool,
    /// Whether next event estimation owns direct light.
    pub next_event: bool,
    /// Whether caustics have a map of their own.
    pub caustic_map: bool,
    /// Roughness below which lobes hold no photons.
    pub glossy: f32,
    /// Photons of glints are stored, in a list of their own.
    pub glints: bool,
    /// Path segments from camera to lamp, at most.
    pub max_depth: u32,
}

/// When to stop work before it is complete.
#[derive(Clone, Copy, Debug, Default)]
pub struct Halt<'a> {
    /// Cancel: abandon the remaining work and discard the result.
    pub stop: Option<&'a AtomicBool>,
    /// No new work begins after this time; what is complete is kept.
    pub deadline: Option<Instant>,
}

impl Halt<'_> {
    /// Whether work was cancelled.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Whether the deadline has passed.
    pub fn late(&self) -> bool {
        self.deadline.is_some_and(|end| Instant::now() >= end)
    }
}

/// The photons stored by a job, with counters.
#[derive(Debug, Default)]
pub struct Traced {
    /// Paths traced: fewer than asked for if the deadline passed. The photons carry the whole power either way.
    pub paths: u64,
    /// In the order of the paths.
    pub photons: Stored,
    /// Those of glints, on glossy surfaces.
    pub glints: Stored,
    /// Rays traced.
    pub rays: u64,
    /// Photons dropped because they were not finite.
    pub rejected: Rejected,
}

/// The same of some paths.
#[derive(Debug, Default)]
pub(super) struct Part {
    paths: u64,
    pub photons: Vec<Photon>,
    glints: Vec<Photon>,
    pub rays: u64,
    rejected: Rejected,
}

impl Traced {
    /// Adds photons of some of `paths` paths.
    fn add(&mut self, part: Part, paths: u64) {
        self.paths += part.paths;
        let left = (paths - self.paths) as f64 / self.paths.max(1) as f64;
        let extend = |list: &mut Stored, more: Vec<Photon>| {
            let count = list.len() + more.len();
            if count > list.capacity() {
                // As many as the paths so far left, and some: lists that grow hold memory twice.
                list.reserve(more.len() + ((count as f64 * left * 1.02) as usize).min(MOST_RESERVED));
            }
            list.extend(more);
        };
        extend(&mut self.photons, part.photons);
        extend(&mut self.glints, part.glints);
        self.rays += part.rays;
        self.rejected.add(&part.rejected);
    }
}

/// Light paths of one unit of parallel work. Fixed, so that results are always joined in the same order.
pub const CHUNK: u64 = 2048;

/// Photons for which memory is taken beforehand, at most.
const MOST_RESERVED: usize = 1 << 26;

/// Chunks that are traced even after the deadline: a map of fewer paths would be useless.
const LEAST_CHUNKS: u64 = 32;

/// Runs `trace` on every chunk of the paths, in parallel, and returns the results in order. There are fewer when
/// `halt` says so; the first `least` chunks ignore the deadline.
pub(super) fn in_chunks<T: Send>(
    paths: u64,
    least: u64,
    halt: Halt<'_>,
    trace: impl Fn(Range<u64>) -> T + Sync,
) -> Vec<T> {
    let mut all = Vec::new();
    in_order(paths, least, halt, trace, |part| all.push(part));
    all
}

/// [`in_chunks`] whose results `take` gets in order, while others are still traced: few wait for it at any time.
fn in_order<T: Send>(
    paths: u64,
    least: u64,
    halt: Halt<'_>,
    trace: impl Fn(Range<u64>) -> T + Sync,
    take: impl FnMut(T) + Send,
) {
    let next = AtomicU64::new(0);
    let queue = Mutex::new(Queue { next: 0, early: BTreeMap::new(), take });
    let work = || {
        loop {
            let c = next.fetch_add(1, Ordering::Relaxed);
            if c >= paths.div_ceil(CHUNK) {
                return;
            }
            if halt.stopped() || (c >= least && halt.late()) {
                return;
            }
            let part = trace(c * CHUNK..((c + 1) * CHUNK).min(paths));
            queue.lock().unwrap_or_else(PoisonError::into_inner).put(c, part);
        }
    };
    rayon::scope(|scope| (0..rayon::current_num_threads()).for_each(|_| scope.spawn(|_| work())));
}

/// Results on their way to who takes them in order.
struct Queue<T, F> {
    next: u64,
    /// By number, those that came before their turn.
    early: BTreeMap<u64, T>,
    take: F,
}

impl<T, F: FnMut(T)> Queue<T, F> {
    fn put(&mut self, number: u64, result: T) {
        self.early.insert(number, result);
        while let Some(result) = self.early.remove(&self.next) {
            self.next += 1;
            (self.take)(result);
        }
    }
}

/// Traces all paths of a job. The result does not depend on the number of threads.
pub fn trace(scene: &Scene, job: &TraceJob) -> Traced {
    trace_until(scene, job, None, Halt::default())
}

/// [`trace`] with light sent where `aim` says, with fewer paths if the deadline comes first, and
/// without a result if work is cancelled.
pub fn trace_until(scene: &Scene, job: &TraceJob, aim: Option<&Aim>, halt: Halt<'_>) -> Traced {
    let mut all = Traced::default();
    let trace = |paths: Range<u64>| {
        let mut out = Part { paths: paths.end - paths.start, ..Part::default() };
        // A single path may take long; the result of cancelled work is discarded anyway.
        for i in paths.take_while(|_| !halt.stopped()) {
            let mut sampler = path_sampler(job, i);
            let (pick, place, direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
            if let Some(start) = scene.sample_aimed(pick, place, direction, aim) {
                follow(scene, job, &start, &mut sampler, &mut out);
            }
        }
        out
    };
    in_order(job.paths, LEAST_CHUNKS, halt, trace, |part| all.add(part, job.paths));
    if halt.stopped() {
        return Traced::default();
    }
    if all.paths < job.paths {
        let share = job.paths as f32 / all.paths.max(1) as f32;
        all.photons.scale(share);
        all.glints.scale(share);
    }
    all
}

/// The random numbers of a path.
#[inline(always)]
pub(super) fn path_sampler(job: &TraceJob, index: u64) -> Sampler {
    // Sobol indices have 32 bits; every further 2³² paths use a family of their own.
    Sampler::new(job.key ^ mix(index >> 32), index as u32)
}

/// Follows a path from its start. Returns the first surface point; `None` if it misses the scene.
#[inline]
pub(super) fn follow(
    scene: &Scene,
    job: &TraceJob,
    start: &LightStart,
    sampler: &mut Sampler,
    out: &mut Part,
) -> Option<Vec3> {
    let emission = &start.emission;
    let mut flux = emission.flux / job.paths as f32;
    let mut ray = Ray::new(emission.o, emission.d);
    let mut class = PathClass::FROM_LAMP;
    let mut depth = 1u32;
    let mut first = None;
    let mut smallness = Smallness::default();
    loop {
        out.rays += 1;
        let Next::Surface(surface) = walk::next(scene, &mut ray, Lamps::Solid) else { return first };
        first.get_or_insert(surface.p);
        let vertex = Vertex::new(scene, &surface, -ray.d);
        let kept = job.all || class.owner(job.next_event, job.caustic_map) == job.owner;
        if kept && holds_photons(scene, job, &vertex) {
            let class = if job.all { PathClass::Indirect } else { class };
            let n = scene.photon_side(&surface, vertex.back).n;
            out.photons.extend(photon(&vertex, n, (flux, class, depth), smallness, &mut out.rejected));
        }
        let glint = job.glints && class == PathClass::Caustic && smallness.enough();
        if glint && vertex.closure.has_smooth(vertex.wi, bsdf::Range::glossy(job.glossy)) {
            let n = scene.glint_side(&surface, vertex.back).n;
            out.glints.extend(photon(&vertex, n, (flux, class, depth), smallness, &mut out.rejected));
        }
        // A photon at the next surface needs two more segments: there, and from there to the camera.
        if depth.saturating_add(2) > job.max_depth {
            return first;
        }
        let Some((d, next, event)) = scatter(job, &vertex, flux, sampler) else { return first };
        let length = Length { segments: depth, most: job.max_depth };
        let survival = roulette::light_survival(flux, next, length);
        flux = if survival < 1.0 {
            let Some(survivor) = roulette::survivor(next, survival, sampler) else { return first };
            survivor
        } else {
            next
        };
        if job.glints && class == PathClass::Direct && event != Event::Null {
            smallness = Smallness::of(scene.pdf_direct_start(surface.p, -ray.d, start));
        }
        class = class.after_light_event(event);
        depth += 1;
        ray = surface.leave(d);
    }
}

/// Whether there are lobes that photons are for.
#[inline(always)]
fn holds_photons(scene: &Scene, job: &TraceJob, vertex: &Vertex<'_>) -> bool {
    let rough = bsdf::Range::rough(job.glossy);
    vertex.closure.has_smooth(vertex.wi, rough) || scene.material(vertex.surface).may_have(rough)
}

/// The direction (world) in which light goes on, its flux there, and what it went through.
#[inline(always)]
fn scatter(
    job: &TraceJob,
    vertex: &Vertex<'_>,
    flux: Color,
    sampler: &mut Sampler,
) -> Option<(Vec3, Color, Event)> {
    let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
    let sample = vertex.closure.sample(vertex.wi, u_lobe, u, Transport::Importance, job.glossy)?;
    // The caustic map holds nothing of what a rough surface scattered.
    if sample.event == Event::Smooth && job.owner == Owner::CausticMap {
        return None;
    }
    let d = vertex.surface.frame.to_world(sample.wo);
    Some((d, flux * sample.weight * adjoint(vertex, d, sample.wo.z, sample.event), sample.event))
}

/// [`adjoint_correction`] of light that goes on along `wo`. Straight through, nothing is scattered.
fn adjoint(vertex: &Vertex<'_>, wo: Vec3, wo_ns: f32, event: Event) -> f32 {
    let s = vertex.surface;
    if event == Event::Null || s.ng == s.frame.n {
        return 1.0;
    }
    adjoint_correction([vertex.wi.z, wo_ns], [vertex.back.dot(s.ng), wo.dot(s.ng)])
}

/// `None` where it is not finite.
fn photon(
    vertex: &Vertex<'_>,
    n: Vec3,
    (flux, class, depth): (Color, PathClass, u32),
    smallness: Smallness,
    rejected: &mut Rejected,
) -> Option<Photon> {
    let (s, wi) = (vertex.surface, vertex.back);
    // Density is counted per geometric area, but irradiance is wanted on the shading plane.
    let flux = flux * adjoint_correction([vertex.wi.z, 1.0], [wi.dot(s.ng), 1.0]);
    if !s.p.is_finite() {
        rejected.photon_place += 1;
        return None;
    }
    if !flux.is_finite() {
        rejected.photon_flux += 1;
        return None;
    }
    Some(Photon { p: s.p, flux, wi, n, class, depth: depth.min(255) as u8, smallness })
}
