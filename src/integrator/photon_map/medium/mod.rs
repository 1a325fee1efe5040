//! Camera paths in scenes with media: as [`super::walk`], and along each of their rays light is collected that media
//! scatter towards the camera. Straight from a lamp it is found by shadow rays, all other by photons.
//!
//! As in path tracing through media, straight passages cost no segment.

mod light;
mod places;
mod stretch;

use super::super::sight::{Carried, Sight};
use super::super::{CameraSample, Scratch};
use super::walk::{Density, Step};
use super::{Maps, PhotonMapper};
use crate::film::Layer;
use crate::math::{Color, Ray, Vec3};
use crate::medium::MediumId;
use crate::photon::GatherPoint;
use crate::photon::volume::VolumeGather;
use crate::scene::{Hit, Surface};
use crate::transport::media::{MOST_PASSED, within};
use crate::transport::roulette::Length;
use crate::transport::{PathClass, Vertex, roulette};
pub(super) use places::Look;
use stretch::Stretch;

/// A camera path between two surfaces.
struct Walk {
    ray: Ray,
    medium: Option<MediumId>,
    /// Normal of the surface that the ray comes from, and how far behind its start that lies.
    start: Option<(Vec3, f32)>,
    path: Carried,
    eta: f32,
    /// Segments, this one included; straight passages do not count.
    depth: u32,
    /// Some surface was met.
    seen: bool,
    /// Density and place of the last glossy scattering; 0 where lamps count in full.
    pdf: f32,
    from: Vec3,
}

/// Whether a path goes on.
enum Goes {
    On,
    Over,
}

impl PhotonMapper<'_> {
    /// What a camera ray brings.
    pub(super) fn trace_in_media(&self, maps: &Maps, sample: &mut CameraSample, scratch: &mut Scratch) {
        let mut walk = Walk {
            ray: sample.ray.normalised(),
            medium: self.task.view.medium,
            start: None,
            path: Carried { throughput: Color::ONE, class: PathClass::FROM_CAMERA },
            eta: 1.0,
            depth: 1,
            seen: false,
            pdf: 0.0,
            from: Vec3::ZERO,
        };
        for _ in 0..MOST_PASSED {
            if walk.depth > self.settings.max_depth.0 {
                return;
            }
            scratch.rays += 1;
            let hit = self.task.scene.geometry.closest(&walk.ray);
            self.collect(maps, &mut walk, hit.as_ref(), sample, scratch);
            if let Goes::Over = self.arrive(maps, &mut walk, hit.as_ref(), sample, scratch) {
                return;
            }
        }
    }

    /// Adds what the medium scatters into the ray, and dims what lies behind.
    fn collect(
        &self,
        maps: &Maps,
        walk: &mut Walk,
        hit: Option<&Hit>,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let Some(id) = walk.medium else { return };
        let MediumId(index) = id;
        let scene = self.task.scene;
        let medium = &scene.media[index as usize];
        let gap = walk.start.map_or(0.0, |(_, gap)| gap);
        let part = within(&walk.ray, gap, hit.map_or(walk.ray.tmax, |hit| hit.t));
        let end = hit.filter(|_| maps.volume.is_some()).map(|hit| scene.surface(&walk.ray, hit).ng);
        let stretch =
            Stretch::new(medium, &part, [walk.start.map(|(normal, _)| normal), end], &mut sample.sampler);
        let throughput = walk.path.throughput;
        let left = self.settings.max_depth.0 - walk.depth;
        if medium.scatters() && left > 0 {
            if let Some(single) = self.single.as_ref().filter(|_| self.settings.nee) {
                single.scatter_once(&part, id, throughput, sample, scratch);
            }
            if let Some(volume) = &maps.volume {
                let segment = &stretch.segment;
                let at = VolumeGather { segment, medium: index, max_photon_depth: left, passage: &stretch };
                let light = volume.radiance(&at, &mut scratch.volume);
                sample.out.add(Layer::Medium, throughput * light);
            }
        }
        walk.path.throughput *= stretch.all();
    }

    /// At the end of a ray.
    fn arrive(
        &self,
        maps: &Maps,
        walk: &mut Walk,
        hit: Option<&Hit>,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) -> Goes {
        let scene = self.task.scene;
        let sight = Sight {
            lamps: walk.seen || !self.settings.hide_emitters,
            through: self.task.view.hidden_lamps_are_transparent,
            pdf: walk.pdf,
            from: walk.from,
            left: None,
            share: 1.0,
        };
        let Some(hit) = hit else {
            sight.add_background(scene, walk.ray.d, walk.path, &mut sample.out);
            // What the media hid of the background covers it.
            let through = walk.path.throughput.max_element().clamp(0.0, 1.0);
            sample.out.alpha = sample.out.alpha.max(1.0 - through);
            return Goes::Over;
        };
        let s = scene.surface(&walk.ray, hit);
        if sight.passes(scene, &mut walk.ray, hit, &s) {
            walk.start = Some((s.ng, s.gap(walk.ray.d)));
            walk.medium = scene.medium_beyond(&s, walk.ray.d, walk.medium);
            return Goes::On;
        }
        sight.add_surface(scene, &s, walk.ray.d, walk.path, &mut sample.out);
        let vertex = Vertex::new(scene, &s, -walk.ray.d);
        if walk.depth < self.settings.max_depth.0 {
            self.glossy_light_in_media(&vertex, walk, sample, scratch);
        }
        match self.step(&vertex, &mut sample.sampler) {
            Step::Gather(weight) if walk.depth < self.settings.max_depth.0 => {
                self.gather_in_media(maps, &vertex, walk, walk.path.throughput * weight, sample, scratch);
                Goes::Over
            }
            Step::Follow { wo, weight, eta, density, .. } => {
                walk.path.throughput *= weight;
                walk.eta *= eta;
                self.follow(walk, &s, s.frame.to_world(wo), density, sample)
            }
            Step::Gather(_) | Step::End => Goes::Over,
        }
    }

    /// On along `d`.
    fn follow(
        &self,
        walk: &mut Walk,
        s: &Surface,
        d: Vec3,
        density: Density,
        sample: &mut CameraSample,
    ) -> Goes {
        walk.medium = self.task.scene.medium_beyond(s, d, walk.medium);
        walk.ray = s.leave(d);
        walk.start = Some((s.ng, s.gap(d)));
        match density {
            Density::Kept => return Goes::On,
            Density::Specular => walk.pdf = 0.0,
            Density::Glossy(density) => (walk.pdf, walk.from) = (density, s.p),
        }
        walk.seen = true;
        if walk.depth >= self.settings.rr_depth {
            let length = Length { segments: walk.depth, most: self.settings.max_depth.0 };
            let survival = roulette::camera_survival_in_media(walk.path.throughput, walk.eta, length);
            let Some(throughput) = roulette::survivor(walk.path.throughput, survival, &mut sample.sampler)
            else {
                return Goes::Over;
            };
            walk.path.throughput = throughput;
        }
        walk.depth += 1;
        Goes::On
    }

    /// As [`PhotonMapper::glossy_light`].
    fn glossy_light_in_media(
        &self,
        vertex: &Vertex<'_>,
        walk: &Walk,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let lobes = self.glossy();
        if vertex.closure.has_smooth(vertex.wi, lobes) {
            let left = self.settings.max_depth.0 - walk.depth;
            let (sampler, rays) = (&mut sample.sampler, &mut scratch.rays);
            let light = self.next_event_in_media(vertex, walk.medium, (lobes, true), left, sampler, rays);
            sample.out.add(walk.path.class.layer(), walk.path.throughput * light);
        }
    }

    /// As [`PhotonMapper::gather`].
    fn gather_in_media(
        &self,
        maps: &Maps,
        vertex: &Vertex<'_>,
        walk: &Walk,
        throughput: Color,
        sample: &mut CameraSample,
        scratch: &mut Scratch,
    ) {
        let (scene, facts) = (self.task.scene, self.task.facts);
        let left = self.settings.max_depth.0 - walk.depth;
        let sampler = &mut sample.sampler;
        if self.settings.nee {
            let (lobes, mis, rays) = (self.rough(), facts.large_lamps, &mut scratch.rays);
            let mut direct = self.next_event_in_media(vertex, walk.medium, (lobes, mis), left, sampler, rays);
            if mis {
                direct += self.scattered_lamp_in_media(vertex, walk.medium, lobes, sampler, rays);
            }
            sample.out.add(PathClass::Direct.layer(), throughput * direct);
        }
        let side = scene.photon_side(vertex.surface, vertex.back);
        let at = GatherPoint { vertex, side, throughput, max_photon_depth: left };
        self.read(maps, &at, sampler, scratch, &mut sample.out);
    }
}
