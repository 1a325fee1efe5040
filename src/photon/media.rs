//! Light paths in scenes with media. As in path tracing there, straight passages cost no segment.

use super::job::{Part, TraceJob};
use super::surfaces::{holds_photons, photon, scatter};
use super::volume::flight::{Flight, fly};
use super::volume::{Beam, VolumePhoton};
use crate::bsdf::Event;
use crate::math::{Color, Ray, Vec3};
use crate::medium::MediumId;
use crate::sampling::Sampler;
use crate::scene::{LightStart, Scene, Surface};
use crate::transport::media::{MOST_PASSED, within};
use crate::transport::roulette::{self, Length};
use crate::transport::{Owner, PathClass, Smallness, Vertex};

/// A light path between two events.
struct Walk<'a> {
    scene: &'a Scene,
    job: &'a TraceJob,
    ray: Ray,
    /// How far behind its start the surface lies that it comes from.
    gap: f32,
    medium: Option<MediumId>,
    flux: Color,
    class: PathClass,
    /// Segments, this one included.
    depth: u32,
}

/// Whether a path goes on.
enum Step {
    On,
    Over,
}

/// As [`super::surfaces::follow`].
pub(super) fn follow(
    scene: &Scene,
    job: &TraceJob,
    start: &LightStart,
    sampler: &mut Sampler,
    out: &mut Part,
) -> Option<Vec3> {
    let (o, d) = (start.emission.o, start.emission.d);
    let medium = scene.lamp_medium(start.start.lamp, o, d);
    // A medium without end lets nothing through from infinity.
    if start.from_infinity && medium.is_some() {
        return None;
    }
    let mut walk = Walk {
        scene,
        job,
        ray: Ray::new(o, d),
        gap: 0.0,
        medium,
        flux: start.emission.flux / job.paths as f32,
        class: PathClass::FROM_LAMP,
        depth: 1,
    };
    let mut first = None;
    // Between boundaries that let everything pass a path might otherwise have no end.
    for _ in 0..MOST_PASSED {
        out.rays += 1;
        let hit = scene.geometry.closest(&walk.ray);
        let end = hit.as_ref().map_or(f32::INFINITY, |hit| hit.t);
        let step = match walk.through_medium(end, sampler, out) {
            Some(step) => step,
            None => {
                let Some(hit) = hit else { return first };
                let surface = scene.surface(&walk.ray, &hit);
                first.get_or_insert(surface.p);
                walk.at_surface(&surface, sampler, out)
            }
        };
        if let Step::Over = step {
            return first;
        }
    }
    first
}

impl Walk<'_> {
    /// Whether light of this class in a medium is kept: all but what next event estimation owns.
    fn kept(&self) -> bool {
        let owned = self.class == PathClass::FROM_LAMP && self.job.next_event;
        self.job.owner == Owner::VolumeMaps && !owned
    }

    /// Goes to `end`. `None` if it comes there.
    fn through_medium(&mut self, end: f32, sampler: &mut Sampler, out: &mut Part) -> Option<Step> {
        let MediumId(index) = self.medium?;
        let medium = &self.scene.media[index as usize];
        let ray = within(&self.ray, self.gap, end);
        let kept = self.kept();
        let (beams, depth) = (kept && self.job.beams, self.depth.min(255) as u8);
        let mut way = |from: f32, to: f32, flux: Color| {
            let beam = Beam { o: ray.at(from), d: ray.d, length: to - from, flux, medium: index, depth };
            if beams && to > from {
                keep(beam, out);
            }
        };
        let t = match fly(medium, &ray, &mut self.flux, sampler, &mut way) {
            Flight::Passed => return None,
            Flight::Absorbed => return Some(Step::Over),
            Flight::Scattered(t) => t,
        };
        let (p, wi) = (ray.at(t), -ray.d);
        if kept && !self.job.beams {
            let photon = VolumePhoton { p, flux: self.flux, wi, medium: index, depth };
            keep_point(photon, out);
        }
        // The caustic map holds nothing of what a medium scattered.
        if self.job.owner == Owner::CausticMap || self.is_last() {
            return Some(Step::Over);
        }
        let (pick, u) = (sampler.next_1d(), sampler.next_2d());
        let Some(next) = medium.phase().sample(p, wi, pick, u) else { return Some(Step::Over) };
        self.class = self.class.after_light_medium();
        (self.ray, self.gap) = (Ray::new(p, next.wo), 0.0);
        Some(self.survive(self.flux * next.weight, sampler))
    }

    fn at_surface(&mut self, s: &Surface, sampler: &mut Sampler, out: &mut Part) -> Step {
        let (scene, job) = (self.scene, self.job);
        let vertex = Vertex::new(scene, s, -self.ray.d);
        let kept = self.class.owner(job.next_event, job.caustic_map) == job.owner;
        if kept && holds_photons(scene, job, &vertex) {
            let n = scene.photon_side(s, vertex.back).n;
            let light = (self.flux, self.class, self.depth);
            out.photons.extend(photon(&vertex, n, light, Smallness::default(), &mut out.rejected));
        }
        let Some((d, next, event)) = scatter(scene, job, &vertex, self.flux, sampler) else {
            return Step::Over;
        };
        self.medium = scene.medium_beyond(s, d, self.medium);
        (self.ray, self.gap) = (s.leave(d), s.gap(d));
        if event == Event::Null {
            self.flux = next;
            return Step::On;
        }
        if self.is_last() {
            return Step::Over;
        }
        self.class = self.class.after_light_event(event);
        self.survive(next, sampler)
    }

    /// A photon at the next event needs two more segments: there, and from there to the camera.
    fn is_last(&self) -> bool {
        self.depth.saturating_add(2) > self.job.max_depth
    }

    /// Russian roulette for a path that carries `next` on.
    fn survive(&mut self, next: Color, sampler: &mut Sampler) -> Step {
        let length = Length { segments: self.depth, most: self.job.max_depth };
        let survival = roulette::light_survival_in_media(self.flux, next, length);
        self.depth += 1;
        self.flux = next;
        if survival < 1.0 {
            let Some(survivor) = roulette::survivor(next, survival, sampler) else { return Step::Over };
            self.flux = survivor;
        }
        Step::On
    }
}

fn keep_point(photon: VolumePhoton, out: &mut Part) {
    if !photon.p.is_finite() {
        out.rejected.photon_place += 1;
    } else if !photon.flux.is_finite() {
        out.rejected.photon_flux += 1;
    } else {
        out.points.push(photon);
    }
}

fn keep(beam: Beam, out: &mut Part) {
    if !beam.o.is_finite() || !beam.length.is_finite() {
        out.rejected.photon_place += 1;
    } else if !beam.flux.is_finite() {
        out.rejected.photon_flux += 1;
    } else {
        out.beams.push(beam);
    }
}
