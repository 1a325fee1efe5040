//! Light paths: from the lamps through the scene, leaving photons on rough surfaces and in media.

use rayon::prelude::*;

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

/// Runs `trace` on every chunk of the paths, in parallel, and returns the results in order. Chunks skipped because of
/// `halt` give the default; the first `least` chunks ignore the deadline.
pub(super) fn in_chunks<T: Default + Send>(
    paths: u64,
    least: u64,
    halt: Halt<'_>,
    trace: impl Fn(std::ops::Range<u64>) -> T + Sync,
) -> Vec<T> {
    let chunk = |c: u64| {
        if halt.stopped() || (c >= least && halt.late()) {
            return T::default();
        }
        trace(c * CHUNK..((c + 1) * CHUNK).min(paths))
    };
    (0..paths.div_ceil(CHUNK)).into_par_iter().map(chunk).collect()
}

/// Traces all paths of a job. The result does not depend on the number of threads.
pub fn trace(scene: &Scene, job: &TraceJob) -> Traced {
    trace_until(scene, job, None, Halt::default())
}

/// [`trace`] with light sent where `aim` says, with fewer paths if the deadline comes first, and
/// without a result if work is cancelled.
pub fn trace_until(scene: &Scene, job: &TraceJob, aim: Option<&Aim>, halt: Halt<'_>) -> Traced {
    let chunks = in_chunks(job.paths, LEAST_CHUNKS, halt, |paths| {
        let mut out = Traced { paths: paths.end - paths.start, ..Traced::default() };
        // A single path may take long; the result of cancelled work is discarded anyway.
        for i in paths.take_while(|_| !halt.stopped()) {
            let mut sampler = path_sampler(job, i);
            let (pick, place, direction) = (sampler.next_1d(), sampler.next_2d(), sampler.next_2d());
            if let Some(start) = scene.sample_aimed(pick, place, direction, aim) {
                follow(scene, job, &start, &mut sampler, &mut out);
            }
        }
        out
    });
    if halt.stopped() {
        return Traced::default();
    }
    let mut all = Traced {
        photons: Vec::with_capacity(chunks.iter().map(|c| c.photons.len()).sum()),
        points: Vec::with_capacity(chunks.iter().map(|c| c.points.len()).sum()),
        beams: Vec::with_capacity(chunks.iter().map(|c| c.beams.len()).sum()),
        ..Traced::default()
    };
    for c in chunks {
        all.photons.extend(c.photons);
        all.points.extend(c.points);
        all.beams.extend(c.beams);
        all.paths += c.paths;
        all.rays += c.rays;
        all.rejected.add(&c.rejected);
    }
    if all.paths < job.paths {
        let share = job.paths as f32 / all.paths.max(1) as f32;
        all.photons.iter_mut().for_each(|p| p.flux *= share);
        all.points.iter_mut().for_each(|p| p.flux *= share);
        all.beams.iter_mut().for_each(|b| b.flux *= share);
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
    out: &mut Traced,
) -> Option<Vec3> {
    if scene.media.is_empty() {
        surfaces::follow(scene, job, &start.emission, sampler, out)
    } else {
        media::follow(scene, job, start, sampler, out)
    }
}
