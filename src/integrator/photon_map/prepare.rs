//! Before the first pass: where light is sent, how many light paths a pass traces, and the
//! first search radii.

use std::sync::Arc;

use super::super::Task;
use super::maps::Map;
use super::medium::Look;
use super::{MOST_COST, PhotonMapper, Plan, VolumeChoice};
use crate::emitter::Aim;
use crate::photon::aim::{Line, Lines, Sights};
use crate::photon::trace::{Halt, Traced};
use crate::photon::volume::Segment;
use crate::photon::{Clearance, Stored, radius};
use crate::scene::Scene;
use crate::settings::{Count, Indirect, Radius};
use crate::transport::Owner;

/// Light paths of the pilot that estimates how many it takes to store a wanted number of photons: at first, and
/// at most where few photons come of them.
const COUNTED: u64 = 1 << 14;
const MOST_COUNTED: u64 = 1 << 18;

/// Photons that tell how many light paths it takes: their number is then known to a quarter.
const ENOUGH_COUNTED: u64 = 16;

/// Most light paths for each photon wanted: a map that hardly fills would otherwise take forever.
const MOST_PATHS_A_PHOTON: u64 = 100;

/// Half the width of a line that beams of pilots come near, of the distance between lines.
const LINE: f32 = 0.25;

impl PhotonMapper<'_> {
    /// Measures what the settings leave open. Where the `aims` of a map are given they are taken, and from a map that is
    /// the `same` all that was measured.
    pub(super) fn prepare(&mut self, aims: [Option<Option<Aim>>; 2], same: [Option<&Map>; 2]) {
        let wanted = self.maps().iter().any(|map| map.wanted());
        let places = if wanted { self.gather_places() } else { Vec::new() };
        let sights = self.sights(&places);
        let (scene, halt) = (self.task.scene, self.halts[0]);
        for ((map, aim), same) in [&mut self.global, &mut self.caustic].into_iter().zip(aims).zip(same) {
            if let Some(same) = same {
                map.take_measures(same);
                continue;
            }
            match aim {
                Some(known) => map.aim = known,
                None => map.take_aim(scene, &sights, halt),
            }
            map.count_paths(scene, halt);
            map.measure(scene, &places, halt);
        }
        let widest = self.global.radius.max(self.caustic.radius);
        if self.settings.boundary && widest > 0.0 {
            self.clearance.get_or_insert_with(|| Arc::new(Clearance::new(widest)));
        }
        let plan = Plan::new(self.task.facts, &self.settings, self.task.view.film.pixel_count());
        if plan.volume_map {
            self.measure_media(&plan);
        }
    }

    /// Measures what the settings leave open of light in media.
    pub(super) fn measure_media(&mut self, plan: &Plan) -> VolumeChoice {
        let (looks, pixel) = self.looks();
        if self.volume.aim.is_none() {
            let max_depth = self.settings.max_depth.0;
            let lines: Vec<Line<'_>> = looks.iter().map(|look| look.line(max_depth)).collect();
            let radius = LINE * pixel * self.apart();
            let lines = Lines { lines: &lines, light: &self.light_without_maps(), radius };
            self.volume.take_aim(self.task.scene, &lines, self.halts[0]);
        }
        let segments: Vec<Segment> = looks.iter().map(Look::segment).collect();
        let task = Task { settings: &self.settings, ..self.task };
        self.volume.measure(&task, plan, (&segments, pixel), self.halts[0])
    }

    /// What the camera sees, for [`Map::take_aim`].
    pub(super) fn sights<'p>(&self, places: &'p [radius::Place]) -> Sights<'p> {
        let apart = self.apart();
        let second = self.settings.indirect != Indirect::Density;
        Sights { places, apart, first: true, second, direct: true }
    }

    /// Pixels from one place of the film's grid to the next.
    fn apart(&self) -> f32 {
        let [_, _, w, h] = self.task.view.film.crop.map(|v| v as f32);
        (w * h / radius::PLACES as f32).sqrt()
    }
}

impl Map {
    fn take_measures(&mut self, same: &Self) {
        self.aim.clone_from(&same.aim);
        (self.paths, self.radius, self.apart_radius) = (same.paths, same.radius, same.apart_radius);
    }

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
                let (mut counted, mut stored) = (COUNTED, self.pilot_photons(scene, COUNTED, halt));
                while stored < ENOUGH_COUNTED && counted < MOST_COUNTED {
                    counted *= 4;
                    stored = self.pilot_photons(scene, counted, halt);
                }
                // Where none is stored, more paths would be as vain.
                match stored {
                    0 => counted,
                    _ => wanted
                        .saturating_mul(counted)
                        .div_ceil(stored)
                        .min(wanted.saturating_mul(MOST_PATHS_A_PHOTON)),
                }
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
                if self.has_apart() {
                    let apart = dense_quarter(&traced.apart, scene.sphere.radius);
                    self.apart_radius = radius::clamped(apart, pixel, scene.sphere.radius);
                }
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
        if self.apart_radius == 0.0 {
            self.apart_radius = self.radius;
        }
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
        dense_quarter(&traced.photons, scene_radius)
    }
}

/// The radius in which a quarter of the photons of caustics find the others that an estimate wants.
fn dense_quarter(photons: &Stored, scene_radius: f32) -> f32 {
    let wanted = radius::for_caustics(photons.len());
    radius::measured(photons, &radius::photon_places(photons), wanted, 0.25, scene_radius)
}
