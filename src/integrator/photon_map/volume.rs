//! Photons or beams in media: what belongs to them for a whole render, and how a pass traces and builds them.

use std::fmt;
use std::time::Instant;

use serde::Serialize;

use super::super::{PassStats, Task};
use super::maps::job;
use super::{MOST_COST, Plan};
use crate::emitter::{Aim, Aimed};
use crate::math::Color;
use crate::photon::aim::{Lines, aim_in_media};
use crate::photon::radius;
use crate::photon::trace::{Halt, TraceJob, Traced, trace_until};
use crate::photon::volume::{BeamMap, Found, Passage, PointMap, Segment, VolumeGather};
use crate::sampling::mix;
use crate::scene::Scene;
use crate::settings::{Count, InMedia, Mode, Radius, Settings};
use crate::transport::Owner;

/// Light paths of the pilot; fewer where each leaves so much that [`ENOUGH`] photons or beams come of fewer.
const PILOT: u64 = 1 << 13;
const FEW: u64 = PILOT >> 4;
const ENOUGH: u64 = 1 << 16;

/// Where no pilot compares them, beams are taken if light goes on average farther than so many radii between
/// collisions: fewer photons of a path would then be found by a camera ray than beams.
const LONG: f32 = 3.4;

/// Largest radius in mean ways between collisions: no more of a dense medium is seen than the outer one or two, and a
/// wide kernel would blur them over its border.
const WIDEST: f32 = 0.3;

/// Where that is less than this share of the way of a camera ray through the medium, the radius may have this share: a
/// kernel on a flat border blurs nothing. On a round one, as far across as that way, it must not sink deeper than this
/// share of the way between collisions.
const FLAT: f32 = 0.01;
const SUNK: f32 = 0.1;

fn widest(free_path: f32, way: f32) -> f32 {
    (WIDEST * free_path).max((FLAT * way).min((SUNK * free_path * way).sqrt()))
}

/// Most photons and beams of a pass where their number is left open: in milk a path leaves hundreds.
const MOST_POINTS: u64 = 1 << 21;
const MOST_BEAMS: u64 = 1 << 18;

/// Most finds of a camera ray, and least light paths, where the number of paths is left open.
const MOST_FOUND: f32 = 150.0;
const LEAST_PATHS: u64 = 1 << 10;

/// How much fewer beams a camera ray should find than photons: their number falls with the radius, not with its square.
const FEWER_BEAMS: f32 = 0.1;

/// What belongs to the light in media in all passes.
#[derive(Debug)]
pub(super) struct VolumeMap {
    job: TraceJob,
    mode: Mode,
    alpha: f64,
    /// Where light is sent, if at all; `None` before it was looked for.
    pub aim: Option<Option<Aim>>,
    /// How many times as much paths leave with it.
    aimed: f64,
    /// Light paths a pass; 0 where it is not needed.
    pub paths: u64,
    /// Search radius of the first pass.
    pub radius: f32,
    /// The share of what a pass may leave at most: a pilot of a smaller picture has as much for each pixel.
    pub most: f64,
}

/// That of one pass.
#[derive(Debug)]
pub(super) enum PassVolume {
    Points(PointMap),
    Beams(BeamMap),
}

/// What was chosen for the light in media, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VolumeChoice {
    /// Ways between collisions rather than collisions.
    pub beams: bool,
    /// Light paths a pass.
    pub paths: u64,
    /// Search radius of the first pass.
    pub radius: f32,
    /// Way of light between collisions, or between a collision and a surface; on average over a pilot.
    pub free_path: f32,
    /// Where the paths are sent, if not as lamps emit.
    pub aim: Option<Aimed>,
}

impl fmt::Display for VolumeChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.beams { "beams" } else { "photons at collisions" };
        let Self { paths, radius, free_path, .. } = self;
        write!(f, "{kind} of {paths} light paths a pass; radius {radius:.2e}, light goes {free_path:.2e} ")?;
        f.write_str("between collisions")?;
        self.aim.as_ref().map_or(Ok(()), |aim| write!(f, "\nmedia aim            {aim}"))
    }
}

impl VolumeMap {
    /// Not measured yet.
    pub fn new(s: &Settings, plan: &Plan) -> Self {
        let job = job(s, plan, Owner::VolumeMaps);
        Self {
            job,
            mode: s.mode,
            alpha: f64::from(s.volume_alpha),
            most: 1.0,
            aim: None,
            aimed: 1.0,
            paths: 0,
            radius: 0.0,
        }
    }

    /// Decides where light is sent, by where camera rays find it.
    pub fn take_aim(&mut self, scene: &Scene, lines: &Lines<'_>, halt: Halt<'_>) {
        let key = mix(self.job.key ^ (u64::from(u32::MAX) << 2 | 3));
        self.aim = Some(aim_in_media(scene, &TraceJob { key, ..self.job }, lines, halt));
    }

    /// Measures what the settings leave open, by segments of camera rays in media and the size of a pixel there.
    pub fn measure(
        &mut self,
        task: &Task<'_>,
        plan: &Plan,
        (segments, pixel): (&[Segment], f32),
        halt: Halt<'_>,
    ) -> VolumeChoice {
        self.job.beams = true;
        let (pilot, traced) = self.pilot(task.scene, halt);
        if self.aim_in_use().is_some() {
            let plain = self.trace(task.scene, (u32::MAX, None), PILOT, halt).beams.len().max(1);
            let aimed = pilot.beams.len() as f64 * PILOT as f64 / (plain as f64 * traced as f64);
            self.aimed = aimed.clamp(1.0, MOST_COST);
        }
        let lengths = pilot.beams.iter().fold(0.0, |sum, beam| sum + f64::from(beam.length));
        let free_path = (lengths / pilot.beams.len().max(1) as f64) as f32;
        let mut ways: Vec<f32> = segments.iter().map(|segment| segment.length).collect();
        let way = radius::quantile(&mut ways, 0.5).unwrap_or(0.0);
        let found = |r: f32| {
            let (map, mut near) = (BeamMap::build(&pilot.beams, r), Vec::new());
            counted(segments, |segment| {
                map.along(segment, &mut near);
                near.len()
            })
        };
        self.settle(task, plan, [pixel, free_path, way], (traced, pilot.beams.len(), MOST_BEAMS), found);
        self.job.beams = match task.settings.beams {
            InMedia::Auto => free_path > LONG * self.radius,
            InMedia::Points => false,
            InMedia::Beams => true,
        };
        if !self.job.beams {
            let (pilot, traced) = self.pilot(task.scene, halt);
            let found = |r: f32| {
                let (map, mut near) = (PointMap::build(&pilot.points, r), Vec::new());
                counted(segments, |segment| {
                    map.along(segment, &mut near);
                    near.len()
                })
            };
            self.settle(
                task,
                plan,
                [pixel, free_path, way],
                (traced, pilot.points.len(), MOST_POINTS),
                found,
            );
        }
        let (beams, paths, radius) = (self.job.beams, self.paths, self.radius);
        let aim = self.aim_in_use().map(|aim| aim.aimed(&task.scene.emission));
        VolumeChoice { beams, paths, radius, free_path, aim }
    }

    /// What the paths of a pilot left, and how many there were.
    fn pilot(&self, scene: &Scene, halt: Halt<'_>) -> (Traced, u64) {
        let all = (u32::MAX, self.aim_in_use());
        let few = self.trace(scene, all, FEW, halt);
        let left = few.beams.len().max(few.points.len()).max(1) as u64;
        let paths = (FEW * ENOUGH / left).clamp(FEW, PILOT);
        let pilot = if paths > FEW { self.trace(scene, all, paths, halt) } else { few };
        (pilot, paths)
    }

    /// Decides on paths and radius, by how many `found` sees of what a pilot left with a radius; `left` of them by so
    /// many paths, of at most so many in a pass.
    fn settle(
        &mut self,
        task: &Task<'_>,
        plan: &Plan,
        [pixel, free_path, way]: [f32; 3],
        (traced, left, most): (u64, usize, u64),
        found: impl Fn(f32) -> f32,
    ) {
        let (s, sphere) = (task.settings, task.scene.sphere.radius);
        let each = (left as f64 / traced as f64).max(1e-3);
        self.paths = count_paths(s, plan, [each, self.aimed], most as f64 * self.most);
        let share = self.paths as f32 / traced as f32;
        let (wanted, power) = match self.job.beams {
            true => ((s.volume_neighbours as f32 * FEWER_BEAMS).max(1.0), 1.0),
            false => (s.volume_neighbours as f32, 0.5),
        };
        self.radius = match s.volume_radius {
            Radius::Absolute(r) => r,
            Radius::Relative(r) => r * sphere,
            Radius::Auto => {
                let r = radius::clamped(searched(&found, wanted, share, power, sphere), pixel, sphere);
                if free_path > 0.0 { r.min(widest(free_path, way)) } else { r }
            }
        };
        // More would take longer to add up than to trace.
        if s.volume_photons == Count::Auto {
            let each = found(self.radius) * share;
            self.paths = ((self.paths as f32 * (MOST_FOUND / each).min(1.0)) as u64).max(LEAST_PATHS);
        }
    }

    fn aim_in_use(&self) -> Option<&Aim> {
        self.aim.as_ref().and_then(Option::as_ref)
    }

    /// What paths of a pass leave that start by an aim.
    fn trace(&self, scene: &Scene, (pass, aim): (u32, Option<&Aim>), paths: u64, halt: Halt<'_>) -> Traced {
        let key = mix(self.job.key ^ (u64::from(pass) << 2 | 2));
        trace_until(scene, &TraceJob { key, paths, ..self.job }, aim, halt)
    }

    /// Radius of pass i, of which its kernel's area (points) or width (beams) shrinks like that of other maps.
    fn radius_of(&self, pass: u32) -> f32 {
        let first = f64::from(self.radius);
        let shrunk = match self.mode {
            Mode::Classic => first,
            Mode::Progressive => {
                first * radius::shrinkage(pass, self.alpha).powf(if self.job.beams { 1.0 } else { 0.5 })
            }
        };
        (shrunk as f32).max(radius::LEAST)
    }

    /// Traces and sorts what a pass leaves; `None` where it is not needed.
    pub fn build(
        &self,
        scene: &Scene,
        pass: u32,
        halt: Halt<'_>,
        stats: &mut PassStats,
    ) -> Option<PassVolume> {
        if self.paths == 0 {
            return None;
        }
        let start = Instant::now();
        let traced = self.trace(scene, (pass, self.aim_in_use()), self.paths, halt);
        stats.cut |= traced.paths < self.paths;
        stats.trace_seconds += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let radius = self.radius_of(pass);
        let (built, count, bytes) = if self.job.beams {
            let map = BeamMap::build(&traced.beams, radius);
            let (count, bytes) = (map.len(), map.bytes());
            (PassVolume::Beams(map), count, bytes)
        } else {
            let map = PointMap::build(&traced.points, radius);
            let (count, bytes) = (map.len(), map.bytes());
            (PassVolume::Points(map), count, bytes)
        };
        stats.build_seconds += start.elapsed().as_secs_f64();
        stats.light_paths += traced.paths;
        stats.photons += count as u64;
        stats.photon_rays += traced.rays;
        stats.rejected.add(&traced.rejected);
        stats.map_bytes += bytes as u64;
        Some(built)
    }
}

impl PassVolume {
    /// Radiance at the start of a segment.
    pub fn radiance<P: Passage>(&self, at: &VolumeGather<'_, P>, found: &mut Found) -> Color {
        match self {
            Self::Points(map) => map.radiance(at, found),
            Self::Beams(map) => map.radiance(at, found),
        }
    }
}

/// Light paths of a pass, of which each leaves so many: where the number was left open, no more than leave `most`, and
/// as many times fewer as they leave more because they are `aimed`.
fn count_paths(s: &Settings, plan: &Plan, [each, aimed]: [f64; 2], most: f64) -> u64 {
    match plan.volume_paths {
        Count::Paths(n) if s.volume_photons == Count::Auto => {
            (n as f64 / aimed).min(most / each).max(1.0) as u64
        }
        Count::Paths(n) => n,
        Count::Stored(n) => ((n as f64 / each) as u64).max(1),
        Count::Auto => 0,
    }
}

/// How many of its finds the median find has company of on its segment: segments that see nothing have no vote.
fn counted(segments: &[Segment], mut count: impl FnMut(&Segment) -> usize) -> f32 {
    let mut counts: Vec<usize> = segments.iter().map(&mut count).filter(|n| *n > 0).collect();
    counts.sort_unstable();
    let half = counts.iter().sum::<usize>() / 2;
    let mut below = 0;
    for n in counts {
        below += n;
        if below >= half {
            return n as f32;
        }
    }
    0.0
}

/// The radius with which a pass lets the median find have `wanted` of its kind, told from a pilot by how many `found`
/// sees with a radius: that number grows as r^(1/`power`) and with the paths, of which a pass has `share` times as many.
fn searched(found: impl Fn(f32) -> f32, wanted: f32, share: f32, power: f32, scene_radius: f32) -> f32 {
    // Fewer say little, whatever the pass will find.
    const LEAST: f32 = 8.0;
    let most = 0.1 * scene_radius;
    let seen = (wanted / share).max(LEAST);
    let mut r = 0.1 * most;
    for _ in 0..4 {
        let n = found(r).max(0.5);
        r = (r * (seen / n).powf(power).clamp(0.05, 20.0)).min(most);
    }
    (r * (wanted / share / seen).powf(power)).clamp(radius::LEAST.min(most), most)
}
