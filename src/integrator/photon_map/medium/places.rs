//! Where camera paths go through media: their rays there, found by walking them without light.

use std::sync::Arc;

use rayon::prelude::*;

use super::super::super::{CameraSample, Scratch};
use super::super::places::film_grid;
use super::super::walk::{Density, Step};
use super::super::{Maps, PhotonMapper};
use super::stretch::Stretch;
use crate::math::{Color, Ray, Vec2};
use crate::medium::MediumId;
use crate::photon::aim::Line;
use crate::photon::radius::quantile;
use crate::photon::volume::Segment;
use crate::sampling::{Sampler, mix};
use crate::transport::Vertex;

/// Most rays of a camera path that are followed.
const LONGEST: u32 = 16;

/// Camera samples that tell how much light there is besides what the map of media holds.
const LOOKS: u32 = 4;

/// A ray of a camera path through a medium.
#[derive(Debug)]
pub struct Look<'a> {
    place: u32,
    medium: u32,
    stretch: Stretch<'a>,
    throughput: Color,
    /// Segments of the camera path, this one included.
    depth: u32,
    /// Along the ray, where it is seen well: its middle, or after a mean free path where that is nearer.
    seen: f32,
    /// From the camera to there.
    distance: f32,
}

impl Look<'_> {
    /// The way of the ray.
    pub fn segment(&self) -> Segment {
        self.stretch.segment
    }

    /// For aims; a path from lamp to camera has `max_depth` segments at most.
    pub fn line(&self, max_depth: u32) -> Line<'_> {
        Line {
            place: self.place,
            segment: self.stretch.segment,
            medium: self.medium,
            passage: &self.stretch,
            throughput: self.throughput,
            max_photon_depth: max_depth.saturating_sub(self.depth),
            middle: self.stretch.segment.at(self.seen),
        }
    }
}

impl<'a> PhotonMapper<'a> {
    /// Camera rays through a regular grid of the film, and the median size of a pixel where they are seen well.
    pub(in super::super) fn looks(&self) -> (Vec<Look<'a>>, f32) {
        let mut looks = Vec::new();
        for (i, at) in film_grid() {
            let sampler = Sampler::new(mix(self.settings.seed ^ 0x5e9e_3e75), i);
            self.add_looks((i, at), sampler, &mut looks);
        }
        let height = self.task.view.film.height;
        let size = |look: &Look<'_>| self.task.view.sensor.pixel_footprint(height, look.distance);
        let mut sizes: Vec<f32> = looks.iter().map(size).collect();
        let pixel = quantile(&mut sizes, 0.5).unwrap_or(0.0);
        (looks, pixel)
    }

    /// Adds those of a camera path from a position of the rendered part, in [0, 1]².
    fn add_looks(&self, (place, at): (u32, Vec2), mut sampler: Sampler, looks: &mut Vec<Look<'a>>) {
        let (scene, view) = (self.task.scene, self.task.view);
        let mut ray = view.sensor.ray(view.place_in_crop(at), sampler.next_2d()).normalised();
        let mut medium = view.medium;
        let mut length = view.sensor.near;
        let (mut throughput, mut depth) = (Color::ONE, 1);
        for _ in 0..LONGEST {
            let hit = scene.geometry.closest(&ray);
            if let Some(MediumId(index)) = medium {
                let medium = &scene.media[index as usize];
                let part = Ray { tmax: hit.as_ref().map_or(ray.tmax, |hit| hit.t), ..ray };
                let stretch = Stretch::new(medium, &part, [None; 2], &mut sampler);
                let left = stretch.all();
                if medium.scatters() {
                    // In endless fog most of what is seen is near.
                    let seen = (0.5 * stretch.segment.length).min(1.0 / medium.mean().sigma_t.max_element());
                    let distance = length + seen;
                    looks.push(Look { place, medium: index, stretch, throughput, depth, seen, distance });
                }
                throughput *= left;
            }
            let Some(hit) = hit else { return };
            length += hit.t;
            let s = scene.surface(&ray, &hit);
            let vertex = Vertex::new(scene, &s, -ray.d);
            let Step::Follow { wo, weight, density, .. } = self.step(&vertex, &mut sampler) else { return };
            throughput *= weight;
            depth += u32::from(!matches!(density, Density::Kept));
            let d = s.frame.to_world(wo);
            medium = scene.medium_beyond(&s, d, medium);
            ray = s.leave(d);
        }
    }

    /// By place on the film, radiance without what maps hold, its strongest channel.
    pub(in super::super) fn light_without_maps(&self) -> Vec<f32> {
        let maps = Arc::new(Maps { global: None, caustic: None, volume: None });
        let places: Vec<(u32, Vec2)> = film_grid().collect();
        let view = self.task.view;
        let light = |scratch: &mut Scratch, &(i, at): &(u32, Vec2)| {
            let one = |number: u32| {
                let mut sampler =
                    Sampler::new(mix(self.settings.seed ^ mix(0x11_9417 ^ u64::from(i))), number);
                let ray = view.sensor.ray(view.place_in_crop(at), sampler.next_2d());
                let mut sample = CameraSample::new(ray, sampler);
                self.trace_in_media(&maps, &mut sample, scratch);
                sample.out.sum().max_element()
            };
            (0..LOOKS).map(one).filter(|light| light.is_finite()).sum::<f32>() / LOOKS as f32
        };
        places.par_iter().map_init(Scratch::default, light).collect()
    }
}
