//! Direct light of a surface in a scene with media.

use super::super::super::direct::{power_heuristic, propose};
use super::super::PhotonMapper;
use crate::bsdf::{Range, Transport};
use crate::math::Color;
use crate::medium::MediumId;
use crate::sampling::Sampler;
use crate::transport::media::{MOST_PASSED, Way, within};
use crate::transport::{Vertex, passage};

impl PhotonMapper<'_> {
    /// Light from one sampled place of a lamp, scattered by `lobes` back along a path in `medium`.
    pub(super) fn next_event_in_media(
        &self,
        vertex: &Vertex<'_>,
        medium: Option<MediumId>,
        (lobes, mis): (Range, bool),
        segments: u32,
        sampler: &mut Sampler,
        rays: &mut u64,
    ) -> Color {
        let (scene, facts) = (self.task.scene, self.task.facts);
        let Some(p) = propose(scene, facts, vertex, lobes, mis, segments, sampler) else {
            return Color::ZERO;
        };
        let way = Way::from_surface(scene, vertex.surface, medium, &p.light);
        p.value * way.passage(scene, &p.light, sampler, rays).left
    }

    /// The other half of multiple importance sampling: the lamp that a direction drawn from `lobes` meets.
    pub(super) fn scattered_lamp_in_media(
        &self,
        vertex: &Vertex<'_>,
        medium: Option<MediumId>,
        lobes: Range,
        sampler: &mut Sampler,
        rays: &mut u64,
    ) -> Color {
        let scene = self.task.scene;
        let (s, wi, closure) = (vertex.surface, vertex.wi, &vertex.closure);
        let (u, u_lobe) = (sampler.next_2d(), sampler.next_1d());
        let Some(sample) = closure.sample_smooth(wi, u_lobe, u, Transport::Radiance, lobes) else {
            return Color::ZERO;
        };
        let pdf = closure.pdf(wi, sample.wo, Transport::Radiance, lobes);
        let d = s.frame.to_world(sample.wo);
        let (mut ray, mut gap, mut medium) = (s.leave(d), s.gap(d), scene.medium_beyond(s, d, medium));
        let mut left = sample.weight;
        for _ in 0..MOST_PASSED {
            *rays += 1;
            let hit = scene.geometry.closest(&ray);
            if let Some(m) = scene.medium(medium) {
                let tmax = hit.as_ref().map_or(ray.tmax, |hit| hit.t);
                left *= m.pass(&within(&ray, gap, tmax), sampler).left;
            }
            let Some(hit) = hit else {
                let seen = scene.background(s.p, d).map(|(radiance, p)| radiance * power_heuristic(pdf, p));
                return left * seen.sum::<Color>();
            };
            let at = scene.surface(&ray, &hit);
            let emitted = scene.emitted(&at, -d);
            if emitted.max_element() > 0.0 {
                return left * emitted * power_heuristic(pdf, scene.pdf_direct_surface(s.p, d, &at));
            }
            left *= passage(scene, &at, d);
            if left.max_element() <= 0.0 {
                break;
            }
            medium = scene.medium_beyond(&at, d, medium);
            (ray, gap) = (at.leave(d), at.gap(d));
        }
        Color::ZERO
    }
}
