//! Where camera paths read the maps: places found by walking them without light.

use rayon::prelude::*;

use super::PhotonMapper;
use super::walk::Step;
use crate::bsdf::Transport;
use crate::math::Vec2;
use crate::photon::radius;
use crate::sampling::{Sampler, mix};
use crate::transport::Vertex;
use crate::transport::walk::{self, Lamps};

/// Most rays of a camera path that are followed.
const LONGEST: u32 = 16;

/// Numbers and positions, in [0, 1]², of a regular grid over the rendered part of the film.
pub(super) fn film_grid() -> impl Iterator<Item = (u32, Vec2)> {
    let side = (radius::PLACES as f32).sqrt() as u32;
    let at = move |i: u32| (i as f32 + 0.5) / side as f32;
    (0..side * side).map(move |i| (i, Vec2::new(at(i % side), at(i / side))))
}

impl PhotonMapper<'_> {
    /// Where camera rays through a regular grid of the film gather.
    pub(super) fn gather_places(&self) -> Vec<radius::Place> {
        film_grid()
            .filter_map(|(i, at)| {
                let sampler = Sampler::new(mix(self.settings.seed ^ 0x007a_d105), i);
                self.rough_place(at, sampler, 0, &mut 0)
            })
            .collect()
    }

    /// Second rough surfaces of `count` camera paths all over the picture: paths of one `key` are stratified. They lie as
    /// densely everywhere as camera paths end there, whether it is bright or dark. Counts rays.
    pub(super) fn second_places(&self, key: u64, count: u32) -> (Vec<radius::Place>, u64) {
        let place = |i: u32| {
            let mut sampler = Sampler::new(key, i);
            let film = sampler.next_2d();
            let mut rays = 0;
            (self.rough_place(film, sampler, 1, &mut rays), rays)
        };
        let (places, rays): (Vec<_>, Vec<u64>) =
            (0..count).into_par_iter().with_min_len(256).map(place).unzip();
        (places.into_iter().flatten().collect(), rays.iter().sum())
    }

    /// The rough surface behind `behind` others on a camera path from a position of the rendered part, in [0, 1]².
    fn rough_place(
        &self,
        at: Vec2,
        mut sampler: Sampler,
        behind: u32,
        rays: &mut u64,
    ) -> Option<radius::Place> {
        let (scene, view, settings) = (self.task.scene, self.task.view, &self.settings);
        let mut ray = view.sensor.ray(view.place_in_crop(at), sampler.next_2d());
        let mut length = view.sensor.near;
        let hidden = settings.hide_emitters && view.hidden_lamps_are_transparent;
        let mut lamps = if hidden { Lamps::Transparent } else { Lamps::Solid };
        let mut left = behind;
        for _ in 0..LONGEST {
            *rays += 1;
            let hit = scene.geometry.closest(&ray)?;
            length += hit.t * ray.d.length();
            let s = scene.surface(&ray, &hit);
            if walk::passes(scene, &mut ray, &hit, &s, lamps) {
                continue;
            }
            lamps = Lamps::Solid;
            let vertex = Vertex::new(scene, &s, -ray.d);
            match self.step(&vertex, &mut sampler) {
                Step::Gather(_) if left > 0 => {
                    left -= 1;
                    let (u_lobe, u) = (sampler.next_1d(), sampler.next_2d());
                    let lobes = self.rough();
                    let on =
                        vertex.closure.sample_smooth(vertex.wi, u_lobe, u, Transport::Radiance, lobes)?;
                    ray = s.leave(s.frame.to_world(on.wo));
                }
                Step::Gather(_) => {
                    let n = scene.photon_side(&s, -ray.d).n;
                    let footprint = view.sensor.pixel_footprint(view.film.height, length);
                    return Some(radius::Place { p: s.p, n, lift: s.lift, footprint });
                }
                Step::Follow { wo, .. } => ray = s.leave(s.frame.to_world(wo)),
                Step::End => return None,
            }
        }
        None
    }
}
