//! Camera paths that go on behind the first rough surface. At every rough surface direct light is sampled and
//! the caustic map is read. With [`Indirect::Trace`] that is all, as in path tracing; with
//! [`Indirect::Gather`] a path ends at the second rough surface, where a map of all photons tells what it sends
//! back: final gathering (Jensen 1996, §5), whose error is fine-grained where that of a map seen directly is
//! blurred.

use super::super::direct::propose;
use super::super::images;
use super::super::shadows::Shadows;
use super::super::sight::{Carried, Sight};
use super::super::{CameraSample, DiffusePoint, Scratch};
use super::maps::PassMap;
use super::walk::{Density, Step};
use super::{Maps, PhotonMapper};
use crate::bsdf::{Event, Range, Transport};
use crate::film::{Layer, Radiance};
use crate::math::simd::widest;
use crate::math::{Color, Ray, Vec3};
use crate::photon::{Boundary, Gather, GatherPoint};
use crate::sampling::Sampler;
use crate::scene::{Hit, Surface};
use crate::settings::Indirect;
use crate::transport::walk::slips_through;
use crate::transport::{Chain, PathClass, Vertex};

/// Radii that lie between two rough surfaces at least, for the map to be read at the second: nearer, the first
/// one sees how the map is blurred.
const RESOLVED: f32 = 2.0;

/// Directions in which a camera path gathers, where the settings leave it open. Direct light is less noisy than
/// indirect light, so that a path shares its first part among several.
const GATHER_RAYS: u32 = 4;

/// Cosines below this count as this: what a pixel sees of a surface from the side is long.
const GRAZING: f32 = 0.05;

/// Light that a sample multiplies by less of one colour than this, compared with the others, cannot be told from it.
const LEAST_SCALE: f32 = 1e-4;

/// A path between two surfaces.
#[derive(Clone, Copy, Debug)]
struct Walk {
    /// Of the sample that it belongs to.
    sample: usize,
    sampler: Sampler,
    throughput: Color,
    eta: f32,
    /// Of the light that it meets next.
    class: PathClass,
    /// The same, of the path since its last rough surface.
    since: PathClass,
    /// Glossy and specular surfaces so far.
    chain: Chain,
    /// Density of the last rough or glossy scattering; 0 where lamps count in full. Place of the last scattering.
    pdf: f32,
    from: Vec3,
    /// Length since the last rough surface.
    reach: f32,
    depth: u32,
    seen: bool,
    /// Of its way so far; none where it was not all specular.
    chance: Option<f32>,
}

impl Walk {
    fn start(sample: usize, sampler: Sampler) -> Self {
        Self {
            sample,
            sampler,
            throughput: Color::ONE,
            eta: 1.0,
            class: PathClass::FROM_CAMERA,
            since: PathClass::FROM_CAMERA,
            chain: Chain::default(),
            pdf: 0.0,
            from: Vec3::ZERO,
            reach: 0.0,
            depth: 0,
            seen: false,
            chance: Some(1.0),
        }
    }

    /// No rough surface so far.
    fn at_first(&self) -> bool {
        self.class == PathClass::Emission
    }

    /// What the caustic map tells of the light that reaches the rough surface before this: the light that a specular or
    /// glossy surface sends there.
    fn behind_specular(&self) -> bool {
        self.since == PathClass::Caustic
    }
}

/// Scratch of paths that go together.
#[derive(Debug, Default)]
pub struct Onward {
    rays: Vec<Ray>,
    walks: Vec<Walk>,
    hits: Vec<Option<Hit>>,
    /// Paths that go on.
    active: Vec<usize>,
    /// Paths that join them after this step.
    branches: Vec<(Ray, Walk)>,
    shadows: Shadows,
}

/// What one step of all paths adds to.
struct Stage<'a> {
    maps: &'a Maps,
    branches: &'a mut Vec<(Ray, Walk)>,
    shadows: &'a mut Shadows,
    gather: &'a mut Gather,
}

impl PhotonMapper<'_> {
    /// Fills `out` of each sample.
    pub(super) fn go_on(&self, maps: &Maps, samples: &mut [CameraSample], scratch: &mut Scratch) {
        widest!(PhotonMapper::go_on_together;
            mapper: &PhotonMapper<'_> = self, maps: &Maps = maps, samples: &mut [CameraSample] = samples,
            scratch: &mut Scratch = scratch => ())
    }

    /// All paths go one surface further together, as in path tracing.
    #[inline(always)]
    fn go_on_together(&self, maps: &Maps, samples: &mut [CameraSample], scratch: &mut Scratch) {
        let scene = self.task.scene;
        let mut onward = std::mem::take(&mut scratch.onward);
        let Onward { rays, walks, hits, active, branches, shadows } = &mut onward;
        rays.clear();
        rays.extend(samples.iter().map(|sample| sample.ray));
        walks.clear();
        walks.extend(samples.iter().enumerate().map(|(i, sample)| Walk::start(i, sample.sampler)));
        active.clear();
        if self.settings.max_depth.0 > 0 {
            active.extend(0..samples.len());
        }
        while !active.is_empty() {
            scratch.rays += active.len() as u64;
            hits.resize(rays.len(), None);
            scene.geometry.closest_each(rays, active, hits);
            let mut stage = Stage { maps, branches, shadows, gather: &mut scratch.gather };
            // A loop rather than `retain`: closures are not compiled for the wider instructions.
            let mut kept = 0;
            for k in 0..active.len() {
                let i = active[k];
                active[kept] = i;
                let sample = &mut samples[walks[i].sample];
                let on = self.go_on_once(&mut stage, &mut rays[i], &mut walks[i], hits[i].as_ref(), sample);
                kept += usize::from(on);
            }
            active.truncate(kept);
            for (ray, walk) in branches.drain(..) {
                active.push(walks.len());
                walks.push(walk);
                rays.push(ray);
            }
            scratch.rays += shadows.answer(scene, samples);
        }
        scratch.onward = onward;
    }

    /// Everything at the end of a path's ray; false when the path ends there.
    #[inline(always)]
    fn go_on_once(
        &self,
        stage: &mut Stage<'_>,
        ray: &mut Ray,
        walk: &mut Walk,
        hit: Option<&Hit>,
        sample: &mut CameraSample,
    ) -> bool {
        let (scene, settings) = (self.task.scene, &self.settings);
        let caustics = stage.maps.caustic.is_some();
        walk.depth += 1;
        let known = caustics && walk.behind_specular();
        let sight = Sight {
            lamps: (walk.seen || !settings.hide_emitters) && !known,
            through: self.task.view.hidden_lamps_are_transparent && !walk.seen,
            pdf: walk.pdf,
            from: walk.from,
            left: walk.chain.on_the_way(),
            share: images::share(walk.chance.filter(|_| walk.at_first()), walk.depth, sample.rivals),
        };
        let carried = Carried { throughput: walk.throughput, class: walk.class };
        let Some(hit) = hit else {
            sight.add_background(scene, ray.d, carried, &mut sample.out);
            return false;
        };
        let s = scene.surface(ray, hit);
        if sight.passes(scene, ray, hit, &s) {
            walk.depth -= 1;
            return true;
        }
        sight.add_surface(scene, &s, ray.d, carried, &mut sample.out);
        walk.reach += hit.t * ray.d.length();
        walk.seen = true;
        if walk.depth >= settings.max_depth.0 {
            walk.depth -= 1;
            return slips_through(scene, ray, &s, &mut walk.sampler);
        }
        let vertex = Vertex::new(scene, &s, -ray.d);
        // Light that a glossy surface sends to a rough one is the caustic map's.
        if (walk.at_first() || !caustics) && vertex.closure.has_smooth(vertex.wi, self.glossy()) {
            self.direct_light(stage, &vertex, walk, Color::ONE, Event::Glossy, sample);
            if walk.at_first() && walk.chain.is_empty() {
                let (mut rays, path) = (0, (walk.throughput, walk.depth));
                let (sampler, out) = (&mut walk.sampler, &mut sample.out);
                self.glints(stage.maps, &vertex, path, sampler, &mut rays, stage.gather, out);
                stage.shadows.count(rays);
            }
        }
        match self.step(&vertex, &mut walk.sampler) {
            Step::Gather(weight) => {
                let Some(next) = self.at_rough(stage, &vertex, weight, walk, sample) else { return false };
                *ray = next;
            }
            Step::Follow { wo, weight, eta, share, density } => {
                walk.chance = walk.chance.map(|chance| chance * share);
                follow(walk, &s, weight, eta, density, self.caustic.has_glints());
                if density == Density::Kept {
                    walk.depth -= 1 - scene.passage;
                }
                *ray = s.leave(s.frame.to_world(wo));
            }
            Step::End => return false,
        }
        self.survives(walk)
    }

    /// Next event estimation by the rough or the glossy lobes, times `weight`.
    #[inline(always)]
    fn direct_light(
        &self,
        stage: &mut Stage<'_>,
        vertex: &Vertex<'_>,
        walk: &mut Walk,
        weight: Color,
        event: Event,
        sample: &mut CameraSample,
    ) {
        let (scene, facts) = (self.task.scene, self.task.facts);
        let left = self.settings.max_depth.0 - walk.depth;
        let lobes = if event == Event::Glossy { self.glossy() } else { self.rough() };
        let found = propose(scene, facts, vertex, lobes, true, left, &mut walk.sampler);
        let Some(light) = found else { return };
        if event == Event::Glossy && walk.chain.leaves(light.light.pdf) {
            return;
        }
        let layer = walk.class.after_camera_event(event).layer();
        let value = walk.throughput * weight * light.value;
        stage.shadows.send(scene, facts, vertex, &light, (walk.sample, layer, value), left, sample);
    }

    /// What a rough surface sends back, times `weight`; the ray with which the path goes on, unless it ends or
    /// splits.
    #[inline(always)]
    fn at_rough(
        &self,
        stage: &mut Stage<'_>,
        vertex: &Vertex<'_>,
        weight: Color,
        walk: &mut Walk,
        sample: &mut CameraSample,
    ) -> Option<Ray> {
        let settings = &self.settings;
        let first = walk.at_first();
        let at = GatherPoint {
            vertex,
            side: self.task.scene.photon_side(vertex.surface, vertex.back),
            throughput: walk.throughput * weight,
            max_photon_depth: settings.max_depth.0 - walk.depth,
        };
        let gathers = stage.maps.global.as_ref().filter(|_| settings.indirect == Indirect::Gather);
        if let Some(map) = gathers.filter(|map| !first && walk.reach > RESOLVED * map.resolved) {
            self.read_all(stage, map, &at, walk, sample);
            return None;
        }
        if first && settings.gather_radius.0 != Some(0.0) {
            sample.diffuse = self.diffuse_point(&at, walk);
        }
        self.caustics(stage, &at, walk, sample);
        self.direct_light(stage, vertex, walk, weight, Event::Smooth, sample);
        walk.throughput = at.throughput;
        walk.class = walk.class.after_camera_event(Event::Smooth);
        walk.chain = Chain::default();
        (walk.since, walk.reach, walk.from) = (PathClass::Direct, 0.0, vertex.surface.p);
        let branches = match gathers {
            Some(_) if first => settings.gather_rays.0.unwrap_or(GATHER_RAYS),
            _ => 1,
        };
        if branches == 1 {
            return scatter(vertex, walk, self.rough());
        }
        walk.throughput /= branches as f32;
        for number in 0..branches {
            let mut branch = Walk { sampler: walk.sampler.branch(number, branches), ..*walk };
            if let Some(ray) = scatter(vertex, &mut branch, self.rough())
                && self.survives(&mut branch)
            {
                stage.branches.push((ray, branch));
            }
        }
        None
    }

    /// The point, if it sends the same light everywhere, on one side, of every colour.
    fn diffuse_point(&self, at: &GatherPoint<'_>, walk: &Walk) -> Option<DiffusePoint> {
        let Vertex { surface: s, wi, ref closure, .. } = *at.vertex;
        let albedo = closure.lambertian(wi).filter(|_| !at.side.both)?;
        let scale = at.throughput * albedo;
        let view = self.task.view;
        let apart = view.sensor.pixel_footprint(view.film.height, walk.reach) / wi.z.abs().max(GRAZING);
        let (p, n) = (s.p, s.frame.n * wi.z.signum());
        let known = scale.lanes().iter().all(|&lane| lane > LEAST_SCALE * scale.max_element());
        (known && apart.is_normal()).then_some(DiffusePoint { p, n, depth: walk.depth, apart, scale })
    }

    /// Adds what the caustic map says. Only where the camera looks are its edges corrected: elsewhere the light is mixed
    /// with much else before it is seen.
    #[inline(always)]
    fn caustics(
        &self,
        stage: &mut Stage<'_>,
        at: &GatherPoint<'_>,
        walk: &mut Walk,
        sample: &mut CameraSample,
    ) {
        let Some(map) = &stage.maps.caustic else { return };
        let mut rays = 0;
        let around = self.surroundings().filter(|_| walk.at_first());
        let sampler = &mut walk.sampler;
        let boundary = around.map(|around| Boundary { around, sampler, rays: &mut rays });
        let mut found = Radiance::default();
        map.estimator.estimate(&map.photons, at, boundary, stage.gather, &mut found);
        stage.shadows.count(rays);
        sample.out.add(if walk.at_first() { Layer::Caustic } else { Layer::Indirect }, found.sum());
    }

    /// Adds all light that a surface sends back, where only its mean over many such surfaces is seen.
    #[inline(always)]
    fn read_all(
        &self,
        stage: &mut Stage<'_>,
        map: &PassMap,
        at: &GatherPoint<'_>,
        walk: &mut Walk,
        sample: &mut CameraSample,
    ) {
        let (gather, out) = (&mut *stage.gather, &mut sample.out);
        if map.irradiance.as_ref().is_some_and(|known| known.add(at, map.estimator.radius, gather, out)) {
            return;
        }
        let (sampler, mut rays) = (&mut walk.sampler, 0);
        let boundary = self.surroundings().map(|around| Boundary { around, sampler, rays: &mut rays });
        map.estimator.estimate(&map.photons, at, boundary, gather, out);
        stage.shadows.count(rays);
    }

    /// Russian roulette; false when it ends the path.
    #[inline(always)]
    fn survives(&self, walk: &mut Walk) -> bool {
        let survivor = self.survivor(walk.throughput, walk.eta, walk.depth, &mut walk.sampler);
        walk.throughput = survivor.unwrap_or(Color::ZERO);
        survivor.is_some()
    }
}

/// The path leaves by a rough lobe.
#[inline(always)]
fn scatter(vertex: &Vertex<'_>, walk: &mut Walk, lobes: Range) -> Option<Ray> {
    let Vertex { surface: s, wi, ref closure, .. } = *vertex;
    let (u, u_lobe) = (walk.sampler.next_2d(), walk.sampler.next_1d());
    let next = closure.sample_smooth(wi, u_lobe, u, Transport::Radiance, lobes)?;
    walk.pdf = closure.pdf(wi, next.wo, Transport::Radiance, lobes);
    walk.throughput *= next.weight;
    walk.eta *= next.eta;
    Some(s.leave(s.frame.to_world(next.wo)))
}

/// The path leaves straight on, or by a specular or glossy lobe.
#[inline(always)]
fn follow(walk: &mut Walk, s: &Surface, weight: Color, eta: f32, density: Density, glints: bool) {
    walk.throughput *= weight;
    walk.eta *= eta;
    match density {
        Density::Kept => {}
        Density::Specular => (walk.pdf, walk.from) = (0.0, s.p),
        Density::Glossy(pdf) => (walk.pdf, walk.from, walk.chance) = (pdf, s.p, None),
    }
    let event = density.event();
    if glints && walk.at_first() {
        walk.chain = walk.chain.after(event, walk.pdf);
    }
    walk.class = walk.class.after_camera_event(event);
    walk.since = walk.since.after_camera_event(event);
}
