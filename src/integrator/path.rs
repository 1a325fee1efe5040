//! Path tracing with next event estimation: the unbiased oracle, in the conventions of Mitsuba's `path`.

use super::direct::propose;
use super::shadows::Shadows;
use super::sight::{Carried, Sight};
use super::{CameraSample, Integrator, PassStats, Scratch, Task};
use crate::bsdf::{Event, Range, Transport};
use crate::math::simd::widest;
use crate::math::{Color, Ray, Vec3};
use crate::sampling::Sampler;
use crate::scene::{Facts, Hit, Scene};
use crate::transport::roulette::Length;
use crate::transport::walk::slips_through;
use crate::transport::{PathClass, Vertex, roulette};

/// See the module.
#[derive(Debug)]
pub struct PathTracer<'a> {
    scene: &'a Scene,
    facts: &'a Facts,
    max_depth: u32,
    rr_depth: u32,
    /// Glossy surfaces count as specular ones: it decides the layer, never the sum.
    glossy: f32,
    hide_emitters: bool,
    /// Hidden lamps let camera rays pass.
    see_through: bool,
}

impl<'a> PathTracer<'a> {
    /// Takes what it needs of the task; nothing is measured.
    pub fn new(task: Task<'a>) -> Self {
        let settings = task.settings;
        Self {
            scene: task.scene,
            facts: task.facts,
            max_depth: settings.max_depth.0,
            rr_depth: settings.rr_depth,
            glossy: settings.glossy,
            hide_emitters: settings.hide_emitters,
            see_through: task.view.hidden_lamps_are_transparent,
        }
    }
}

/// A path between two surfaces.
#[derive(Clone, Copy, Debug)]
struct Walk {
    throughput: Color,
    eta: f32,
    /// Of the light that it meets next.
    class: PathClass,
    /// Density and place of the last rough scattering; 0 where lamps count in full.
    pdf: f32,
    from: Vec3,
    depth: u32,
    seen: bool,
}

/// Paths that go together.
#[derive(Debug, Default)]
pub struct Wave {
    rays: Vec<Ray>,
    walks: Vec<Walk>,
    hits: Vec<Option<Hit>>,
    /// Paths that go on come first.
    active: Vec<usize>,
    shadows: Shadows,
}

impl Wave {
    fn begin(&mut self, samples: &[CameraSample]) {
        let n = samples.len();
        self.rays.clear();
        self.rays.extend(samples.iter().map(|sample| sample.ray));
        self.walks.clear();
        self.walks.resize(n, Walk::START);
        self.hits.resize(n, None);
        self.active.clear();
        self.active.extend(0..n);
    }
}

impl Walk {
    const START: Self = Self {
        throughput: Color::ONE,
        eta: 1.0,
        class: PathClass::FROM_CAMERA,
        pdf: 0.0,
        from: Vec3::ZERO,
        depth: 0,
        seen: false,
    };
}

impl Integrator for PathTracer<'_> {
    type Pass = ();

    /// More do not help (Cornell box, 64 samples: RMSE 0.00897 with 8, 0.00894 with 16).
    const STRATIFIED_PAIRS: u32 = 8;

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
    /// All paths go one surface further together: rays are traced in bundles, and what one path waits
    /// for another one computes.
    #[inline(always)]
    fn trace(&self, samples: &mut [CameraSample], scratch: &mut Scratch) {
        let mut wave = std::mem::take(&mut scratch.wave);
        wave.begin(samples);
        let Wave { rays, walks, hits, active, shadows } = &mut wave;
        let mut live = if self.max_depth > 0 { samples.len() } else { 0 };
        while live > 0 {
            scratch.rays += live as u64;
            self.scene.geometry.closest_each(rays, &active[..live], hits);
            // A loop rather than `retain`: closures are not compiled for the wider instructions.
            let mut kept = 0;
            for k in 0..live {
                let i = active[k];
                active[kept] = i;
                let hit = hits[i].as_ref();
                kept += usize::from(self.step(i, &mut rays[i], &mut walks[i], hit, &mut samples[i], shadows));
            }
            live = kept;
            scratch.rays += shadows.answer(self.scene, samples);
        }
        scratch.wave = wave;
    }

    /// Everything at the end of a ray of path `i`: adds what shines there, sends light from the lamps, and
    /// scatters the path. False when it is over.
    #[inline(always)]
    fn step(
        &self,
        i: usize,
        ray: &mut Ray,
        walk: &mut Walk,
        hit: Option<&Hit>,
        sample: &mut CameraSample,
        shadows: &mut Shadows,
    ) -> bool {
        let scene = self.scene;
        walk.depth += 1;
        let sight = Sight {
            lamps: !self.hide_emitters || walk.seen,
            through: self.see_through,
            pdf: walk.pdf,
            from: walk.from,
            left: None,
            share: 1.0,
        };
        let carried = Carried { throughput: walk.throughput, class: walk.class };
        let Some(hit) = hit else {
            sight.add_background(scene, ray.d, carried, &mut sample.out);
            return false;
        };
        let s = &scene.surface(ray, hit);
        if sight.passes(scene, ray, hit, s) {
            walk.depth -= 1;
            return true;
        }
        sight.add_surface(scene, s, ray.d, carried, &mut sample.out);
        walk.seen = true;
        if walk.depth >= self.max_depth {
            walk.depth -= 1;
            return slips_through(scene, ray, s, &mut sample.sampler);
        }
        let vertex = Vertex::new(scene, s, -ray.d);
        self.light(i, walk, &vertex, sample, shadows);
        self.scatter(ray, walk, &vertex, &mut sample.sampler)
    }

    /// Next event estimation.
    #[inline(always)]
    fn light(
        &self,
        i: usize,
        walk: &Walk,
        vertex: &Vertex<'_>,
        sample: &mut CameraSample,
        shadows: &mut Shadows,
    ) {
        let (scene, facts) = (self.scene, self.facts);
        let left = self.max_depth - walk.depth;
        let rough = (Range::rough(self.glossy), walk.class.after_camera_event(Event::Smooth).layer());
        let glossy = (Range::glossy(self.glossy), walk.class.after_camera_event(Event::Glossy).layer());
        let lobes =
            if vertex.closure.has_smooth(vertex.wi, glossy.0) { &[rough, glossy][..] } else { &[rough] };
        for &(range, layer) in lobes {
            let proposal = propose(scene, facts, vertex, range, true, left, &mut sample.sampler);
            let Some(p) = proposal else { continue };
            let light = (i, layer, walk.throughput * p.value);
            shadows.send(scene, facts, vertex, &p, light, left, sample);
        }
    }

    /// Scatters the path; false when that ends it.
    #[inline(always)]
    fn scatter(&self, ray: &mut Ray, walk: &mut Walk, vertex: &Vertex<'_>, sampler: &mut Sampler) -> bool {
        let s = vertex.surface;
        let u_lobe = if self.facts.many_lobes { sampler.next_1d() } else { 0.0 };
        let u = sampler.next_2d();
        let sample = vertex.closure.sample(vertex.wi, u_lobe, u, Transport::Radiance, self.glossy);
        let Some(sample) = sample else { return false };
        walk.throughput *= sample.weight;
        walk.eta *= sample.eta;
        // Straight passages leave the density of the scattering before in force.
        if sample.event == Event::Null {
            walk.depth -= 1 - self.scene.passage;
        } else {
            (walk.pdf, walk.from) = (sample.pdf, s.p);
        }
        walk.class = walk.class.after_camera_event(sample.event);
        *ray = s.leave(s.frame.to_world(sample.wo));
        if walk.depth >= self.rr_depth {
            let length = Length { segments: walk.depth, most: self.max_depth };
            let survival = roulette::camera_survival(walk.throughput, walk.eta, length);
            let Some(throughput) = roulette::survivor(walk.throughput, survival, sampler) else {
                return false;
            };
            walk.throughput = throughput;
        }
        true
    }
}
