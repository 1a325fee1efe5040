//! Photon mapping: camera paths end at the first rough surface, where direct light is sampled and
//! everything else is read from the photon maps.
//!
//! [`prepare`] measures what the settings leave open, [`maps`] traces and builds the maps of a pass,
//! [`walk`] follows a camera path to where it gathers, and [`gather`] reads the maps there.

mod choice;
mod gather;
mod glints;
mod maps;
mod medium;
mod onward;
mod pilot;
mod places;
mod plan;
mod prepare;
mod sharing;
mod volume;
mod walk;
mod work;

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::images::{self, Images};
use super::{CameraSample, Integrator, PassStats, Scratch, Task, VolumePathTracer};
use crate::bsdf::Range;
use crate::photon::irradiance::Irradiance;
use crate::photon::trace::Halt;
use crate::photon::{Clearance, Surroundings};
use crate::sampling::mix;
use crate::settings::{Indirect, Mode, Settings};

pub use choice::{Choice, Decided, decided};
use maps::{Map, PassMap};
pub use onward::Onward;
pub use plan::Plan;
pub use volume::VolumeChoice;
use volume::{PassVolume, VolumeMap};

/// Numbers that every pass uses.
#[derive(Debug)]
pub struct PhotonMapper<'a> {
    task: Task<'a>,
    /// Those of the task, with what was measured in place of what they leave open.
    settings: Settings,
    /// For pass 0, and for the passes after it.
    halts: [Halt<'a>; 2],
    global: Map,
    caustic: Map,
    /// Where discs lie free.
    clearance: Option<Arc<Clearance>>,
    volume: VolumeMap,
    /// Finds what media scatter once, in scenes with media.
    single: Option<VolumePathTracer<'a>>,
    /// Takes the place of everything else in scenes with media that are path traced.
    traced: Option<VolumePathTracer<'a>>,
    /// Of lamps that look smaller than a pixel.
    images: Option<Images>,
    /// Classic mode traces once.
    kept: OnceLock<Arc<Maps>>,
}

/// The maps of a pass.
#[derive(Debug)]
pub struct Maps {
    global: Option<Arc<PassMap>>,
    caustic: Option<Arc<PassMap>>,
    volume: Option<PassVolume>,
}

/// Light paths of the pilot that tells how many photons a pass will leave.
const PILOT: u64 = 1 << 17;

/// Light paths above which a pilot counts the photons that they will leave, before memory is taken for
/// them.
const MANY: u64 = 4 << 20;

/// Aimed light paths are at most this many times fewer than others would be.
const MOST_COST: f64 = 8.0;

impl<'a> PhotonMapper<'a> {
    /// Measures what the settings leave open: path counts from a pilot, radii from the density of the
    /// first pass. Deterministic: a resumed render measures the same.
    pub fn new(task: Task<'a>) -> Self {
        Self::halting(task, [Halt::default(); 2])
    }

    /// [`PhotonMapper::new`] with one limit for pass 0 and what is measured before it, and one for the passes after it.
    pub fn halting(task: Task<'a>, halts: [Halt<'a>; 2]) -> Self {
        let (settings, known) = choice::settled(task, halts);
        let mut mapper = Self::unmeasured(task, settings, halts);
        let aims = known.map(|known| {
            mapper.clearance = known.clearance;
            mapper.volume.aim = known.media_aim;
            known.aims.map(Some)
        });
        mapper.prepare(aims.unwrap_or_default(), [None; 2]);
        mapper.images = images::search(mapper.task());
        mapper
    }

    fn unmeasured(task: Task<'a>, settings: Settings, halts: [Halt<'a>; 2]) -> Self {
        let plan = Plan::new(task.facts, &settings, task.view.film.pixel_count());
        let (global, caustic) = (Map::global(&settings, &plan), Map::caustic(&settings, &plan));
        let volume = VolumeMap::new(&settings, &plan);
        let traced = task.facts.media && settings.indirect == Indirect::Trace;
        Self {
            task,
            settings,
            halts,
            global,
            caustic,
            clearance: None,
            volume,
            single: task.facts.media.then(|| VolumePathTracer::once(task)),
            traced: traced.then(|| VolumePathTracer::new(task)),
            images: None,
            kept: OnceLock::new(),
        }
    }

    /// The task with the settings that are in use.
    fn task(&self) -> Task<'_> {
        Task { settings: &self.settings, ..self.task }
    }

    /// Photons that a pass is expected to store in the global and in the caustic map, for a look at the
    /// memory before they are traced. 0 where the settings ask for few.
    pub fn expected_photons(task: Task<'a>) -> [u64; 2] {
        let mut mapper = Self::unmeasured(task, task.settings.clone(), [Halt::default(); 2]);
        if mapper.maps().iter().all(|map| map.expected().is_some()) {
            return mapper.maps().map(|map| map.expected().unwrap_or(0));
        }
        let places = mapper.gather_places();
        let sights = mapper.sights(&places);
        let Self { global, caustic, .. } = &mut mapper;
        [global, caustic].map(|map| map.expected().unwrap_or_else(|| map.estimated(task.scene, &sights)))
    }

    fn maps(&self) -> [&Map; 2] {
        [&self.global, &self.caustic]
    }

    /// A map of a pass; one that is not seen directly is read beforehand at some of the places where camera paths
    /// will read it.
    fn build(&self, map: &Map, pass: u32, halt: Halt<'_>, stats: &mut PassStats) -> Option<Arc<PassMap>> {
        let mut built = map.build(&self.task(), pass, halt, stats)?;
        if !map.seen_directly() {
            let start = Instant::now();
            let key = map.key_of_places(pass);
            let count = (map.paths / 2).clamp(1024, u64::from(u32::MAX)) as u32;
            let (places, found) = self.second_places(key, count);
            let around = self.surroundings();
            let (known, rays) = Irradiance::of(&places, &built.photons, &built.estimator, around, mix(key));
            stats.build_seconds += start.elapsed().as_secs_f64();
            stats.photon_rays += found + rays;
            stats.map_bytes += known.bytes() as u64;
            built.irradiance = Some(known);
        }
        Some(Arc::new(built))
    }

    /// What the boundary test looks at, unless it is off.
    fn surroundings(&self) -> Option<Surroundings<'_>> {
        let (scene, facts, clearance) = (self.task.scene, self.task.facts, self.clearance.as_deref());
        self.settings.boundary.then_some(Surroundings { scene, facts, clearance })
    }

    /// Lobes that light is gathered from photons for.
    fn rough(&self) -> Range {
        Range::rough(self.settings.glossy)
    }

    /// Lobes that camera paths follow like mirrors.
    fn glossy(&self) -> Range {
        Range::glossy(self.settings.glossy)
    }
}

/// Below this number of pixels, one camera sample a pixel leaves more noise than the photons do, and costs hardly any
/// time: a pass then takes several.
const SMALL_PICTURE: u32 = 1 << 14;

impl Integrator for PhotonMapper<'_> {
    type Pass = Arc<Maps>;

    const STRATIFIED_PAIRS: u32 = 16;

    fn first_radii(&self) -> [f32; 2] {
        self.maps().map(|map| map.radius)
    }

    fn samples_a_pass(&self) -> u32 {
        let film = &self.task.view.film;
        let pixels = film.width.saturating_mul(film.height).max(1);
        let least = if self.settings.indirect == Indirect::Density { 1 } else { 4 };
        self.settings.camera_samples.0.unwrap_or((SMALL_PICTURE / pixels).clamp(least, 64))
    }

    fn follows_noise(&self) -> bool {
        // A number of samples that was asked for is that of every pixel.
        self.task.settings.camera_samples.0.is_none()
    }

    fn images(&self) -> Option<&Images> {
        self.images.as_ref()
    }

    fn sharing(&self, pass: u32) -> Option<f32> {
        if self.task.facts.media {
            return None;
        }
        let crop = self.task.view.film.crop;
        sharing::radius(&self.settings, crop[2].min(crop[3]), pass)
    }

    fn begin_pass(&self, pass: u32) -> (Arc<Maps>, PassStats) {
        let mut stats = PassStats::default();
        let mut make = |pass| {
            let halt = self.halts[usize::from(pass > 0)];
            let mut build = |map: &Map| self.build(map, pass, halt, &mut stats);
            let (global, caustic) = (build(&self.global), build(&self.caustic));
            let volume = self.volume.build(self.task.scene, pass, halt, &mut stats);
            Arc::new(Maps { global, caustic, volume })
        };
        let maps = match self.settings.mode {
            Mode::Progressive => make(pass),
            Mode::Classic => self.kept.get_or_init(|| make(0)).clone(),
        };
        (maps, stats)
    }

    fn sample(&self, maps: &Arc<Maps>, samples: &mut [CameraSample], scratch: &mut Scratch) {
        if let Some(tracer) = &self.traced {
            tracer.sample(&(), samples, scratch);
            return;
        }
        if self.task.facts.media {
            samples.iter_mut().for_each(|sample| self.trace_in_media(maps, sample, scratch));
            return;
        }
        if self.settings.indirect != Indirect::Density {
            self.go_on(maps, samples, scratch);
            return;
        }
        for sample in samples {
            sample.out = self.trace(maps, sample, scratch);
        }
    }
}
