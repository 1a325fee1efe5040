//! Glints, as camera paths add them.

use super::{Maps, PhotonMapper};
use crate::film::Radiance;
use crate::math::Color;
use crate::photon::{Boundary, Gather, GatherPoint};
use crate::sampling::Sampler;
use crate::transport::Vertex;

impl PhotonMapper<'_> {
    /// Adds the glints that a glossy surface, the first of a camera path of `depth` segments, sends back along it, times
    /// `throughput`.
    pub(super) fn glints(
        &self,
        maps: &Maps,
        vertex: &Vertex<'_>,
        (throughput, depth): (Color, u32),
        sampler: &mut Sampler,
        rays: &mut u64,
        gather: &mut Gather,
        out: &mut Radiance,
    ) {
        let Some((map, estimator)) = maps.caustic.as_ref().and_then(|map| map.apart.as_ref()) else {
            return;
        };
        let at = GatherPoint {
            vertex,
            side: self.task.scene.glint_side(vertex.surface, vertex.back),
            throughput,
            max_photon_depth: self.settings.max_depth.0 - depth,
        };
        let boundary = self.surroundings().map(|around| Boundary { around, sampler, rays });
        estimator.glints(map, &at, boundary, gather, out);
    }
}
