//! What light paths are traced for, and what they leave.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::Photon;
use super::volume::{Beam, VolumePhoton};
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
    pub photons: Vec<Photon>,
    /// At collisions with media.
    pub points: Vec<VolumePhoton>,
    /// Between them.
    pub beams: Vec<Beam>,
    /// Rays traced.
    pub rays: u64,
    /// Photons dropped because they were not finite.
    pub rejected: Rejected,
}
