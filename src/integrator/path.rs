//! Path tracing with next event estimation: the unbiased oracle, in the conventions of Mitsuba's `path`.

use super::direct::{keeps_density, next_event, power_heuristic};
use super::{Integrator, PassStats, Scratch};
use crate::bsdf::{Event, Range, Transport};
use crate::film::{Layer, Radiance};
use crate::math::simd::widest;
use crate::math::{Ray, Rgb, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Plan, Scene, Settings};

#[derive(Debug)]
pub struct PathTracer<'a> {
    scene: &'a Scene,
    plan: &'a Plan,
    max_depth: u32,
    rr_depth: u32,
    /// Glossy surfaces count as specular ones: it decides the layer, never the sum.
    glossy: f32,
    hide_emitters: bool,
}

/// Which layer light met from here on belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Specular and glossy surfaces only since the camera.
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
            (Self::Camera, Event::Delta | Event::Glossy) => Self::Camera,
            (Self::Camera, Event::Smooth) => Self::First,
            (Self::First | Self::FirstThenSpecular, Event::Delta | Event::Glossy) => Self::FirstThenSpecular,
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
            glossy: settings.glossy,
            hide_emitters: settings.hide_emitters,
        }
    }
}

impl Integrator for PathTracer<'_> {
    type Pass = ();

    fn begin_pass(&self, _: u32) -> ((), PassStats) {
        ((), PassStats::default())
    }

    fn sample(&self, _: &(), ray: Ray, sampler: &mut Sampler, scratch: &mut Scratch) -> Radiance {
        widest!(PathTracer::trace;
            tracer: &PathTracer<'_> = self, ray: Ray = ray, sampler: &mut Sampler = sampler,
            scratch: &mut Scratch = scratch => Radiance)
    }
}

impl PathTracer<'_> {
    #[inline(always)]
    fn trace(&self, mut ray: Ray, sampler: &mut Sampler, scratch: &mut Scratch) -> Radiance {
        let scene = self.scene;
        let mut out = Radiance::default();
        let mut throughput = Rgb::ONE;
        let mut eta = 1.0f32;
        let mut stage = Stage::Camera;
        // Density and place of the last rough scattering; 0 where lamps count in full.
        let (mut pdf, mut from) = (0.0f32, Vec3::ZERO);
        let mut depth = 0u32;
        let mut seen = false;
        while depth < self.max_depth {
            depth += 1;
            scratch.rays += 1;
            let visible_lamps = !self.hide_emitters || seen;
            let Some(hit) = scene.geometry.closest(&ray) else {
                if visible_lamps {
                    let weight = if pdf > 0.0 {
                        power_heuristic(pdf, scene.pdf_direct_background(ray.d))
                    } else {
                        1.0
                    };
                    out.add(stage.layer(), throughput * scene.background(ray.d) * weight);
                }
                break;
            };
            let s = scene.surface(&ray, &hit);
            let back = -ray.d;
            if !visible_lamps && scene.hidden_lamps_are_transparent && scene.is_lamp(&s) {
                depth -= 1;
                ray = Ray { tmax: ray.tmax - hit.t, ..s.leave(ray.d) };
                continue;
            }
            out.alpha = 1.0;
            let emitted = scene.emitted(&s, back);
            if emitted.max_element() > 0.0 && visible_lamps {
                let weight = if pdf > 0.0 {
                    power_heuristic(pdf, scene.pdf_direct_surface(from, ray.d, &s))
                } else {
                    1.0
                };
                out.add(stage.layer(), throughput * emitted * weight);
            }
            seen = true;
            if depth >= self.max_depth {
                break;
            }
            let wi = s.frame.to_local(back);
            let closure = scene.closure(&s, wi);
            let left = self.max_depth - depth;
            let direct = |lobes, sampler: &mut Sampler, rays: &mut u64| {
                next_event(scene, self.plan, &s, &closure, lobes, wi, true, left, sampler, rays)
            };
            let light = direct(Range::rough(self.glossy), sampler, &mut scratch.rays);
            out.add(stage.direct_layer(), throughput * light);
            if closure.has_smooth(wi, Range::glossy(self.glossy)) {
                let light = direct(Range::glossy(self.glossy), sampler, &mut scratch.rays);
                out.add(stage.after(Event::Glossy).layer(), throughput * light);
            }

            let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
            let Some(sample) = closure.sample(wi, u_lobe, u, Transport::Radiance, self.glossy) else { break };
            throughput *= sample.weight;
            if throughput == Rgb::ZERO {
                break;
            }
            eta *= sample.eta;
            if !keeps_density(sample.event) {
                (pdf, from) = (sample.pdf, s.p);
            }
            stage = stage.after(sample.event);
            ray = s.leave(s.frame.to_world(sample.wo));
            if depth >= self.rr_depth {
                let survival = (throughput.max_element() * eta * eta).min(0.95);
                if sampler.random() >= survival {
                    break;
                }
                throughput /= survival;
            }
        }
        out
    }
}
