//! Path tracing with next event estimation: the unbiased oracle, in the conventions of Mitsuba's `path`.

use super::direct::{keeps_density, next_event, power_heuristic};
use super::{CameraSample, Integrator, PassStats, Scratch};
use crate::bsdf::{Closure, Event, Transport};
use crate::film::{Layer, Radiance};
use crate::math::simd::widest;
use crate::math::{Ray, Rgb, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Hit, Plan, Scene, Settings, Surface};

#[derive(Debug)]
pub struct PathTracer<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    max_depth: u32,
    rr_depth: u32,
    hide_emitters: bool,
}

/// Which layer light met from here on belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Specular surfaces only since the camera.
    Camera,
    /// The last rough surface was the first one, and nothing specular came since.
    First,
    /// First rough surface, then specular ones only.
    FirstThenSpecular,
    Beyond,
}

impl Stage {
    fn layer(self) -> Layer {
        match self {
            Self::Camera => Layer::Emission,
            Self::First => Layer::Direct,
            Self::FirstThenSpecular => Layer::Caustic,
            Self::Beyond => Layer::Indirect,
        }
    }

    fn after(self, event: Event) -> Self {
        match (self, event) {
            (stage, Event::Null) => stage,
            (Self::Camera, Event::Delta) => Self::Camera,
            (Self::Camera, Event::Smooth) => Self::First,
            (Self::First | Self::FirstThenSpecular, Event::Delta) => Self::FirstThenSpecular,
            _ => Self::Beyond,
        }
    }

    /// Layer of next event estimation at a rough surface reached in this stage.
    fn direct_layer(self) -> Layer {
        if self == Self::Camera { Layer::Direct } else { Layer::Indirect }
    }
}

impl<'a> PathTracer<'a> {
    pub fn new(scene: &'a Scene, plan: &'a Plan, settings: &Settings) -> Self {
        Self {
            scene,
            plan,
            max_depth: settings.max_depth.0,
            rr_depth: settings.rr_depth,
            hide_emitters: settings.hide_emitters,
        }
    }
}

/// A path between two surfaces.
#[derive(Debug)]
struct Walk {
    ray: Ray,
    throughput: Rgb,
    eta: f32,
    stage: Stage,
    /// Density and place of the last rough scattering; 0 where lamps count in full.
    pdf: f32,
    from: Vec3,
    depth: u32,
    seen: bool,
}

/// A path at a surface that scatters it on.
#[derive(Debug)]
struct Arrival {
    surface: Surface,
    closure: Closure,
    wi: Vec3,
}

impl Integrator for PathTracer<'_> {
    type Pass = ();

    fn begin_pass(&self, _: u32) -> ((), PassStats) {
        ((), PassStats::default())
    }

    fn sample(&self, _: &(), samples: &mut [CameraSample], scratch: &mut Scratch) {
        widest!(PathTracer::trace;
            tracer: &PathTracer<'_> = self, samples: &mut [CameraSample] = samples,
            scratch: &mut Scratch = scratch => ())
    }
}

impl PathTracer<'_> {
    /// All paths go one surface further together: what one of them waits for, another one computes.
    #[inline(always)]
    fn trace(&self, samples: &mut [CameraSample], scratch: &mut Scratch) {
        let mut walks: Vec<Walk> = samples
            .iter()
            .map(|sample| Walk {
                ray: sample.ray,
                throughput: Rgb::ONE,
                eta: 1.0,
                stage: Stage::Camera,
                pdf: 0.0,
                from: Vec3::ZERO,
                depth: 0,
                seen: false,
            })
            .collect();
        let mut hits: Vec<Option<Hit>> = vec![None; samples.len()];
        let mut arrivals: Vec<Option<Arrival>> = samples.iter().map(|_| None).collect();
        let mut active: Vec<usize> = (0..samples.len()).collect();
        let mut live = samples.len() * usize::from(self.max_depth > 0);
        while live > 0 {
            scratch.rays += live as u64;
            for &i in &active[..live] {
                hits[i] = self.scene.geometry.closest(&walks[i].ray);
            }
            // Loops rather than `retain`: closures are not compiled for the wider instructions.
            let mut kept = 0;
            for k in 0..live {
                let i = active[k];
                active[kept] = i;
                kept += usize::from(self.arrive(
                    &mut walks[i],
                    hits[i].as_ref(),
                    &mut arrivals[i],
                    &mut samples[i].out,
                ));
            }
            live = kept;
            for &i in &active[..live] {
                let Some(at) = &arrivals[i] else { continue };
                let walk = &walks[i];
                let sample = &mut samples[i];
                let direct = next_event(
                    self.scene,
                    self.plan,
                    &at.surface,
                    &at.closure,
                    at.wi,
                    true,
                    self.max_depth - walk.depth,
                    &mut sample.sampler,
                    &mut scratch.rays,
                );
                sample.out.add(walk.stage.direct_layer(), walk.throughput * direct);
            }
            let mut kept = 0;
            for k in 0..live {
                let i = active[k];
                active[kept] = i;
                kept += usize::from(match &arrivals[i] {
                    Some(at) => self.leave(&mut walks[i], at, &mut samples[i].sampler),
                    None => true,
                });
            }
            live = kept;
        }
    }

    /// Adds what shines where the ray ends. False when the path is over; without an arrival it goes on
    /// straight.
    #[inline(always)]
    fn arrive(
        &self,
        walk: &mut Walk,
        hit: Option<&Hit>,
        arrival: &mut Option<Arrival>,
        out: &mut Radiance,
    ) -> bool {
        let scene = self.scene;
        *arrival = None;
        walk.depth += 1;
        let visible_lamps = !self.hide_emitters || walk.seen;
        let Some(hit) = hit else {
            if visible_lamps {
                let weight =
                    if walk.pdf > 0.0 { power_heuristic(walk.pdf, scene.pdf_direct_background()) } else { 1.0 };
                out.add(walk.stage.layer(), walk.throughput * scene.background() * weight);
            }
            return false;
        };
        let s = scene.surface(&walk.ray, hit);
        let back = -walk.ray.d;
        if !visible_lamps && scene.hidden_lamps_are_transparent && scene.is_lamp(&s) {
            walk.depth -= 1;
            walk.ray = Ray { tmax: walk.ray.tmax - hit.t, ..s.leave(walk.ray.d) };
            return true;
        }
        out.alpha = 1.0;
        let emitted = scene.emitted(&s, back);
        if emitted.max_element() > 0.0 && visible_lamps {
            let weight = if walk.pdf > 0.0 {
                power_heuristic(walk.pdf, scene.pdf_direct_surface(walk.from, walk.ray.d, &s))
            } else {
                1.0
            };
            out.add(walk.stage.layer(), walk.throughput * emitted * weight);
        }
        walk.seen = true;
        if walk.depth >= self.max_depth {
            return false;
        }
        let wi = s.frame.to_local(back);
        let closure = scene.closure(&s, wi);
        *arrival = Some(Arrival { surface: s, closure, wi });
        true
    }

    /// Scatters the path; false when that ends it.
    #[inline(always)]
    fn leave(&self, walk: &mut Walk, at: &Arrival, sampler: &mut Sampler) -> bool {
        let u_lobe = if self.plan.many_lobes { sampler.next_1d() } else { 0.0 };
        let u = sampler.next_2d();
        let Some(sample) = at.closure.sample(at.wi, u_lobe, u, Transport::Radiance) else { return false };
        walk.throughput *= sample.weight;
        walk.eta *= sample.eta;
        if !keeps_density(sample.event) {
            (walk.pdf, walk.from) = (sample.pdf, at.surface.p);
        }
        walk.stage = walk.stage.after(sample.event);
        walk.ray = at.surface.leave(at.surface.frame.to_world(sample.wo));
        if walk.depth >= self.rr_depth {
            let survival = (walk.throughput.max_element() * walk.eta * walk.eta).min(0.95);
            if sampler.random() >= survival {
                return false;
            }
            walk.throughput /= survival;
        }
        true
    }
}
