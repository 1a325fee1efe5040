//! Before the first pass: where light is sent, how many light paths a pass traces, and the
//! first search radii.

use super::PhotonMapper;
use super::maps::Map;
use super::walk::Step;
use crate::emitter::Aim;
use crate::math::Vec2;
use crate::photon::aim::Sights;
use crate::photon::radius;
use crate::photon::trace::{Halt, Traced};
use crate::sampling::{Sampler, mix};
use crate::scene::Scene;
use crate::settings::{Count, Indirect, Radius};
use crate::transport::walk::{self, Lamps, Next};
use crate::transport::{Owner, Vertex};

/// Most rays of a camera path that the pilot follows.
const PILOT_DEPTH: u32 = 16;

/// Light paths of the pilot that estimates how many it takes to store a wanted number of photons.
const COUNTED: u64 = 1 << 14;

/// Most light paths for each photon wanted: a map that hardly fills would otherwise take forever.
const MOST_PATHS_A_PHOTON: u64 = 1000;

/// Aimed light paths are at most this many times fewer than others would be.
const MOST_COST: f64 = 8.0;

impl PhotonMapper<'_> {
    /// Measures what the settings leave open. Where `aims` of a map are given they are taken.
    pub(super) fn prepare(&mut self, aims: [Option<Option<Aim>>; 2]) {
        let wanted = self.maps().iter().any(|map| map.wanted());
        let places = if wanted { self.gather_places() } else { Vec::new() };
        let sights = self.sights(&places);
        let (scene, halt) = (self.task.scene, self.halts[0]);
        for (map, aim) in [&mut self.global, &mut self.caustic].into_iter().zip(aims) {
            match aim {
                Some(known) => map.aim = known,
                None => map.take_aim(scene, &sights, halt),
            }
            map.count_paths(scene, halt);
            map.measure(scene, &places, halt);
        }
    }

    /// What the camera sees, for [`Map::take_aim`].
    pub(super) fn sights<'p>(&self, places: &'p [radius::Place]) -> Sights<'p> {
        let [_, _, w, h] = self.task.view.film.crop.map(|v| v as f32);
        let apart = (w * h / radius::PLACES as f32).sqrt();
        let second = self.task.settings.indirect != Indirect::Density;
        Sights { places, apart, first: true, second, direct: true }
    }

    /// Where camera rays through a regular grid of the film gather.
    pub(super) fn gather_places(&self) -> Vec<radius::Place> {
        let side = (radius::PLACES as f32).sqrt() as u32;
        let [x0, y0, w, h] = self.task.view.film.crop.map(|v| v as f32);
        let full = Vec2::new(self.task.view.film.width as f32, self.task.view.film.height as f32);
        let at = |i: u32| (i as f32 + 0.5) / side as f32;
        (0..side * side)
            .filter_map(|i| {
                let film = Vec2::new(x0 + at(i % side) * w, y0 + at(i / side) * h) / full;
                self.gather_place(film, i)
            })
            .collect()
    }

    /// Where the camera ray through a position of the film gathers: the camera's walk, without light.
    fn gather_place(&self, film: Vec2, index: u32) -> Option<radius::Place> {
        let (scene, view, settings) = (self.task.scene, self.task.view, &self.settings);
        let mut sampler = Sampler::new(mix(settings.seed ^ 0x007a_d105), index);
        let mut ray = view.sensor.ray(film, sampler.next_2d());
        let mut length = view.sensor.near;
        let hidden = settings.hide_emitters && view.hidden_lamps_are_transparent;
        let mut lamps = if hidden { Lamps::Transparent } else { Lamps::Solid };
        for _ in 0..PILOT_DEPTH {
            let hit = scene.geometry.closest(&ray)?;
            length += hit.t * ray.d.length();
            let s = match walk::arrive(scene, &mut ray, Some(&hit), lamps) {
                Next::Escape => return None,
                Next::Behind => continue,
                Next::Surface(s) => s,
            };
            lamps = Lamps::Solid;
            match self.step(&Vertex::new(scene, &s, -ray.d), &mut sampler) {
                Step::Gather(_) => {
                    let n = scene.photon_side(&s, -ray.d).n;
                    let footprint = view.sensor.pixel_footprint(view.film.height, length);
                    return Some(radius::Place { p: s.p, n, lift: s.lift, footprint });
                }
                Step::Follow { wo, .. } => ray = s.leave(s.frame.to_world(wo)),
                Step::End => return None,
            }
        }
        None
    }
}

impl Map {
    /// Decides how many light paths a pass traces.
    fn count_paths(&mut self, scene: &Scene, halt: Halt<'_>) {
        self.paths = match self.settings.planned {
            // Aimed paths take longer, because more of them meet something: what they gain is not spent on more of them.
            Count::Paths(n) if self.settings.count == Count::Auto => {
                let cost = self.aim.as_ref().map_or(1.0, |aim| f64::from(aim.cost));
                ((n as f64 / cost.clamp(1.0, MOST_COST)) as u64).max(1)
            }
            Count::Paths(n) => n,
            Count::Auto => 0,
            Count::Stored(wanted) => {
                let stored = self.pilot_photons(scene, COUNTED, halt);
                let paths = wanted.saturating_mul(COUNTED).div_ceil(stored.max(1));
                paths.min(wanted.saturating_mul(MOST_PATHS_A_PHOTON))
            }
        };
    }

    /// Chooses the first radius, and more light paths where their photons fall too thin.
    fn measure(&mut self, scene: &Scene, gather_places: &[radius::Place], halt: Halt<'_>) {
        self.radius = match self.settings.radius {
            Radius::Absolute(r) => r,
            Radius::Relative(r) => r * scene.sphere.radius,
            Radius::Auto if !self.wanted() => 0.0,
            Radius::Auto => {
                let traced = self.trace(scene, 0, self.paths, halt);
                let pixel = radius::pixel(gather_places);
                let mut found = self.radius_for(&traced, gather_places, scene.sphere.radius);
                let before = self.paths;
                if self.seen_directly()
                    && self.owner() == Owner::GlobalMap
                    && self.settings.count == Count::Auto
                {
                    let more = radius::more_paths(found, pixel);
                    self.paths = (self.paths as f32 * more) as u64;
                    found /= more.sqrt();
                }
                if self.paths == before
                    && let Ok(pilot) = self.pilot.get_mut()
                {
                    *pilot = Some(traced);
                }
                // How wide a pixel is does not matter to what is mixed with much else before it is seen.
                let pixel = if self.seen_directly() { pixel } else { 0.0 };
                radius::clamped(found, pixel, scene.sphere.radius)
            }
        };
    }

    /// The radius in which an estimate finds its photons.
    fn radius_for(&self, traced: &Traced, gather_places: &[radius::Place], scene_radius: f32) -> f32 {
        if !self.seen_directly() {
            let places = radius::photon_places(&traced.photons);
            return radius::measured(&traced.photons, &places, radius::FOR_GATHERING, 0.5, scene_radius);
        }
        if self.owner() == Owner::GlobalMap {
            return radius::measured(&traced.photons, gather_places, radius::FOR_SIGHT, 0.5, scene_radius);
        }
        // Caustics are sharp where their photons crowd: their radius follows the densest quarter.
        let places = radius::photon_places(&traced.photons);
        let wanted = radius::for_caustics(traced.photons.len());
        radius::measured(&traced.photons, &places, wanted, 0.25, scene_radius)
    }
}
