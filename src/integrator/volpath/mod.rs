//! Path tracing through participating media: the unbiased oracle of scenes that have them, in the conventions of
//! Mitsuba's `volpath`. A scattering in a medium counts like one at a surface, a straight passage not at all.
//!
//! Media are sampled by the density that the mean of the lanes has ([`Carried`]). At every scattering one shadow ray is
//! weighed against the scattered ray, with the probability of coming through the media in between as part of the
//! latter's density. On the way, light of near lamps is also looked for at a place that is drawn by the angle under
//! which the lamp sees it (module [`near`]).

mod connect;
mod near;
mod once;

use super::{CameraSample, Integrator, PassStats, Scratch, Task};
use crate::bsdf::{Event, Transport};
use crate::math::{Color, Ray, Vec2, Vec3};
use crate::medium::{Carried, Medium, MediumId};
use crate::sampling::Sampler;
use crate::scene::{Facts, Hit, Scene, Surface};
use crate::transport::media::{MOST_PASSED, within};
use crate::transport::roulette::Length;
use crate::transport::{PathClass, Vertex, roulette};
use connect::Scattering;
use near::Pivot;

use super::direct::power_heuristic;

/// See the module.
#[derive(Debug)]
pub struct VolumePathTracer<'a> {
    scene: &'a Scene,
    facts: &'a Facts,
    medium: Option<MediumId>,
    max_depth: u32,
    rr_depth: u32,
    /// Glossy surfaces count as specular ones: it decides the layer, never the sum.
    glossy: f32,
    hide_emitters: bool,
    /// Hidden lamps let camera rays pass.
    see_through: bool,
    /// A lamp stands at a finite distance.
    near_lamps: bool,
}

impl<'a> VolumePathTracer<'a> {
    /// Takes what it needs of the task; nothing is measured.
    pub fn new(task: Task<'a>) -> Self {
        let settings = task.settings;
        Self {
            scene: task.scene,
            facts: task.facts,
            medium: task.view.medium,
            max_depth: settings.max_depth.0,
            rr_depth: settings.rr_depth,
            glossy: settings.glossy,
            hide_emitters: settings.hide_emitters,
            see_through: task.view.hidden_lamps_are_transparent,
            near_lamps: task.scene.emitters.iter().any(|e| e.place(Vec2::splat(0.5)).is_some()),
        }
    }
}

/// A path between two events.
#[derive(Clone, Copy, Debug)]
struct Walk {
    ray: Ray,
    /// How far behind its start the surface lies that it comes from.
    gap: f32,
    medium: Option<MediumId>,
    /// Its reach begins at the last scattering.
    carried: Carried,
    eta: f32,
    /// Of the light that it meets next.
    class: PathClass,
    /// Density and place of the last rough scattering; 0 where lamps count in full.
    pdf: f32,
    from: Vec3,
    /// Scatterings so far.
    depth: u32,
    /// Straight passages so far.
    passed: u32,
}

impl Walk {
    fn new(ray: Ray, medium: Option<MediumId>, throughput: Color) -> Self {
        Self {
            ray,
            gap: 0.0,
            medium,
            carried: Carried::new(throughput),
            eta: 1.0,
            class: PathClass::FROM_CAMERA,
            pdf: 0.0,
            from: ray.o,
            depth: 0,
            passed: 0,
        }
    }
}

impl Integrator for VolumePathTracer<'_> {
    type Pass = ();

    const STRATIFIED_PAIRS: u32 = 12;

    fn begin_pass(&self, _: u32) -> ((), PassStats) {
        ((), PassStats::default())
    }

    fn sample(&self, _: &(), samples: &mut [CameraSample], scratch: &mut Scratch) {
        for sample in samples {
            self.trace(sample, scratch);
        }
    }
}

/// Whether a path goes on.
enum Step {
    On,
    Over,
}

impl VolumePathTracer<'_> {
    fn trace(&self, sample: &mut CameraSample, scratch: &mut Scratch) {
        let mut walk = Walk::new(sample.ray.normalised(), self.medium, Color::ONE);
        self.go_on(&mut walk, sample, scratch);
    }

    /// Follows a path to its end.
    fn go_on(&self, walk: &mut Walk, sample: &mut CameraSample, scratch: &mut Scratch) {
        while walk.depth < self.max_depth && walk.passed < MOST_PASSED && walk.carried.alive() {
            scratch.rays += 1;
            let hit = self.scene.geometry.closest(&walk.ray);
            if let Step::Over = self.step(walk, hit.as_ref(), sample, scratch) {
                return;
            }
        }
    }

    /// A ray: through the medium, to what it comes to.
    fn step(
        &self,
        walk: &mut Walk,
        hit: Option<&Hit>,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) -> Step {
        if let Some(medium) = self.scene.medium(walk.medium) {
            let part = within(&walk.ray, walk.gap, hit.map_or(walk.ray.tmax, |hit| hit.t));
            if let Some(step) = self.through(medium, &part, walk, sample, scratch) {
                return step;
            }
        }
        let Some(hit) = hit else {
            self.add_background(walk, sample);
            return Step::Over;
        };
        let s = self.scene.surface(&walk.ray, hit);
        let hidden = self.hide_emitters && walk.depth == 0;
        if hidden && self.see_through && self.scene.is_lamp(&s) {
            self.pass(walk, &s, hit.t);
            return Step::On;
        }
        self.add_emitted(walk, &s, hidden, sample);
        self.scatter_at(walk, &s, hit.t, sample, scratch)
    }

    /// Through the medium along `part`; `None` at its end, unscattered.
    fn through(
        &self,
        medium: &Medium,
        part: &Ray,
        walk: &mut Walk,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) -> Option<Step> {
        let lamp = self.lamp_numbers(&mut sample.sampler);
        let pivot = self.pivot(medium, part, walk, lamp);
        if let Some(pivot) = &pivot {
            self.light_near(medium, part, walk, (pivot, lamp), sample, scratch);
        }
        let before = walk.carried;
        let mut emitted = Color::ZERO;
        let t = medium.fly(part, &mut walk.carried, &mut emitted, &mut sample.sampler);
        sample.out.add(walk.class.layer(), emitted);
        let t = t?;
        let share =
            pivot.map_or(1.0, |pivot| pivot.share_of_flight((medium, part), [&before, &walk.carried], t));
        Some(self.scatter_in(medium, walk, part.at(t), (lamp, share), sample, scratch))
    }

    /// Straight on behind a surface.
    fn pass(&self, walk: &mut Walk, s: &Surface, t: f32) {
        walk.medium = self.scene.medium_beyond(s, walk.ray.d, walk.medium);
        walk.ray = Ray { tmax: walk.ray.tmax - t, ..s.leave(walk.ray.d) };
        walk.gap = s.gap(walk.ray.d);
        walk.passed += 1;
    }

    /// Share of light that next event estimation finds with density `pdf_direct`.
    fn weight(walk: &Walk, pdf_direct: f32) -> f32 {
        if walk.pdf > 0.0 { power_heuristic(walk.pdf * walk.carried.reach, pdf_direct) } else { 1.0 }
    }

    fn add_background(&self, walk: &Walk, sample: &mut CameraSample) {
        if self.hide_emitters && walk.depth == 0 {
            return;
        }
        for (radiance, pdf) in self.scene.background(walk.from, walk.ray.d) {
            sample.out.add(walk.class.layer(), walk.carried.weight * radiance * Self::weight(walk, pdf));
        }
    }

    fn add_emitted(&self, walk: &Walk, s: &Surface, hidden: bool, sample: &mut CameraSample) {
        let emitted = self.scene.emitted(s, -walk.ray.d);
        if emitted.max_element() > 0.0 && !hidden {
            sample.out.alpha = 1.0;
            let weight = Self::weight(walk, self.scene.pdf_direct_surface(walk.from, walk.ray.d, s));
            sample.out.add(walk.class.layer(), walk.carried.weight * emitted * weight);
        }
    }

    /// Scatters in a medium, at `p`. With the numbers of a lamp comes the share of its light that this
    /// place has. They were drawn before it was known whether a place near that lamp is looked for: new ones would be
    /// of another lamp, and those for which no place was looked for would count too little.
    fn scatter_in(
        &self,
        medium: &Medium,
        walk: &mut Walk,
        p: Vec3,
        (lamp, share): ((f32, Vec2), f32),
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) -> Step {
        let wi = -walk.ray.d;
        sample.out.alpha = 1.0;
        walk.class = walk.class.after_camera_medium();
        walk.depth += 1;
        walk.carried.reach = 1.0;
        if walk.depth >= self.max_depth || !walk.carried.alive() {
            return Step::Over;
        }
        let scattering =
            Scattering { medium: walk.medium, carried: walk.carried, layer: walk.class.layer(), share };
        self.light_medium(&scattering, medium.phase(), p, wi, lamp, sample, scratch);
        let sampler = &mut sample.sampler;
        let (pick, u) = (sampler.next_1d(), sampler.next_2d());
        let Some(next) = medium.phase().sample(p, wi, pick, u) else { return Step::Over };
        walk.carried.weight *= next.weight;
        (walk.pdf, walk.from) = (next.pdf, p);
        (walk.ray, walk.gap) = (Ray::new(p, next.wo), 0.0);
        self.survive(walk, sampler)
    }

    /// Scatters at a surface, or goes straight through it.
    fn scatter_at(
        &self,
        walk: &mut Walk,
        s: &Surface,
        t: f32,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) -> Step {
        let vertex = Vertex::new(self.scene, s, -walk.ray.d);
        if walk.depth + 1 < self.max_depth {
            self.light_surface(walk, &vertex, sample, scratch);
        }
        let sampler = &mut sample.sampler;
        let u_lobe = if self.facts.many_lobes { sampler.next_1d() } else { 0.0 };
        let u = sampler.next_2d();
        let next = vertex.closure.sample(vertex.wi, u_lobe, u, Transport::Radiance, self.glossy);
        let Some(next) = next else {
            sample.out.alpha = 1.0;
            return Step::Over;
        };
        walk.carried.weight *= next.weight;
        let event = next.event_where(self.scene.panes_pass);
        if event == Event::Null {
            self.pass(walk, s, t);
            return Step::On;
        }
        sample.out.alpha = 1.0;
        let d = s.frame.to_world(next.wo);
        walk.eta *= next.eta;
        walk.medium = self.scene.medium_beyond(s, d, walk.medium);
        (walk.ray, walk.gap) = (s.leave(d), s.gap(d));
        walk.class = walk.class.after_camera_event(event);
        (walk.pdf, walk.from) = (next.pdf, s.p);
        walk.carried.reach = 1.0;
        walk.depth += 1;
        self.survive(walk, sampler)
    }

    /// Russian roulette.
    fn survive(&self, walk: &mut Walk, sampler: &mut Sampler) -> Step {
        if walk.depth < self.rr_depth {
            return Step::On;
        }
        let length = Length { segments: walk.depth, most: self.max_depth };
        let survival = roulette::camera_survival_in_media(walk.carried.weight, walk.eta, length);
        match roulette::survivor(walk.carried.weight, survival, sampler) {
            Some(weight) => {
                walk.carried.weight = weight;
                Step::On
            }
            None => Step::Over,
        }
    }

    /// The numbers that choose a lamp and a place of it.
    fn lamp_numbers(&self, sampler: &mut Sampler) -> (f32, Vec2) {
        (if self.facts.many_lamps { sampler.next_1d() } else { 0.0 }, sampler.next_2d())
    }

    fn pivot(&self, medium: &Medium, part: &Ray, walk: &Walk, lamp: (f32, Vec2)) -> Option<Pivot> {
        // Its light takes one more scattering and one more ray.
        if !self.near_lamps || !medium.scatters() || walk.depth + 2 > self.max_depth {
            return None;
        }
        let place = self.scene.lamp_place(lamp.0, lamp.1)?;
        Pivot::new(medium, part, place)
    }
}
