//! Where the light paths of a map are sent, learned from pilots by the photons that land where the map is read.

mod bodies;
mod lines;
mod pilot;
mod seen;

pub use lines::{Line, Lines};
pub use seen::Sights;

use super::trace::{Halt, TraceJob};
use crate::emitter::{Aim, EmissionBounds, Emitter, EntrySegment, PathFound, SceneSphere, Starts, Targets};
use crate::scene::Scene;
use crate::transport::Owner;
use pilot::{Pilot, Seen, Task, Tried, gain};
use seen::Discs;

/// Paths of the first pilot, of one that looks closer where that found little, and of those that learned densities start.
const FIRST: u64 = 1 << 14;
const CLOSER: u64 = 1 << 16;
const LATER: u64 = 1 << 14;

/// If what the paths leave ends a pilot after this part of it, light is scattered so often that its start hardly matters.
const CUT: u64 = 4;

/// A pilot of fewer paths that bring something says little.
const FEW: f64 = 512.0;

/// Share of the paths that start by power and even numbers: what pilots missed is not lost, and no path carries more
/// than five times what it would without.
const EVEN: f64 = 0.2;

/// What a density has to gain in time to the same error.
const WORTH: f64 = 1.3;

/// The same where it was learned from few paths: more may sharpen it.
const PROMISING: f64 = 1.1;

/// If more than this share of the paths from infinity leave photons, they need no entrances.
const ENOUGH: f64 = 0.2;

/// Most entry segments that entrances are made from.
const SEGMENTS: usize = 2048;

/// How the paths of `job` should start, for a map that is read at `sights`. `None` if their lamps do well.
pub fn aim(scene: &Scene, job: &TraceJob, sights: &Sights<'_>, halt: Halt<'_>) -> Option<Aim> {
    if scene.emitters.is_empty() {
        return None;
    }
    let discs = Discs::new(scene, sights);
    found(&Task { scene, job, around: discs.around, seen: &Seen::Surfaces(discs), halt })
}

/// The same for a map of light in media that is read along `lines`.
pub fn aim_in_media(scene: &Scene, job: &TraceJob, lines: &Lines<'_>, halt: Halt<'_>) -> Option<Aim> {
    if scene.emitters.is_empty() {
        return None;
    }
    // Beams tell more of a path than photons at collisions, which have the same mean.
    let job = &TraceJob { beams: true, ..*job };
    found(&Task { scene, job, around: lines.around(), seen: &Seen::Media(*lines), halt })
}

fn found(task: &Task<'_>) -> Option<Aim> {
    let bodies = match task.job.owner {
        Owner::CausticMap => bodies::sharp_bodies(task.scene, task.job.glossy),
        _ => Vec::new(),
    };
    let aim =
        Aim { entrances: entrances(task, &bodies), headings: None, starts: None, landing: 0.0, cost: 1.0 };
    match starts(task, &aim, &bodies) {
        Ok(found) => Some(found),
        Err(_) if aim.entrances.is_none() => None,
        Err(landing) => Some(Aim { landing, ..aim }),
    }
}

/// Where light from infinity enters: around what the camera sees if the scene is much larger; otherwise where a pilot,
/// and a second one through what the first found, brings photons. `None` if all of the disk does well.
fn entrances(task: &Task<'_>, bodies: &[SceneSphere]) -> Option<Targets> {
    let scene = task.scene;
    if !scene.emitters.iter().any(Emitter::is_infinite) {
        return None;
    }
    if let Some(entrances) = Targets::around(&scene.sphere, &task.around) {
        return Some(entrances);
    }
    // In media, finding windows gains nothing: paths that miss them cost hardly any time.
    if matches!(task.seen, Seen::Media(_)) {
        return None;
    }
    let segments = |entrances: Option<&Targets>| {
        let mut pilot = Pilot::default();
        let bounds = EmissionBounds { sphere: scene.sphere, entrances, headings: None };
        pilot.run(task, task.paths(CLOSER), None, &bounds);
        let (met, mut found) = pilot.entry_segments(&pilot.found(task));
        let useful = found.len();
        found = found.iter().step_by(useful.div_ceil(SEGMENTS).max(1)).copied().collect();
        (pilot, useful as f64 > ENOUGH * met as f64, found)
    };
    let (pilot, enough, found): (Pilot, bool, Vec<EntrySegment>) = segments(None);
    if enough {
        return None;
    }
    let toward = || Targets::toward(&scene.sphere, &bodies::missed(bodies, &pilot));
    let coarse = Targets::new(&scene.sphere, &found).or_else(toward)?;
    let (_, _, found) = segments(Some(&coarse));
    Targets::new(&scene.sphere, &found).or(Some(coarse))
}

/// `aim` with densities for the starts, and with headings for lamps in the scene where few paths bring something.
/// If these gain little, the share of paths that bring something as it is.
fn starts(task: &Task<'_>, aim: &Aim, bodies: &[SceneSphere]) -> Result<Aim, f32> {
    let mut pilot = Pilot::default();
    pilot.run(task, task.paths(FIRST), None, &aim.bounds(task.scene.sphere));
    let found = pilot.found(task);
    let share = pilot.share(&found);
    if matches!(task.seen, Seen::Media(_)) && found.len() as u64 * CUT < task.paths(FIRST) {
        return Err(share as f32);
    }
    let headings = if share < ENOUGH { headings(task, bodies, &pilot) } else { None };
    if headings.is_some() {
        let mut pilot = Pilot::default();
        let aim = Aim { headings, ..aim.clone() };
        pilot.run(task, task.paths(LATER), None, &aim.bounds(task.scene.sphere));
        if let Some(refined) = refined(task, &aim, pilot) {
            return Ok(refined);
        }
    }
    if share * (found.len() as f64) < FEW {
        pilot.run(task, task.paths(CLOSER), None, &aim.bounds(task.scene.sphere));
    } else if halves_gain(task, &found) < PROMISING {
        return Err(share as f32);
    }
    refined(task, aim, pilot).ok_or(share as f32)
}

/// Where lamps in the scene may send their light: to what throws caustics, or around what the camera sees.
fn headings(task: &Task<'_>, bodies: &[SceneSphere], pilot: &Pilot) -> Option<Targets> {
    let scene = task.scene;
    if scene.emitters.iter().all(Emitter::is_infinite) {
        None
    } else if task.job.owner != Owner::CausticMap {
        Targets::around(&scene.sphere, &task.around)
    } else if bodies.len() <= bodies::MOST {
        Targets::toward(&scene.sphere, bodies)
    } else {
        Targets::toward(&scene.sphere, &bodies::missed(bodies, pilot))
    }
}

/// `aim` with a density learned from a pilot, and refined by two more that it starts. `None` if it gains little.
fn refined(task: &Task<'_>, aim: &Aim, mut pilot: Pilot) -> Option<Aim> {
    let learn = |found: &[PathFound]| Starts::learn(&task.scene.emission, found, EVEN);
    let bounds = aim.bounds(task.scene.sphere);
    let first = learn(&pilot.found(task))?;
    pilot.run(task, task.paths(LATER), Some(first), &bounds);
    let second = learn(&pilot.found(task))?;
    pilot.run(task, task.paths(LATER), Some(second), &bounds);
    let found = pilot.found(task);
    let gain = pilot.last_gain(&found);
    if gain.time < WORTH {
        return None;
    }
    let landing = pilot.last_share(&found) as f32;
    Some(Aim { starts: Some(learn(&found)?), landing, cost: gain.cost as f32, ..aim.clone() })
}

/// What a density gains on the paths of even number that was learned from the others.
fn halves_gain(task: &Task<'_>, found: &[PathFound]) -> f64 {
    let power = &task.scene.emission;
    let half = |first: usize| found.iter().skip(first).step_by(2);
    let odd: Vec<PathFound> = half(1).copied().collect();
    let Some(starts) = Starts::learn(power, &odd, EVEN) else { return 1.0 };
    let tried = half(0).map(|path| Tried {
        path: *path,
        density: f64::from(starts.density(power, path.lamp, path.found.at)),
        drawn: 1.0,
        weight: 1.0,
    });
    gain(tried).time
}
