//! What light paths are traced for, and what they leave.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::volume::{Beam, VolumePhoton};
use super::{Photon, Stored};
use crate::film::Rejected;
use crate::transport::Owner;

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
    /// Light in media is kept by the ways between collisions rather than by the collisions.
    pub beams: bool,
    /// Roughness below which lobes hold no photons.
    pub glossy: f32,
    /// Photons of glints are stored, apart from the others.
    pub glints: bool,
    /// Photons of indirect light that come from specular or glossy surfaces are stored apart from the others.
    pub focused: bool,
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
    /// Nanoseconds of pauses so far, by which the deadline is later.
    pub idle: Option<&'a AtomicU64>,
}

impl Halt<'_> {
    /// Whether work was cancelled.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Whether the deadline has passed.
    pub fn late(&self) -> bool {
        let idle = Duration::from_nanos(self.idle.map_or(0, |idle| idle.load(Ordering::Relaxed)));
        self.deadline.is_some_and(|end| Instant::now().checked_sub(idle).is_some_and(|now| now >= end))
    }
}

/// The photons stored by a job, with counters.
#[derive(Debug, Default)]
pub struct Traced {
    /// Paths traced: fewer than asked for if the deadline passed. The photons carry the whole power either way.
    pub paths: u64,
    /// In the order of the paths.
    pub photons: Stored,
    /// Those that are read with a radius of their own: of glints, on glossy surfaces, or of focused indirect light.
    pub apart: Stored,
    /// At collisions with media.
    pub points: Vec<VolumePhoton>,
    /// Between them.
    pub beams: Vec<Beam>,
    /// Rays traced.
    pub rays: u64,
    /// Photons dropped because they were not finite.
    pub rejected: Rejected,
}

/// The same of some paths.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub paths: u64,
    pub photons: Vec<Photon>,
    pub apart: Vec<Photon>,
    pub points: Vec<VolumePhoton>,
    pub beams: Vec<Beam>,
    pub rays: u64,
    pub rejected: Rejected,
}

/// Photons for which memory is taken beforehand, at most.
const MOST_RESERVED: usize = 1 << 26;

impl Traced {
    /// Adds photons of some of `paths` paths.
    pub(super) fn add(&mut self, part: Part, paths: u64) {
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
        extend(&mut self.apart, part.apart);
        self.points.extend(part.points);
        self.beams.extend(part.beams);
        self.rays += part.rays;
        self.rejected.add(&part.rejected);
    }

    /// Multiplies all flux.
    pub(super) fn scale(&mut self, share: f32) {
        self.photons.scale(share);
        self.apart.scale(share);
        self.points.iter_mut().for_each(|p| p.flux *= share);
        self.beams.iter_mut().for_each(|b| b.flux *= share);
    }
}
