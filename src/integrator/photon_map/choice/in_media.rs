//! The choice in scenes with media: photons at collisions, beams, or path tracing, as a pilot measures them.
//!
//! Passes of the pilot are as those of the render, of a smaller picture if that has many pixels. So nothing but the
//! shrinking of radii is left to tell of the error that a render of each kind will have, and no division of its work has
//! to be found but that into passes.

use super::super::super::{Integrator, Task};
use super::super::pilot::{Parts, Reference, Seen};
use super::super::{PhotonMapper, Plan};
use super::rating::{PASSES, with_bias};
use super::{Choice, Known, global_unsaid, most_samples};
use crate::photon::radius;
use crate::photon::trace::Halt;
use crate::sampling::mix;
use crate::scene::View;
use crate::settings::{Count, InMedia, Indirect, Mode, Samples, Settings};

/// Most pixels of the picture that the pilot has in mind: its photons are as many for each pixel as those of the render.
const MOST_PIXELS: usize = 1 << 14;

/// What a pass of the pilot may leave is at least this share of what a pass of the render may.
const LEAST_SHARE: f64 = 1.0 / 64.0;

/// A way to render, as the pilot saw it.
struct Candidate<'a> {
    name: &'static str,
    mapper: PhotonMapper<'a>,
    seen: Seen,
}

/// The same with the division of its work that is best.
#[derive(Clone, Copy, Debug)]
struct Rated {
    /// Camera samples a pixel in each pass.
    samples: u32,
    /// Variance × work.
    error: f64,
}

/// Whether path tracing may take the place of photon mapping: not where light gets through specular or glossy surfaces,
/// which camera paths hardly find.
pub(super) fn may_trace(task: &Task<'_>) -> bool {
    task.facts.media && !task.facts.sharper_than(task.settings.glossy)
}

/// Settings with what a pilot chose; `None` where there is nothing to choose.
pub(super) fn choose<'a>(task: Task<'a>, halts: [Halt<'a>; 2]) -> Option<(Settings, Choice, Known)> {
    let ways = ways(&task);
    if ways.len() < 2 {
        return None;
    }
    let film = task.view.film.with_fewer_pixels(MOST_PIXELS);
    let view = View { film, ..task.view.clone() };
    let smaller = Task { view: &view, ..task };
    let most = (view.film.pixel_count() as f64 / task.view.film.pixel_count() as f64).max(LEAST_SHARE);
    let mut candidates: Vec<Candidate<'_>> = Vec::new();
    for (name, settings) in ways {
        let first = candidates.first().map(|first| &first.mapper);
        let mapper = pilot(smaller, settings, (halts, most), first);
        let seen = mapper.look_at_passes();
        candidates.push(Candidate { name, mapper, seen });
    }
    let reference = Reference::of(&candidates.iter().map(|c| &c.seen).collect::<Vec<_>>());
    let rated: Vec<Rated> = candidates.iter().map(|c| rate(&task, c, &reference)).collect();
    let (best, _) = rated
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.error.total_cmp(&b.1.error))
        .filter(|b| b.1.error > 0.0)?;
    let factor = |i: usize| rated[i].error / rated[best].error;
    let others = (0..rated.len()).filter(|&i| i != best).map(|i| (candidates[i].name.to_owned(), factor(i)));
    let others: Vec<_> = others.collect();
    let Candidate { mapper, .. } = candidates.swap_remove(best);
    let PhotonMapper { settings: ref tried, global, caustic, volume, clearance, .. } = mapper;
    let samples = Samples(Some(task.settings.camera_samples.0.unwrap_or(rated[best].samples)));
    let settings = Settings { seed: task.settings.seed, camera_samples: samples, ..tried.clone() };
    let plan = Plan::new(task.facts, &settings, task.view.film.pixel_count());
    let paths = |count: Count| if let Count::Paths(n) = count { n } else { 0 };
    let power = &task.scene.emission;
    let choice = Choice {
        indirect: settings.indirect.to_string(),
        gather_rays: 1,
        shared: false,
        camera_samples: samples.0,
        photons: paths(plan.global_paths),
        caustic_photons: paths(plan.caustic_paths),
        aims: [&global, &caustic].map(|map| map.aim.as_ref().map(|aim| aim.aimed(power))),
        others,
    };
    let known = Known { aims: [global.aim, caustic.aim], media_aim: volume.aim, clearance };
    Some((settings, choice, known))
}

/// The ways that the settings leave open, each with settings that mean it.
fn ways(task: &Task<'_>) -> Vec<(&'static str, Settings)> {
    let s = task.settings;
    let density = Settings { indirect: Indirect::Density, ..s.clone() };
    let plan = Plan::new(task.facts, &density, task.view.film.pixel_count());
    let mut ways = Vec::new();
    if s.mode != Mode::Progressive || !matches!(s.indirect, Indirect::Auto | Indirect::Density) {
        return ways;
    }
    if plan.volume_map && s.beams == InMedia::Auto {
        ways.push(("beams", Settings { beams: InMedia::Beams, ..density.clone() }));
        ways.push(("photons at collisions", Settings { beams: InMedia::Points, ..density }));
    } else if plan.volume_map || plan.global_map {
        ways.push(("density", density));
    }
    if s.indirect == Indirect::Auto && s.nee && all_unsaid(s) && may_trace(task) {
        ways.push(("trace", Settings { indirect: Indirect::Trace, ..s.clone() }));
    }
    ways
}

/// Whether no setting of the maps was made that paths would do without.
fn all_unsaid(s: &Settings) -> bool {
    let d = Settings::default();
    global_unsaid(s)
        && (s.volume_photons, s.volume_radius, s.beams) == (d.volume_photons, d.volume_radius, d.beams)
        && (s.volume_neighbours, s.volume_alpha) == (d.volume_neighbours, d.volume_alpha)
}

/// A mapper of the pilot; what has nothing to do with media is as in the first.
fn pilot<'a>(
    task: Task<'a>,
    settings: Settings,
    (halts, most): ([Halt<'a>; 2], f64),
    first: Option<&PhotonMapper<'a>>,
) -> PhotonMapper<'a> {
    let settings = Settings { seed: mix(task.settings.seed ^ 0x0b11_0702), ..settings };
    let same = settings.indirect == Indirect::Density;
    let mut mapper = PhotonMapper::unmeasured(task, settings, halts);
    let known = first.filter(|_| same).map_or([None; 2], |first| first.maps().map(Some));
    mapper.volume.most = most;
    mapper.volume.aim = first.and_then(|first| first.volume.aim.clone());
    mapper.clearance = first.and_then(|first| first.clearance.clone());
    mapper.prepare([None, None], known);
    mapper
}

/// The error of a render with passes in which the camera samples are as many as is best.
fn rate(task: &Task<'_>, candidate: &Candidate<'_>, reference: &Reference) -> Rated {
    let most = most_samples(task.view.film.pixel_count());
    let settings = &candidate.mapper.settings;
    // In media it is the width of a kernel that shrinks, or its area; on surfaces it is the area.
    let alpha = f64::from(settings.volume_alpha.min(settings.alpha));
    let scale = [radius::growth(PASSES, alpha), 1.0];
    let Parts { camera, maps: [map, _], .. } =
        candidate.seen.parts(reference, scale, candidate.mapper.task.view.film.pixel_count());
    let usual = candidate.mapper.samples_a_pass();
    let ratio = if map.share() > 0.0 { camera.share() / map.share() } else { f64::from(usual) };
    let best = ratio.round().clamp(f64::from(usual).min(most), most);
    let samples = settings.camera_samples.0.unwrap_or(best as u32).max(1);
    let variance = camera.variance / f64::from(samples) + map.variance;
    let work = camera.work * f64::from(samples) + map.work;
    Rated { samples, error: variance * work * with_bias(settings.indirect) }
}
