//! One photon map: what belongs to it for a whole render, and how a pass traces and builds it.

use std::sync::Mutex;
use std::time::Instant;

use super::super::{PassStats, Task};
use super::{MANY, PILOT, Plan};
use crate::bsdf::Range;
use crate::emitter::Aim;
use crate::math::kernel::KernelKind;
use crate::photon::aim::{Sights, aim};
use crate::photon::irradiance::Irradiance;
use crate::photon::trace::{Halt, TraceJob, Traced, trace_until};
use crate::photon::{Estimator, PhotonMap, radius};
use crate::sampling::mix;
use crate::scene::Scene;
use crate::settings::{Count, Indirect, Limit, Lookup, Mode, Radius, Settings};
use crate::transport::Owner;

/// What the settings say of one map.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapSettings {
    /// Light paths that were asked for.
    pub count: Count,
    /// The same after the plan: no longer left open, and none where the map is not needed.
    pub planned: Count,
    /// Search radius of the first pass.
    pub radius: Radius,
    /// Weight of a photon by its distance.
    pub kernel: KernelKind,
    /// Photons of an estimate with `lookup=nearest`.
    pub neighbours: u32,
    /// Most photons of any estimate.
    pub cap: u32,
    /// Share of new photons kept when the radius shrinks.
    pub alpha: f32,
    /// All photons within the radius, or the nearest.
    pub lookup: Lookup,
    /// A map each pass, or one for all.
    pub mode: Mode,
}

/// What belongs to one of the maps in all passes.
#[derive(Debug)]
pub(super) struct Map {
    /// What was asked for.
    pub settings: MapSettings,
    /// Which photons it holds; `key` is its family of random numbers, before the pass is mixed in.
    job: TraceJob,
    /// Where light is sent.
    pub aim: Option<Aim>,
    /// Light paths a pass.
    pub paths: u64,
    /// Search radius of the first pass; 0 where it was to be measured and the map is not needed.
    pub radius: f32,
    /// The same for photons apart.
    pub apart_radius: f32,
    /// Radius of the render over that of a pilot, which traces fewer paths; otherwise 1.
    pub finer: f32,
    /// Photons of pass 0 that were traced to measure their density.
    pub pilot: Mutex<Option<Traced>>,
}

/// A map of one pass and how it is read.
#[derive(Clone, Debug)]
pub(super) struct PassMap {
    /// What was stored.
    pub photons: PhotonMap,
    /// How it is read.
    pub estimator: Estimator,
    /// Photons with a radius of their own, and how they are read.
    pub apart: Option<(PhotonMap, Estimator)>,
    /// Known beforehand at some places.
    pub irradiance: Option<Irradiance>,
    /// Radius by which it is decided whether a surface is far enough to be read.
    pub resolved: f32,
}

/// Most photons of an estimate of focused indirect light. There are few in a pass, most of them where it is not sharp, so
/// that their radius is as wide as any; where they crowd, the nearest tell enough. With a point lamp over a glass ball, the
/// squared error of what is not seen through glass is 0.0013, 0.0011, 0.0008, 0.0007 after 3 s without limit, with 16, 8, 4.
const FOCUSED: usize = 4;

/// The pass that pilots trace: no render comes so far.
const BEFORE_ALL: u32 = u32::MAX;

impl Map {
    /// Of all light that no other owner accounts for.
    pub fn global(s: &Settings, plan: &Plan) -> Self {
        let settings = MapSettings {
            count: s.photons,
            planned: plan.global_paths,
            radius: s.radius,
            kernel: s.kernel,
            neighbours: s.neighbours.0,
            cap: u32::MAX,
            alpha: s.alpha,
            lookup: s.lookup,
            mode: s.mode,
        };
        Self::new(settings, job(s, plan, Owner::GlobalMap))
    }

    /// Of light through specular surfaces.
    pub fn caustic(s: &Settings, plan: &Plan) -> Self {
        let settings = MapSettings {
            count: s.caustic_photons,
            planned: plan.caustic_paths,
            radius: s.caustic_radius,
            kernel: s.caustic_kernel,
            neighbours: s.caustic_neighbours.0,
            cap: s.caustic_cap.0,
            alpha: s.caustic_alpha,
            lookup: s.lookup,
            mode: s.mode,
        };
        Self::new(settings, job(s, plan, Owner::CausticMap))
    }

    fn new(settings: MapSettings, job: TraceJob) -> Self {
        let pilot = Mutex::default();
        Self { settings, job, aim: None, paths: 0, radius: 0.0, apart_radius: 0.0, finer: 1.0, pilot }
    }

    /// Whether the scene needs it.
    pub fn wanted(&self) -> bool {
        self.settings.planned != Count::Paths(0)
    }

    /// Whose photons it holds.
    pub fn owner(&self) -> Owner {
        self.job.owner
    }

    /// Whether it holds the photons of glints.
    pub fn has_glints(&self) -> bool {
        self.job.glints && self.wanted()
    }

    /// Whether some of its photons have a radius of their own.
    pub fn has_apart(&self) -> bool {
        (self.job.glints || self.job.focused) && self.wanted()
    }

    /// Whether camera paths read it at their first rough surface.
    pub fn seen_directly(&self) -> bool {
        !self.job.all
    }

    /// Photons that a pass stores where that is known without a pilot, or where it is few (0).
    pub fn expected(&self) -> Option<u64> {
        match self.settings.planned {
            Count::Stored(n) => Some(n),
            Count::Paths(n) if n > MANY => None,
            _ => Some(0),
        }
    }

    /// The same told from a pilot; camera paths gather at `sights`.
    pub fn estimated(&mut self, scene: &Scene, sights: &Sights<'_>) -> u64 {
        let Count::Paths(n) = self.settings.planned else { return 0 };
        self.take_aim(scene, sights, Halt::default());
        let stored = self.pilot_photons(scene, PILOT, Halt::default());
        (n as f64 * stored as f64 / PILOT as f64) as u64
    }

    /// Decides where light is sent.
    pub fn take_aim(&mut self, scene: &Scene, sights: &Sights<'_>, halt: Halt<'_>) {
        if self.wanted() {
            // Camera paths that go on read the caustic map wherever they come, and the other one where they end.
            let sights = Sights {
                first: self.seen_directly(),
                second: sights.second || !self.seen_directly(),
                direct: self.job.next_event,
                ..*sights
            };
            self.aim = aim(scene, &self.pilot_job(PILOT), &sights, halt);
        }
    }

    /// Photons that a pilot of `paths` light paths stores.
    pub fn pilot_photons(&self, scene: &Scene, paths: u64, halt: Halt<'_>) -> u64 {
        trace_until(scene, &self.pilot_job(paths), self.aim.as_ref(), halt).photons.len() as u64
    }

    /// Of a pilot: with which radius a photon is read makes no difference to where it should land, or to how many there are.
    fn pilot_job(&self, paths: u64) -> TraceJob {
        TraceJob { focused: false, ..self.job_of(BEFORE_ALL, paths) }
    }

    /// The photons of a pass.
    pub fn trace(&self, scene: &Scene, pass: u32, paths: u64, halt: Halt<'_>) -> Traced {
        trace_until(scene, &self.job_of(pass, paths), self.aim.as_ref(), halt)
    }

    fn job_of(&self, pass: u32, paths: u64) -> TraceJob {
        let map = u64::from(self.job.owner == Owner::CausticMap);
        TraceJob { key: mix(self.job.key ^ (u64::from(pass) << 2 | map)), paths, ..self.job }
    }

    /// Radius of pass i, which is `first` in pass 0: computed from i alone, so that passes can run in any order.
    fn radius_of(&self, pass: u32, first: f32, alpha: f32) -> f32 {
        let first = f64::from(first);
        let shrunk = match self.settings.mode {
            Mode::Classic => first,
            Mode::Progressive => first * radius::shrinkage(pass, f64::from(alpha)).sqrt(),
        };
        (shrunk as f32).max(radius::LEAST)
    }

    /// Traces and sorts the photons of a pass; `None` where the scene does not need them.
    pub fn build(
        &self,
        task: &Task<'_>,
        pass: u32,
        halt: Halt<'_>,
        stats: &mut PassStats,
    ) -> Option<PassMap> {
        if !self.wanted() {
            return None;
        }
        let start = Instant::now();
        // A poisoned lock holds photons of a thread that panicked: they are traced again.
        let pilot = self.pilot.lock().ok().and_then(|mut pilot| pilot.take()).filter(|_| pass == 0);
        let traced = pilot.unwrap_or_else(|| self.trace(task.scene, pass, self.paths, halt));
        stats.cut |= traced.paths < self.paths;
        stats.trace_seconds += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let s = &self.settings;
        let radius = self.radius_of(pass, self.radius, s.alpha);
        let lobes = Range::rough(task.settings.glossy);
        let estimator =
            Estimator { lobes, ..Estimator::new(s.kernel, radius, s.lookup, s.neighbours, s.cap) };
        let photons = match s.lookup {
            Lookup::Nearest => PhotonMap::build_for_nearest(traced.photons, estimator.cap, radius),
            Lookup::Radius => PhotonMap::build(traced.photons, 2.0 * radius),
        };
        let apart = self.has_apart().then(|| {
            let radius = self.radius_of(pass, self.apart_radius, task.settings.alpha);
            let lobes = if self.job.glints { Range::glossy(task.settings.glossy) } else { lobes };
            let photons = PhotonMap::build(traced.apart, 2.0 * radius);
            let cap = if self.job.glints { usize::MAX } else { FOCUSED };
            (photons, Estimator { lobes, radius, cap, ..estimator })
        });
        let (count_apart, bytes_apart) = apart.as_ref().map_or((0, 0), |(map, _)| (map.len(), map.bytes()));
        stats.build_seconds += start.elapsed().as_secs_f64();
        stats.light_paths += traced.paths;
        stats.photons += (photons.len() + count_apart) as u64;
        stats.photon_rays += traced.rays;
        stats.rejected.add(&traced.rejected);
        stats.map_bytes += (photons.bytes() + bytes_apart) as u64;
        match self.owner() {
            Owner::CausticMap => stats.caustic_radius = radius,
            _ => stats.radius = radius,
        }
        Some(PassMap { photons, estimator, apart, irradiance: None, resolved: radius * self.finer })
    }

    /// Random numbers of the places of a pass where the map is read beforehand.
    pub fn key_of_places(&self, pass: u32) -> u64 {
        mix(self.job_of(pass, 0).key ^ 0x1aad)
    }
}

/// What the light paths of a map are traced for.
pub(super) fn job(s: &Settings, plan: &Plan, owner: Owner) -> TraceJob {
    let all = s.indirect == Indirect::Gather && owner == Owner::GlobalMap;
    TraceJob {
        key: mix(s.seed ^ 0x9d07_0b5e),
        paths: 0,
        owner,
        all,
        next_event: s.nee,
        caustic_map: plan.caustic_map,
        beams: false,
        glossy: s.glossy,
        glints: plan.glints && owner == Owner::CausticMap,
        focused: plan.focused && owner == Owner::GlobalMap && !all,
        // Behind two rough surfaces the camera path has one segment more; no limit stays none.
        max_depth: if all && s.max_depth != Limit::NONE {
            s.max_depth.0.saturating_sub(1)
        } else {
            s.max_depth.0
        },
    }
}
