//! Which estimator computes indirect light, and how a pass divides its work: measured by a pilot of the scene where the
//! settings leave it open.

mod in_media;
mod rating;

use std::fmt;
use std::sync::Arc;

use serde::Serialize;

use super::super::Task;
use super::pilot::Parts;
use super::{PhotonMapper, Plan, VolumeChoice};
use crate::emitter::{Aim, Aimed};
use crate::photon::Clearance;
use crate::photon::trace::Halt;
use crate::sampling::mix;
use crate::settings::{Count, Indirect, Mode, Samples, Settings};

use rating::{Candidate, Rated, best, rate};

/// Light paths of the pilot for each map, at most.
const PATHS: [u64; 2] = [1 << 13, 1 << 14];

/// Most camera samples a pixel in a pass, and of the whole picture: a pass should stay short.
const MOST_SAMPLES: f64 = 8.0;
const MOST_OF_PICTURE: f64 = (1 << 17) as f64;

/// Most camera samples a pixel in a pass of a picture of so many pixels.
fn most_samples(pixels: usize) -> f64 {
    (MOST_OF_PICTURE / pixels.max(1) as f64).clamp(1.0, MOST_SAMPLES)
}

/// How far the light paths of a map may be from what the plan would take.
const LEAST_SHARE: f64 = 0.25;
const MOST_SHARE: f64 = 2.0;

/// Work of the map that final gathering reads, as a share of that of the camera's samples, at least. The noise of a map is
/// the same for all pixels around, and is seen where noise of the same variance that differs from pixel to pixel is not:
/// on bunny-box, four times the light paths that are best for the squared error take 10 % more time to the same error, and
/// 40 % less to the same LDR-FLIP.
const FINE: f64 = 0.3;

/// Camera samples share what they find on diffuse surfaces where it is this much of their variance: that takes time.
const SHAREABLE: f64 = 0.4;

/// Most photons of a pass, where light hardly loses anything and a path leaves hundreds.
const MOST_STORED: f64 = (1 << 21) as f64;

/// What the pilot of the chosen estimator has measured for the render.
pub(in super::super) struct Known {
    /// Where each map sends its light.
    pub aims: [Option<Aim>; 2],
    /// The same of light in media; `None` where it was not looked for.
    pub media_aim: Option<Option<Aim>>,
    /// Where discs lie free.
    pub clearance: Option<Arc<Clearance>>,
}

/// What a pilot found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// The estimator that was taken.
    pub indirect: String,
    /// Directions in which a camera path gathers.
    pub gather_rays: u32,
    /// Whether camera samples share what they find on diffuse surfaces.
    pub shared: bool,
    /// Camera samples a pixel in each pass; without a value they follow the size of the picture.
    pub camera_samples: Option<u32>,
    /// Light paths a pass for the global map.
    pub photons: u64,
    /// The same for the caustic map.
    pub caustic_photons: u64,
    /// Where the paths of the global and of the caustic map are sent, if not as lamps emit.
    pub aims: [Option<Aimed>; 2],
    /// Error × work of the other estimators, as a factor on that of the one that was taken.
    pub others: Vec<(String, f64)>,
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.indirect)?;
        if self.indirect == Indirect::Gather.to_string() {
            let plural = if self.gather_rays == 1 { "" } else { "s" };
            write!(f, " with {} ray{plural}", self.gather_rays)?;
        }
        f.write_str(if self.shared { ", shared on diffuse surfaces" } else { "" })?;
        if let Some(samples) = self.camera_samples {
            let plural = if samples == 1 { "" } else { "s" };
            write!(f, ", {samples} camera sample{plural} a pass")?;
        }
        for (i, (name, factor)) in self.others.iter().enumerate() {
            let opening = if i == 0 { "; by a pilot, error × work of other ways:" } else { "," };
            write!(f, "{opening} {name} {factor:.2} times this")?;
        }
        Ok(())
    }
}

/// The settings with choices made where they are open, and what is known then.
pub(in super::super) fn settled<'a>(task: Task<'a>, halts: [Halt<'a>; 2]) -> (Settings, Option<Known>) {
    match choose(task, halts) {
        Some((settings, _, known)) => (settings, Some(known)),
        None => (without_choice(&task), None),
    }
}

/// What was decided before a render.
#[derive(Clone, Debug)]
pub struct Decided {
    /// The maps.
    pub plan: Plan,
    /// How indirect light is computed, where that was open.
    pub indirect: Option<Choice>,
    /// What light leaves in media.
    pub volume: Option<VolumeChoice>,
}

/// The maps of a render, and what pilots chose where something was open.
pub fn decided(task: Task<'_>) -> Decided {
    let (settings, choice, media_aim) = match choose(task, [Halt::default(); 2]) {
        Some((settings, choice, known)) => (settings, Some(choice), known.media_aim),
        None => (without_choice(&task), None, None),
    };
    let plan = Plan::new(task.facts, &settings, task.view.film.pixel_count());
    let volume = plan.volume_map.then(|| {
        let mut mapper = PhotonMapper::unmeasured(task, settings, [Halt::default(); 2]);
        mapper.volume.aim = media_aim;
        mapper.measure_media(&plan)
    });
    Decided { plan, indirect: choice, volume }
}

/// Settings where nothing has to be measured. In scenes with media, what is scattered in them is found along camera
/// paths up to the first rough surface, and no farther.
fn without_choice(task: &Task<'_>) -> Settings {
    let settings = task.settings;
    let traced = settings.indirect == Indirect::Trace && in_media::may_trace(task);
    let open = settings.indirect == Indirect::Auto || (task.facts.media && !traced);
    let indirect = if open { Indirect::Density } else { settings.indirect };
    Settings { indirect, ..settings.clone() }
}

/// Whether a pilot has to choose. Settings of the global map speak of density estimation, as in renderers that know
/// nothing else.
fn is_open(task: &Task<'_>) -> bool {
    let s = task.settings;
    let plan = Plan::new(task.facts, s, task.view.film.pixel_count());
    s.indirect == Indirect::Auto
        && !task.facts.media
        && s.mode == Mode::Progressive
        && s.nee
        && s.caustic_map
        && global_unsaid(s)
        && plan.global_map
}

/// Whether no setting of the global map was made.
fn global_unsaid(s: &Settings) -> bool {
    let d = Settings::default();
    (s.photons, s.radius, s.kernel, s.lookup) == (d.photons, d.radius, d.kernel, d.lookup)
        && (s.neighbours, s.alpha) == (d.neighbours, d.alpha)
}

fn choose<'a>(task: Task<'a>, halts: [Halt<'a>; 2]) -> Option<(Settings, Choice, Known)> {
    if task.facts.media {
        return in_media::choose(task, halts);
    }
    if !is_open(&task) {
        return None;
    }
    let rays = task.settings.gather_rays.0;
    let ways: &[(Indirect, u32)] = match rays {
        Some(n) => &[(Indirect::Gather, n), (Indirect::Density, 1), (Indirect::Trace, 1)],
        None => &[(Indirect::Gather, 1), (Indirect::Gather, 4), (Indirect::Density, 1), (Indirect::Trace, 1)],
    };
    let mut candidates: Vec<Candidate<'a>> = Vec::new();
    for &(indirect, rays) in ways {
        let mapper = pilot(task, halts, indirect, rays, &candidates);
        let first = candidates.first();
        let built = mapper.build_all(first.map(|first| (&first.built[..], same_maps(indirect))));
        let seen = mapper.look(&built);
        candidates.push(Candidate { indirect, mapper, built, seen });
    }
    let rated = rate(&task, &candidates, rays);
    let best = best(&rated)?;
    let (settings, mut choice) = divide(&task, best, &rated);
    let chosen = candidates.swap_remove(best.at).mapper;
    let power = &task.scene.emission;
    choice.aims = chosen.maps().map(|map| map.aim.as_ref().map(|aim| aim.aimed(power)));
    let aims = [chosen.global.aim, chosen.caustic.aim];
    let known = Known { aims, media_aim: None, clearance: chosen.clearance };
    Some((settings, choice, known))
}

/// Which maps of an estimator are those of the first one, which gathers: camera paths that go on read them at the same
/// places.
fn same_maps(indirect: Indirect) -> [bool; 2] {
    [indirect == Indirect::Gather, true]
}

/// A mapper for the pilot, which takes over what others have measured.
fn pilot<'a>(
    task: Task<'a>,
    halts: [Halt<'a>; 2],
    indirect: Indirect,
    rays: u32,
    others: &[Candidate<'a>],
) -> PhotonMapper<'a> {
    let automatic = Plan::new(task.facts, task.settings, task.view.film.pixel_count());
    let at_most = |count: Count, most: u64| match count {
        Count::Paths(n) => Count::Paths(n.min(most)),
        _ => Count::Paths(most),
    };
    let settings = Settings {
        indirect,
        gather_rays: Samples(Some(rays)),
        seed: mix(task.settings.seed ^ 0x0b11_0701),
        photons: at_most(automatic.global_paths, PATHS[0]),
        caustic_photons: at_most(automatic.caustic_paths, PATHS[1]),
        ..task.settings.clone()
    };
    let mut mapper = PhotonMapper::unmeasured(task, settings, halts);
    let first = others.first().map(|first| &first.mapper);
    let same = same_maps(indirect);
    let maps = first.map_or([None; 2], |first| first.maps().map(Some));
    let known = [0, 1].map(|i| maps[i].filter(|_| same[i]));
    // A map that is seen directly is read elsewhere. But if nothing was gained for all light, little will be for most.
    let none = first.is_some_and(|first| first.global.wanted() && first.global.aim.is_none());
    let aims = [none.then_some(None), None];
    mapper.clearance = first.and_then(|first| first.clearance.clone());
    mapper.prepare(aims, known);
    // How far camera paths go before they read the map is as in the render, though there are fewer photons.
    if let Count::Paths(n) = automatic.global_paths {
        mapper.global.finer = (mapper.global.paths as f32 / n.max(1) as f32).sqrt().min(1.0);
    }
    mapper
}

/// Settings with the work divided as is best for an estimator.
fn divide(task: &Task<'_>, best: Rated, all: &[Rated]) -> (Settings, Choice) {
    let given = task.settings;
    let mut settings = Settings { indirect: best.indirect, ..given.clone() };
    settings.gather_rays = Samples(Some(given.gather_rays.0.unwrap_or(best.gather_rays)));
    let useless = best.parts.shareable < SHAREABLE;
    settings.gather_radius.0 = given.gather_radius.0.or(useless.then_some(0.0));
    let plan = Plan::new(task.facts, &settings, task.view.film.pixel_count());
    let Parts { camera, maps, stored, .. } = best.parts;
    // Light paths for each camera sample of all pixels.
    let ratio = maps.map(|map| if camera.share() > 0.0 { map.share() / camera.share() } else { 0.0 });
    let usual = [plan.global_paths, plan.caustic_paths].map(|count| match count {
        Count::Paths(n) => n as f64,
        _ => 0.0,
    });
    let most = most_samples(task.view.film.pixel_count());
    let needed = |i: usize| if ratio[i] > 0.0 { usual[i] / ratio[i] } else { most };
    // What samples share takes time in every pass.
    let least = if useless { 1.0 } else { most };
    let needed = (0..2).filter(|&i| usual[i] > 0.0).map(needed).fold(least, f64::max);
    let samples = given.camera_samples.0.unwrap_or(needed.min(most).round() as u32);
    if best.indirect == Indirect::Density {
        return (settings.clone(), report(&settings, &plan, best, all));
    }
    settings.camera_samples = Samples(Some(samples));
    let paths = |i: usize| {
        let work = camera.work * f64::from(samples);
        let fine = if i == 0 && maps[0].work > 0.0 { FINE * work / maps[0].work } else { 0.0 };
        let wanted = (ratio[i] * f64::from(samples)).max(fine);
        let few = MOST_STORED / stored[i].max(1.0);
        wanted.clamp(LEAST_SHARE * usual[i], MOST_SHARE * usual[i]).min(few) as u64
    };
    if best.indirect != Indirect::Trace {
        settings.photons = Count::Paths(paths(0));
    }
    if given.caustic_photons == Count::Auto && plan.caustic_map {
        settings.caustic_photons = Count::Paths(paths(1));
    }
    let choice = report(&settings, &plan, best, all);
    (settings, choice)
}

/// What was chosen, for people. A map that is seen directly follows the plan, which knows the density that it needs.
fn report(settings: &Settings, plan: &Plan, best: Rated, all: &[Rated]) -> Choice {
    let count = |count: Count, automatic: Count| match (count, automatic) {
        (Count::Paths(n), _) | (_, Count::Paths(n)) => n,
        _ => 0,
    };
    let others = all.iter().filter(|r| r.indirect != best.indirect);
    Choice {
        indirect: best.indirect.to_string(),
        gather_rays: best.gather_rays,
        shared: best.indirect != Indirect::Density && settings.gather_radius.0 != Some(0.0),
        camera_samples: settings.camera_samples.0,
        photons: count(settings.photons, plan.global_paths),
        caustic_photons: count(settings.caustic_photons, plan.caustic_paths),
        aims: [None, None],
        others: others.map(|r| (r.indirect.to_string(), r.error / best.error)).collect(),
    }
}
