//! A camera path: through mirrors, glass and glossy surfaces to the first rough one.

use super::super::direct::propose;
use super::super::images;
use super::super::sight::{Carried, Sight};
use super::super::{CameraSample, Scratch};
use super::{Maps, PhotonMapper};
use crate::bsdf::{DeltaLobe, Event, Transport};
use crate::film::Radiance;
use crate::math::{Color, Vec3};
use crate::sampling::Sampler;
use crate::transport::roulette::Length;
use crate::transport::walk::slips_through;
use crate::transport::{Chain, PathClass, Vertex, roulette, visibility};

/// What a camera path does at a surface.
pub(super) enum Step {
    /// It ends there: light is gathered, times this.
    Gather(Color),
    /// It goes on along `wo` (local), as `share` of all light does.
    Follow { wo: Vec3, weight: Color, eta: f32, share: f32, density: Density },
    /// It ends without light.
    End,
}

/// How a lamp that a continued camera path meets shares its light with next event estimation.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Density {
    /// As after the surface before: straight passages change nothing.
    Kept,
    /// Nothing else finds this light.
    Specular,
    /// With which a glossy surface scatters there.
    Glossy(f32),
}

impl Density {
    /// What scattered.
    pub fn event(self) -> Event {
        match self {
            Self::Kept => Event::Null,
            Self::Specular => Event::Delta,
            Self::Glossy(_) => Event::Glossy,
        }
    }
}

impl PhotonMapper<'_> {
    /// What a camera ray brings.
    pub(super) fn trace(&self, maps: &Maps, sample: &mut CameraSample, scratch: &mut Scratch) -> Radiance {
        let CameraSample { mut ray, ref mut sampler, rivals, .. } = *sample;
        let (scene, settings) = (self.task.scene, &self.settings);
        let max_depth = settings.max_depth.0;
        let mut out = Radiance::default();
        let mut path = Carried { throughput: Color::ONE, class: PathClass::FROM_CAMERA };
        let mut eta = 1.0f32;
        let mut depth = 0u32;
        let mut seen = false;
        // Of the way so far; none where it was not all specular.
        let mut chance = Some(1.0);
        // Density of the last glossy scattering; 0 where lamps count in full. Place of the last scattering.
        let (mut pdf, mut from) = (0.0f32, Vec3::ZERO);
        let mut chain = Chain::default();
        while depth < max_depth {
            depth += 1;
            scratch.rays += 1;
            let lamps = seen || !settings.hide_emitters;
            let sight = Sight {
                lamps,
                through: self.task.view.hidden_lamps_are_transparent,
                pdf,
                from,
                left: chain.on_the_way(),
                share: images::share(chance, depth, rivals),
            };
            let Some(hit) = scene.geometry.closest(&ray) else {
                sight.add_background(scene, ray.d, path, &mut out);
                break;
            };
            let s = scene.surface(&ray, &hit);
            if sight.passes(scene, &mut ray, &hit, &s) {
                depth -= 1;
                continue;
            }
            sight.add_surface(scene, &s, ray.d, path, &mut out);
            seen = true;
            if depth >= max_depth {
                if !slips_through(scene, &mut ray, &s, sampler) {
                    break;
                }
                depth -= 1;
                continue;
            }
            let vertex = Vertex::new(scene, &s, -ray.d);
            if vertex.closure.has_smooth(vertex.wi, self.glossy()) {
                self.glossy_light(&vertex, path, (chain, depth), sampler, scratch, &mut out);
                if chain.is_empty() {
                    let (rays, gather) = (&mut scratch.rays, &mut scratch.gather);
                    self.glints(maps, &vertex, (path.throughput, depth), sampler, rays, gather, &mut out);
                }
            }
            match self.step(&vertex, sampler) {
                Step::Gather(weight) => {
                    let throughput = path.throughput * weight;
                    self.gather(maps, &vertex, throughput, depth, sampler, scratch, &mut out);
                    break;
                }
                Step::Follow { wo, weight, eta: ratio, share, density } => {
                    path.throughput *= weight;
                    eta *= ratio;
                    chance = chance.map(|chance| chance * share);
                    match density {
                        Density::Kept => depth -= 1 - scene.passage,
                        Density::Specular => (pdf, from) = (0.0, s.p),
                        Density::Glossy(density) => (pdf, from, chance) = (density, s.p, None),
                    }
                    if self.caustic.has_glints() {
                        chain = chain.after(density.event(), pdf);
                    }
                    ray = s.leave(s.frame.to_world(wo));
                }
                Step::End => break,
            }
            let Some(throughput) = self.survivor(path.throughput, eta, depth, sampler) else { break };
            path.throughput = throughput;
        }
        out
    }

    /// Russian roulette from `rr_depth` on: the throughput with which a path of so many segments goes on.
    #[inline(always)]
    pub(super) fn survivor(
        &self,
        throughput: Color,
        eta: f32,
        depth: u32,
        sampler: &mut Sampler,
    ) -> Option<Color> {
        if depth < self.settings.rr_depth {
            return Some(throughput);
        }
        let length = Length { segments: depth, most: self.settings.max_depth.0 };
        let survival = roulette::camera_survival(throughput, eta, length);
        roulette::survivor(throughput, survival, sampler)
    }

    /// Adds the light of a lamp that glossy lobes send back. Photons tell nothing about such lobes, so a
    /// lamp is looked for with `nee` or without.
    #[inline(always)]
    fn glossy_light(
        &self,
        vertex: &Vertex<'_>,
        path: Carried,
        (chain, depth): (Chain, u32),
        sampler: &mut Sampler,
        scratch: &mut Scratch,
        out: &mut Radiance,
    ) {
        let (scene, facts, lobes) = (self.task.scene, self.task.facts, self.glossy());
        let left = self.settings.max_depth.0 - depth;
        let Some(light) = propose(scene, facts, vertex, lobes, true, left, sampler) else { return };
        if !chain.leaves(light.light.pdf) {
            scratch.rays += 1;
            let through = visibility(scene, vertex.surface, &light.light, facts.transparent_shadows, left);
            out.add(path.class.layer(), path.throughput * light.value * through);
        }
    }

    /// Chooses among gathering, glossy lobes and the specular directions, by the roulette policy.
    pub(super) fn step(&self, vertex: &Vertex<'_>, sampler: &mut Sampler) -> Step {
        let Vertex { wi, ref closure, .. } = *vertex;
        let u = sampler.next_1d();
        let through = closure.transparency();
        if u < through {
            return Step::Follow {
                wo: -wi,
                weight: Color::ONE,
                eta: 1.0,
                share: through,
                density: Density::Kept,
            };
        }
        let solid = 1.0 - through;
        let deltas = closure.deltas(wi, Transport::Radiance);
        // `smooth_albedo` of a masked surface is that of the whole; events here are those of its solid part.
        let smooth = closure.smooth_albedo(wi, self.rough()).max_element() / solid;
        let glossy = closure.smooth_albedo(wi, self.glossy()).max_element() / solid;
        let total = smooth + glossy + deltas.iter().map(DeltaLobe::power).sum::<f32>();
        if total <= 0.0 {
            return Step::End;
        }
        let policy = self.settings.roulette;
        let roulette::Choice { scale, u: mut rest } =
            roulette::choice(policy, total, (u - through) / solid, sampler);
        if rest < smooth * scale {
            // The closure's smooth part is dimmed by the opacity already, which was also drawn for above.
            return Step::Gather(Color::splat(1.0 / (smooth * scale * solid)));
        }
        rest -= smooth * scale;
        for lobe in deltas.iter() {
            let p = lobe.power() * scale;
            if rest < p {
                let (wo, weight, eta) = (lobe.wo, lobe.weight / p, lobe.eta);
                let passes = lobe.straight && self.task.scene.panes_pass;
                let density = if passes { Density::Kept } else { Density::Specular };
                return Step::Follow { wo, weight, eta, share: lobe.power() * solid, density };
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
        let density = Density::Glossy(closure.pdf(wi, s.wo, Transport::Radiance, self.glossy()));
        Step::Follow { wo: s.wo, weight: s.weight / (p * solid), eta: s.eta, share: glossy * solid, density }
    }
}
