//! Estimators by the error that a pilot measured of each.

use super::super::super::Task;
use super::super::pilot::{BuiltMap, Parts, Reference, Seen};
use super::super::{PhotonMapper, Plan};
use crate::photon::radius;
use crate::settings::{Count, Indirect, Settings};

/// Most directions in which a camera path gathers.
const MOST_RAYS: f64 = 8.0;

/// What the measured error of an estimator is multiplied by before they are compared. The pilot does not see bias: a map
/// that is seen directly is blurred by its radius, one at the second surface hardly, and without one there is none.
pub(super) fn with_bias(indirect: Indirect) -> f64 {
    match indirect {
        Indirect::Density => 2.0,
        Indirect::Trace => 0.85,
        Indirect::Gather | Indirect::Auto => 1.0,
    }
}

/// Passes of the render that the pilot has in mind, in which radii shrink.
pub(super) const PASSES: u32 = 16;

/// One estimator as the pilot saw it.
pub(super) struct Candidate<'a> {
    pub indirect: Indirect,
    pub mapper: PhotonMapper<'a>,
    /// Maps of each pass.
    pub built: Vec<[BuiltMap; 2]>,
    pub seen: Seen,
}

/// An estimator with the best division of its work.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rated {
    pub indirect: Indirect,
    pub gather_rays: u32,
    pub parts: Parts,
    /// Variance × work.
    pub error: f64,
    /// Which of the candidates was measured for it.
    pub at: usize,
}

/// All candidates, and final gathering with the best number of directions.
pub(super) fn rate(task: &Task<'_>, candidates: &[Candidate<'_>], rays: Option<u32>) -> Vec<Rated> {
    let looks: Vec<&Seen> = candidates.iter().map(|c| &c.seen).collect();
    let reference = Reference::of(&looks);
    let pixels = task.view.film.pixel_count();
    // All candidates gather first at the same places.
    let pixel = candidates.first().map_or(0.0, |c| radius::pixel(&c.mapper.gather_places()));
    let rated = |(at, c): (usize, &Candidate<'_>)| {
        let parts = c.seen.parts(&reference, scale(task, &c.mapper, pixel), pixels);
        let gather_rays = c.mapper.settings.gather_rays.0.unwrap_or(1);
        Rated { indirect: c.indirect, gather_rays, parts, error: error(&parts), at }
    };
    let mut all: Vec<Rated> = candidates.iter().enumerate().map(rated).collect();
    if rays.is_none()
        && let [one, four, ..] = all[..]
    {
        all.splice(..2, [best_rays([one, four])]);
    }
    all
}

/// By how much the variance of a photon differs in the render: it goes with the area of the disc where a map is seen
/// directly, and not where a pixel sees the mean over many discs. `pixel` is the size of a pixel where the camera gathers.
fn scale(task: &Task<'_>, mapper: &PhotonMapper<'_>, pixel: f32) -> [f64; 2] {
    let settings = Settings { indirect: mapper.settings.indirect, ..task.settings.clone() };
    let plan = Plan::new(task.facts, &settings, task.view.film.pixel_count());
    let wanted = [plan.global_paths, plan.caustic_paths];
    let mut scales = [1.0; 2];
    for ((map, wanted), scale) in mapper.maps().into_iter().zip(wanted).zip(&mut scales) {
        if let Count::Paths(n) = wanted
            && map.paths > 0
            && map.seen_directly()
        {
            let in_render = map.radius * (map.paths as f32 / n.max(1) as f32).sqrt();
            let in_render = radius::clamped(in_render, pixel, task.scene.sphere.radius);
            let area = f64::from(map.radius / in_render.max(radius::LEAST)).powi(2);
            *scale = area * radius::growth(PASSES, f64::from(map.settings.alpha));
        }
    }
    scales
}

/// Variance × work of the best division: (Σ √(variance · work))².
fn error(parts: &Parts) -> f64 {
    (parts.camera.root() + parts.maps[0].root() + parts.maps[1].root()).powi(2)
}

/// The best number of directions, told from one and four: variance is a + b/n, work is c + d·n, and their
/// product is least at n = √(b·c / (a·d)).
fn best_rays([one, four]: [Rated; 2]) -> Rated {
    let line = |a: f64, b: f64| ((b - a) / 3.0, a - (b - a) / 3.0);
    let [v1, v4] = [one, four].map(|r| r.parts.camera.variance);
    let b = ((v1 - v4) / 0.75).clamp(0.0, v1);
    let a = v1 - b;
    let (d, c) = line(one.parts.camera.work, four.parts.camera.work);
    let n = if a * d > 0.0 { (b * c.max(0.0) / (a * d)).sqrt() } else { MOST_RAYS };
    let n = n.clamp(1.0, MOST_RAYS).round();
    let mut found = if n <= 2.0 { one } else { four };
    found.gather_rays = n as u32;
    found.parts.camera.variance = a + b / n;
    found.parts.camera.work = c + d * n;
    found.error = error(&found.parts);
    found
}

/// The candidate with the least error.
pub(super) fn best(rated: &[Rated]) -> Option<Rated> {
    let cost = |r: &Rated| r.error * with_bias(r.indirect);
    rated.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).copied()
}
