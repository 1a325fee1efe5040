//! Light paths: from the lamps through the scene, leaving photons on rough surfaces and in media.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

pub(super) use super::job::Part;
pub use super::job::{Halt, TraceJob, Traced};
use super::{media, surfaces};
use crate::emitter::Aim;
use crate::math::Vec3;
use crate::sampling::{Sampler, mix};
use crate::scene::{LightStart, Scene};

/// Light paths of one unit of parallel work. Fixed, so that results are always joined in the same order.
pub const CHUNK: u64 = 2048;

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
        all.scale(job.paths as f32 / all.paths.max(1) as f32);
    }
    all
}

/// The random numbers of a path.
#[inline(always)]
pub(super) fn path_sampler(job: &TraceJob, index: u64) -> Sampler {
    // Sobol indices have 32 bits; every further 2³² paths use a family of their own.
    Sampler::new(job.key ^ mix(index >> 32), index as u32)
}

/// Follows a path from its start. Returns the first surface point; `None` if it comes to none.
#[inline]
pub(super) fn follow(
    scene: &Scene,
    job: &TraceJob,
    start: &LightStart,
    sampler: &mut Sampler,
    out: &mut Part,
) -> Option<Vec3> {
    if scene.media.is_empty() {
        surfaces::follow(scene, job, start, sampler, out)
    } else {
        media::follow(scene, job, start, sampler, out)
    }
}
