//! Photon mapping: camera paths end at the first rough surface, where direct light is sampled and
//! everything else is read from the photon maps.

mod plan;

use std::sync::{Arc, Mutex, OnceLock};
use std::time::Instant;

use super::arrive::{Arrival, Sight, arrive};
use super::direct::{next_event, scattered_lamp};
use super::{CameraSample, Integrator, PassStats, Scratch, Task};
use crate::bsdf::{Closure, Range, Transport};
use crate::emitter::{Aim, SceneSphere};
use crate::film::{Layer, Radiance};
use crate::math::{Color, Ray, Vec2, Vec3};
use crate::photon::trace::{Halt, TraceJob, Traced, aim, trace_until};
use crate::photon::{Boundary, Estimator, Owner, PhotonMap, radius};
use crate::sampling::{Sampler, mix};
use crate::scene::{Facts, Scene, Surface, View};
use crate::settings::{Count, Lookup, Mode, Radius, Roulette, Settings};

pub use plan::Plan;

/// Numbers that every pass uses.
#[derive(Debug)]
pub struct PhotonMapper<'a> {
    scene: &'a Scene,
    facts: &'a Facts,
    view: &'a View,
    settings: &'a Settings,
    plan: Plan,
    /// For pass 0, and for the passes after it.
    halts: [Halt<'a>; 2],
    /// Where light from infinity is sent.
    aims: [Option<Aim>; 2],
    /// Light paths a pass.
    paths: [u64; 2],
    /// Search radii of the first pass.
    radii: [f32; 2],
    /// Photons of pass 0 that were traced to measure their density.
    pilots: Mutex<[Option<Traced>; 2]>,
    /// Classic mode traces once.
    kept: OnceLock<Arc<Maps>>,
}

/// The maps of a pass.
#[derive(Clone, Debug)]
pub struct Maps {
    global: Option<(PhotonMap, Estimator)>,
    caustic: Option<(PhotonMap, Estimator)>,
}

/// Light paths that tell where light from infinity comes in.
const PILOT: u64 = 1 << 17;

/// Light paths from which on their photons might not fit into the memory.
const MANY: u64 = 4 << 20;

/// Which of the two maps; also the index into `paths` and `radii`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    Global = 0,
    Caustic = 1,
}

/// What a camera path does at a surface.
enum Step {
    Gather(Color),
    Follow { wo: Vec3, weight: Color, eta: f32, density: Density },
    End,
}

/// How a lamp that a continued camera path meets shares its light with next event estimation.
#[derive(Clone, Copy, PartialEq)]
enum Density {
    /// As after the surface before: straight passages change nothing.
    Kept,
    /// Nothing else finds this light.
    Specular,
    /// With which a glossy surface scatters there.
    Glossy(f32),
}

impl<'a> PhotonMapper<'a> {
    /// Measures what the settings leave open: path counts from a pilot, radii from the density of the
    /// first pass. Deterministic: a resumed render measures the same.
    pub fn new(task: Task<'a>) -> Self {
        Self::halting(task, [Halt::default(); 2])
    }

    /// The same; pass 0 (with what is measured before it) and the passes after it are cut short as
    /// `halts` say.
    pub fn halting(task: Task<'a>, halts: [Halt<'a>; 2]) -> Self {
        let mut mapper = Self::unmeasured(task, halts);
        let plan = mapper.plan;
        let places = if plan.global_map || plan.caustics { mapper.gather_places() } else { Vec::new() };
        let seen = radius::around(&places);
        for which in [Which::Global, Which::Caustic] {
            mapper.take_aim(which, &seen);
            mapper.paths[which as usize] = mapper.path_count(which);
            mapper.measure(which, &places);
        }
        mapper
    }

    fn unmeasured(task: Task<'a>, halts: [Halt<'a>; 2]) -> Self {
        let Task { scene, facts, view, settings } = task;
        let plan = Plan::new(facts, settings, view.film.pixel_count());
        let (pilots, kept) = (Mutex::default(), OnceLock::new());
        let (aims, paths, radii) = ([None, None], [0; 2], [0.0; 2]);
        Self { scene, facts, view, settings, plan, halts, aims, paths, radii, pilots, kept }
    }

    fn take_aim(&mut self, which: Which, seen: &SceneSphere) {
        if self.wanted(which) {
            let job = self.job(which, u32::MAX, PILOT);
            self.aims[which as usize] = aim(self.scene, &job, seen, self.halts[0]);
        }
    }

    /// Photons that a pass will store in the global and in the caustic map where the settings ask for many,
    /// told from a pilot: for a look at the memory before they are traced. 0 for few.
    pub fn expected_photons(task: Task<'a>) -> [u64; 2] {
        let mut mapper = Self::unmeasured(task, [Halt::default(); 2]);
        let plan = mapper.plan;
        [(Which::Global, plan.global_paths), (Which::Caustic, plan.caustic_paths)].map(|(which, count)| {
            match count {
                Count::Stored(n) if mapper.wanted(which) => n,
                Count::Paths(n) if mapper.wanted(which) && n > MANY => {
                    let seen = radius::around(&mapper.gather_places());
                    mapper.take_aim(which, &seen);
                    let stored = mapper.traced(which, u32::MAX, PILOT).photons.len();
                    (n as f64 * stored as f64 / PILOT as f64) as u64
                }
                _ => 0,
            }
        })
    }

    /// The lobes that photons are for.
    fn rough(&self) -> Range {
        Range::rough(self.settings.glossy)
    }

    /// The lobes that camera paths follow.
    fn glossy(&self) -> Range {
        Range::glossy(self.settings.glossy)
    }

    fn wanted(&self, which: Which) -> bool {
        match which {
            Which::Global => self.plan.global_paths != Count::Paths(0),
            Which::Caustic => self.plan.caustic_map,
        }
    }

    fn job(&self, which: Which, pass: u32, paths: u64) -> TraceJob {
        TraceJob {
            key: mix(mix(self.settings.seed ^ 0x9d07_0b5e) ^ (u64::from(pass) << 2 | which as u64)),
            paths,
            owner: if which == Which::Global { Owner::GlobalMap } else { Owner::CausticMap },
            next_event: self.settings.nee,
            caustic_map: self.plan.caustic_map,
            glossy: self.settings.glossy,
            max_depth: self.settings.max_depth.0,
        }
    }

    fn traced(&self, which: Which, pass: u32, paths: u64) -> Traced {
        let [first, later] = self.halts;
        let aim = self.aims[which as usize].as_ref();
        trace_until(self.scene, &self.job(which, pass, paths), aim, if pass == 0 { first } else { later })
    }

    fn pilot(&self, which: Which) -> Option<Traced> {
        // A poisoned lock holds photons of a thread that panicked: they are traced again.
        self.pilots.lock().ok().and_then(|mut pilots| pilots[which as usize].take())
    }

    fn path_count(&self, which: Which) -> u64 {
        let count = if which == Which::Global { self.plan.global_paths } else { self.plan.caustic_paths };
        match count {
            Count::Paths(n) => n,
            Count::Auto => 0,
            Count::Stored(wanted) => {
                let pilot = 1 << 14;
                let stored = self.traced(which, u32::MAX, pilot).photons.len() as u64;
                // A map that hardly fills would take for ever: a thousand paths a photon is the most.
                wanted.saturating_mul(pilot).div_ceil(stored.max(1)).min(wanted.saturating_mul(1000))
            }
        }
    }

    /// Chooses the first radius, and more light paths where their photons fall too thin.
    fn measure(&mut self, which: Which, gather_places: &[radius::Place]) {
        let (radius, count) = match which {
            Which::Global => (self.settings.radius, self.settings.photons),
            Which::Caustic => (self.settings.caustic_radius, self.settings.caustic_photons),
        };
        self.radii[which as usize] = match radius {
            Radius::Absolute(r) => r,
            Radius::Relative(r) => r * self.scene.sphere.radius,
            Radius::Auto if !self.wanted(which) => 0.0,
            Radius::Auto => {
                let traced = self.traced(which, 0, self.paths[which as usize]);
                let pixel = radius::pixel(gather_places);
                let scene_radius = self.scene.sphere.radius;
                let mut found = match which {
                    Which::Global => radius::measured(&traced.photons, gather_places, 0.5, scene_radius),
                    // Caustics are sharp where their photons crowd: their radius follows the densest quarter.
                    Which::Caustic => {
                        let places = radius::photon_places(&traced.photons);
                        radius::measured(&traced.photons, &places, 0.25, scene_radius)
                    }
                };
                let paths = &mut self.paths[which as usize];
                let before = *paths;
                if which == Which::Global && count == Count::Auto {
                    let more = radius::more_paths(found, pixel);
                    *paths = (*paths as f32 * more) as u64;
                    found /= more.sqrt();
                }
                if *paths == before
                    && let Ok(pilots) = self.pilots.get_mut()
                {
                    pilots[which as usize] = Some(traced);
                }
                radius::clamped(found, pixel, scene_radius)
            }
        };
    }

    /// Where camera rays through a regular grid of the film gather.
    fn gather_places(&self) -> Vec<radius::Place> {
        let side = (radius::PLACES as f32).sqrt() as u32;
        let [x0, y0, w, h] = self.view.film.crop.map(|v| v as f32);
        let full = Vec2::new(self.view.film.width as f32, self.view.film.height as f32);
        let footprint = |length| self.view.sensor.pixel_footprint(self.view.film.height, length);
        let at = |i: u32| (i as f32 + 0.5) / side as f32;
        (0..side * side)
            .filter_map(|i| {
                let mut sampler = Sampler::new(mix(self.settings.seed ^ 0x007a_d105), i);
                let film = Vec2::new(x0 + at(i % side) * w, y0 + at(i / side) * h) / full;
                let mut ray = self.view.sensor.ray(film, sampler.next_2d());
                let mut length = self.view.sensor.near;
                for _ in 0..16 {
                    let hit = self.scene.geometry.closest(&ray)?;
                    length += hit.t * ray.d.length();
                    let s = self.scene.surface(&ray, &hit);
                    let wi = s.frame.to_local(-ray.d);
                    match self.step(&self.scene.closure(&s, wi), wi, &mut sampler) {
                        Step::Gather(_) => {
                            let n = self.scene.photon_side(&s, -ray.d).n;
                            return Some(radius::Place {
                                p: s.p,
                                n,
                                lift: s.lift,
                                footprint: footprint(length),
                            });
                        }
                        Step::Follow { wo, .. } => ray = s.leave(s.frame.to_world(wo)),
                        Step::End => return None,
                    }
                }
                None
            })
            .collect()
    }

    /// Radius of pass i: computed from i alone, so that passes can run in any order.
    fn radius(&self, which: Which, pass: u32) -> f32 {
        let first = f64::from(self.radii[which as usize]);
        if self.settings.mode == Mode::Classic {
            return (first as f32).max(radius::LEAST);
        }
        let alpha = match which {
            Which::Global => self.settings.alpha,
            Which::Caustic => self.settings.caustic_alpha,
        };
        ((first * radius::shrinkage(pass, f64::from(alpha)).sqrt()) as f32).max(radius::LEAST)
    }

    fn build(&self, which: Which, pass: u32, stats: &mut PassStats) -> Option<(PhotonMap, Estimator)> {
        if !self.wanted(which) {
            return None;
        }
        let s = self.settings;
        let paths = self.paths[which as usize];
        let start = Instant::now();
        let pilot = self.pilot(which).filter(|_| pass == 0);
        let traced = pilot.unwrap_or_else(|| self.traced(which, pass, paths));
        stats.cut |= traced.paths < paths;
        stats.trace_seconds += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let radius = self.radius(which, pass);
        let estimator = match which {
            Which::Global => Estimator::new(s.kernel, radius, s.lookup, s.neighbours, u32::MAX),
            Which::Caustic => {
                Estimator::new(s.caustic_kernel, radius, s.lookup, s.caustic_neighbours, s.caustic_cap.0)
            }
        };
        let estimator = Estimator { lobes: self.rough(), ..estimator };
        let map = if s.lookup == Lookup::Nearest {
            PhotonMap::build_for_nearest(&traced.photons, estimator.cap, radius)
        } else {
            PhotonMap::build(&traced.photons, 2.0 * radius)
        };
        stats.build_seconds += start.elapsed().as_secs_f64();
        stats.light_paths += traced.paths;
        stats.photons += map.len() as u64;
        stats.photon_rays += traced.rays;
        stats.rejected.add(&traced.rejected);
        stats.map_bytes += map.bytes() as u64;
        match which {
            Which::Global => stats.radius = radius,
            Which::Caustic => stats.caustic_radius = radius,
        }
        Some((map, estimator))
    }

    /// Everything a rough surface sends towards the camera.
    fn gather(
        &self,
        maps: &Maps,
        s: &Surface,
        closure: &Closure<'_>,
        back: Vec3,
        throughput: Color,
        depth: u32,
        sampler: &mut Sampler,
        scratch: &mut Scratch,
        out: &mut Radiance,
    ) {
        let wi = s.frame.to_local(back);
        let left = self.settings.max_depth.0 - depth;
        if self.settings.nee {
            let mis = self.facts.large_lamps;
            let (lobes, rays) = (self.rough(), &mut scratch.rays);
            let mut direct =
                next_event(self.scene, self.facts, s, closure, lobes, wi, mis, left, sampler, rays);
            if mis {
                direct += scattered_lamp(self.scene, s, closure, lobes, wi, left, sampler, rays);
            }
            out.add(Layer::Direct, throughput * direct);
        }
        let maps = [&maps.global, &maps.caustic];
        let side = self.scene.photon_side(s, back);
        for (map, estimator) in maps.into_iter().flatten() {
            let boundary = self.settings.boundary.then_some(Boundary {
                scene: self.scene,
                facts: self.facts,
                sampler,
                rays: &mut scratch.rays,
            });
            scratch.gather.estimate(map, estimator, s, side, closure, back, throughput, left, boundary, out);
        }
    }

    /// Chooses among gathering, glossy lobes and the specular directions, by the roulette policy.
    fn step(&self, closure: &Closure<'_>, wi: Vec3, sampler: &mut Sampler) -> Step {
        let u = sampler.next_1d();
        let through = closure.transparency();
        if u < through {
            return Step::Follow { wo: -wi, weight: Color::ONE, eta: 1.0, density: Density::Kept };
        }
        let solid = 1.0 - through;
        let deltas = closure.deltas(wi, Transport::Radiance);
        // `smooth_albedo` of a masked surface is that of the whole; events here are those of its solid part.
        let smooth = closure.smooth_albedo(wi, self.rough()).max_element() / solid;
        let glossy = closure.smooth_albedo(wi, self.glossy()).max_element() / solid;
        // A refracted share counts by the power it carries, without the 1/eta² of radiance.
        let share = |l: &crate::bsdf::DeltaLobe| (l.weight * (l.eta * l.eta)).max_element();
        let total = smooth + glossy + deltas.iter().map(share).sum::<f32>();
        if total <= 0.0 {
            return Step::End;
        }
        let mut rest = (u - through) / solid;
        // `scale` turns a share into the probability with which it ends up being chosen.
        let scale = match self.settings.roulette {
            Roulette::Renormalise => 1.0 / total,
            Roulette::Absorb => 1.0 / total.max(1.0),
            Roulette::Retry => {
                let absorbed = (1.0 - total).max(0.0);
                let full = total.max(1.0);
                // Draw until something else than absorption comes up.
                while rest >= 1.0 - absorbed / full {
                    rest = sampler.random();
                }
                rest *= full / total;
                1.0 / total
            }
        };
        if rest < smooth * scale {
            // The closure's smooth part is dimmed by the opacity already, which was also drawn for above.
            return Step::Gather(Color::splat(1.0 / (smooth * scale * solid)));
        }
        rest -= smooth * scale;
        for lobe in deltas.iter() {
            let p = share(lobe) * scale;
            if rest < p {
                let (wo, weight, eta) = (lobe.wo, lobe.weight / p, lobe.eta);
                return Step::Follow { wo, weight, eta, density: Density::Specular };
            }
            rest -= p;
        }
        let p = glossy * scale;
        if rest >= p {
            return Step::End;
        }
        let u = sampler.next_2d();
        let Some(s) = closure.sample_smooth(wi, rest / p, u, Transport::Radiance, self.glossy()) else {
            return Step::End;
        };
        let density = Density::Glossy(closure.pdf(wi, s.wo, self.glossy()));
        Step::Follow { wo: s.wo, weight: s.weight / (p * solid), eta: s.eta, density }
    }
}

/// A pass of fewer pixels than these would leave more noise of the camera than its photons do, in no time.
const SMALL_PICTURE: u32 = 1 << 14;

impl Integrator for PhotonMapper<'_> {
    type Pass = Arc<Maps>;

    const STRATIFIED_PAIRS: u32 = 16;

    fn first_radii(&self) -> [f32; 2] {
        self.radii
    }

    fn samples_a_pass(&self) -> u32 {
        let film = &self.view.film;
        let pixels = film.width.saturating_mul(film.height).max(1);
        self.settings.camera_samples.0.unwrap_or((SMALL_PICTURE / pixels).clamp(1, 64))
    }

    fn begin_pass(&self, pass: u32) -> (Arc<Maps>, PassStats) {
        let mut stats = PassStats::default();
        let mut make = |pass| {
            Arc::new(Maps {
                global: self.build(Which::Global, pass, &mut stats),
                caustic: self.build(Which::Caustic, pass, &mut stats),
            })
        };
        let maps = match self.settings.mode {
            Mode::Progressive => make(pass),
            Mode::Classic => self.kept.get_or_init(|| make(0)).clone(),
        };
        (maps, stats)
    }

    fn sample(&self, maps: &Arc<Maps>, samples: &mut [CameraSample], scratch: &mut Scratch) {
        for sample in samples {
            sample.out = self.trace(maps, sample.ray, &mut sample.sampler, scratch);
        }
    }
}

impl PhotonMapper<'_> {
    fn trace(&self, maps: &Maps, mut ray: Ray, sampler: &mut Sampler, scratch: &mut Scratch) -> Radiance {
        let scene = self.scene;
        let max_depth = self.settings.max_depth.0;
        let mut out = Radiance::default();
        let mut throughput = Color::ONE;
        let mut eta = 1.0f32;
        let mut depth = 0u32;
        let mut seen = false;
        // Density and place of the last glossy scattering; 0 where lamps count in full.
        let (mut pdf, mut from) = (0.0f32, Vec3::ZERO);
        while depth < max_depth {
            depth += 1;
            scratch.rays += 1;
            let hit = scene.geometry.closest(&ray);
            let lamps = seen || !self.settings.hide_emitters;
            let sight = Sight { lamps, through: self.view.hidden_lamps_are_transparent, pdf, from };
            let s = match arrive(scene, &mut ray, hit.as_ref(), sight, throughput, Layer::Emission, &mut out)
            {
                Arrival::Gone => break,
                Arrival::Behind => {
                    depth -= 1;
                    continue;
                }
                Arrival::At(s) => s,
            };
            seen = true;
            if depth >= max_depth {
                break;
            }
            let back = -ray.d;
            let wi = s.frame.to_local(back);
            let closure = scene.closure(&s, wi);
            if closure.has_smooth(wi, self.glossy()) {
                // Photons tell nothing about such lobes, so a lamp is looked for with `nee` or without.
                let (left, rays) = (max_depth - depth, &mut scratch.rays);
                let lobes = self.glossy();
                let light = next_event(scene, self.facts, &s, &closure, lobes, wi, true, left, sampler, rays);
                out.add(Layer::Emission, throughput * light);
            }
            match self.step(&closure, wi, sampler) {
                Step::Gather(weight) => {
                    self.gather(
                        maps,
                        &s,
                        &closure,
                        back,
                        throughput * weight,
                        depth,
                        sampler,
                        scratch,
                        &mut out,
                    );
                    break;
                }
                Step::Follow { wo, weight, eta: ratio, density } => {
                    throughput *= weight;
                    eta *= ratio;
                    match density {
                        Density::Kept => {}
                        Density::Specular => pdf = 0.0,
                        Density::Glossy(density) => (pdf, from) = (density, s.p),
                    }
                    ray = s.leave(s.frame.to_world(wo));
                }
                Step::End => break,
            }
            if depth >= self.settings.rr_depth {
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
