//! Everything that the first rough surface of a camera path sends back along it.

use super::super::Scratch;
use super::super::direct::{next_event, scattered_lamp};
use super::{Maps, PhotonMapper};
use crate::film::Radiance;
use crate::math::Color;
use crate::photon::{Boundary, GatherPoint};
use crate::sampling::Sampler;
use crate::transport::{PathClass, Vertex};

impl PhotonMapper<'_> {
    /// Adds direct light and what the maps say to `out`, times `throughput`; `depth` counts the segments of
    /// the camera path up to here.
    pub(super) fn gather(
        &self,
        maps: &Maps,
        vertex: &Vertex<'_>,
        throughput: Color,
        depth: u32,
        sampler: &mut Sampler,
        scratch: &mut Scratch,
        out: &mut Radiance,
    ) {
        let (scene, facts, settings) = (self.task.scene, self.task.facts, &self.settings);
        let left = settings.max_depth.0 - depth;
        if settings.nee {
            let mis = facts.large_lamps;
            let (lobes, rays) = (self.rough(), &mut scratch.rays);
            let mut direct = next_event(scene, facts, vertex, lobes, mis, left, sampler, rays);
            if mis {
                direct += scattered_lamp(scene, vertex, lobes, left, sampler, rays);
            }
            out.add(PathClass::Direct.layer(), throughput * direct);
        }
        let side = scene.photon_side(vertex.surface, vertex.back);
        let at = GatherPoint { vertex, side, throughput, max_photon_depth: left };
        self.read(maps, &at, sampler, scratch, out);
    }

    /// Adds what the maps of surfaces say.
    pub(super) fn read(
        &self,
        maps: &Maps,
        at: &GatherPoint<'_>,
        sampler: &mut Sampler,
        scratch: &mut Scratch,
        out: &mut Radiance,
    ) {
        let before = scratch.rays;
        let focused = maps.global.as_ref().and_then(|map| map.apart.as_ref());
        let whole =
            [&maps.global, &maps.caustic].into_iter().flatten().map(|map| (&map.photons, &map.estimator));
        for (photons, estimator) in whole.chain(focused.map(|(photons, estimator)| (photons, estimator))) {
            let rays = &mut scratch.rays;
            let boundary = self.surroundings().map(|around| Boundary { around, sampler, rays });
            estimator.estimate(photons, at, boundary, &mut scratch.gather, out);
        }
        scratch.edge_rays += scratch.rays - before;
    }
}
