//! Irradiance known beforehand at some places (Christensen 1999): where it is only wanted after a rough surface has
//! mixed it with much else, the value of the nearest of them does.

use std::f32::consts::FRAC_1_PI;

use rayon::prelude::*;

use super::boundary::{Boundary, Surroundings};
use super::estimate::Estimator;
use super::radius::Place;
use super::store::{PhotonMap, Query};
use super::stored::Photon;
use super::{Gather, GatherPoint};
use crate::film::{Layer, Radiance};
use crate::math::Color;
use crate::sampling::{Sampler, mix};
use crate::transport::{PathClass, Smallness};

/// Places with the irradiance there, as if they were photons.
#[derive(Clone, Debug)]
pub struct Irradiance {
    places: PhotonMap,
    /// Path segments of the deepest photon.
    deepest: u8,
}

impl Irradiance {
    /// Reads `map` at `places`, which must not be its own photons: where a photon lies, the density is not what it is
    /// elsewhere. Nor should bright parts have more of them than dark ones, whose nearest place would then often
    /// lie in the light. With the surroundings edges are corrected; counts the rays of that.
    pub fn of(
        places: &[Place],
        map: &PhotonMap,
        estimator: &Estimator,
        around: Option<Surroundings<'_>>,
        key: u64,
    ) -> (Self, u64) {
        let (photons, rays): (Vec<Photon>, Vec<u64>) = places
            .par_iter()
            .with_min_len(256)
            .enumerate()
            .map_init(Gather::default, |gather, (i, at)| {
                let mut sampler = Sampler::new(key ^ mix(i as u64 >> 32), i as u32);
                let mut rays = 0;
                let q = Query { p: at.p, n: at.n, lift: at.lift, radius: estimator.radius };
                let b = around.map(|around| Boundary { around, sampler: &mut sampler, rays: &mut rays });
                let flux = estimator.irradiance(map, &q, b, gather);
                let class = PathClass::Indirect;
                (
                    Photon {
                        p: at.p,
                        flux,
                        wi: at.n,
                        n: at.n,
                        class,
                        depth: 0,
                        smallness: Smallness::default(),
                    },
                    rays,
                )
            })
            .unzip();
        let places = PhotonMap::build_for_nearest(&photons, 1, estimator.radius);
        (Self { places, deepest: map.deepest }, rays.iter().sum())
    }

    /// How many places.
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Memory of the places.
    pub fn bytes(&self) -> usize {
        self.places.bytes()
    }

    /// Adds what a rough surface sends back; false where nothing is known of it.
    pub fn add(&self, at: &GatherPoint<'_>, radius: f32, gather: &mut Gather, out: &mut Radiance) -> bool {
        if at.max_photon_depth < u32::from(self.deepest) {
            return false;
        }
        let (vertex, s) = (at.vertex, at.vertex.surface);
        let Some(albedo) = vertex.closure.lambertian(vertex.wi).filter(|_| !at.side.both) else {
            return false;
        };
        let q = Query { p: s.p, n: at.side.n, lift: s.lift, radius };
        let Some(i) = gather.nearest(&self.places, &q) else { return false };
        let flux = &self.places.flux;
        let e = Color::from_lanes([flux[0][i], flux[1][i], flux[2][i]]);
        out.add(Layer::Indirect, at.throughput * albedo * e * FRAC_1_PI);
        true
    }
}
