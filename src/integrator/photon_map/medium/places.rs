//! Where camera paths go through media: segments found by walking them without light.

use super::super::PhotonMapper;
use super::super::places::film_grid;
use super::super::walk::Step;
use super::stretch::Stretch;
use crate::math::{Ray, Vec2};
use crate::photon::radius::quantile;
use crate::photon::volume::Segment;
use crate::sampling::{Sampler, mix};
use crate::transport::Vertex;

/// Most rays of a camera path that are followed.
const LONGEST: u32 = 16;

impl PhotonMapper<'_> {
    /// Segments of camera rays through a regular grid of the film, and the median size of a pixel in their middles, or
    /// after a mean free path where that is nearer.
    pub(in super::super) fn segments(&self) -> (Vec<Segment>, f32) {
        let mut segments = Vec::new();
        for (i, at) in film_grid() {
            let sampler = Sampler::new(mix(self.settings.seed ^ 0x5e9e_3e75), i);
            self.add_segments(at, sampler, &mut segments);
        }
        let height = self.task.view.film.height;
        let size = |(_, distance): &(Segment, f32)| self.task.view.sensor.pixel_footprint(height, *distance);
        let mut sizes: Vec<f32> = segments.iter().map(size).collect();
        let pixel = quantile(&mut sizes, 0.5).unwrap_or(0.0);
        (segments.into_iter().map(|(segment, _)| segment).collect(), pixel)
    }

    /// Adds those of a camera path from a position of the rendered part, in [0, 1]², with the distance of these places.
    fn add_segments(&self, at: Vec2, mut sampler: Sampler, segments: &mut Vec<(Segment, f32)>) {
        let (scene, view) = (self.task.scene, self.task.view);
        let mut ray = view.sensor.ray(view.place_in_crop(at), sampler.next_2d()).normalised();
        let mut medium = view.medium;
        let mut length = view.sensor.near;
        for _ in 0..LONGEST {
            let hit = scene.geometry.closest(&ray);
            if let Some(medium) = scene.medium(medium).filter(|medium| medium.scatters()) {
                let part = Ray { tmax: hit.as_ref().map_or(ray.tmax, |hit| hit.t), ..ray };
                let segment = Stretch::new(medium, &part, [None; 2], &mut sampler).segment;
                // In endless fog most of what is seen is near.
                let seen = (0.5 * segment.length).min(1.0 / medium.mean().sigma_t.max_element());
                segments.push((segment, length + seen));
            }
            let Some(hit) = hit else { return };
            length += hit.t;
            let s = scene.surface(&ray, &hit);
            let vertex = Vertex::new(scene, &s, -ray.d);
            let Step::Follow { wo, .. } = self.step(&vertex, &mut sampler) else { return };
            let d = s.frame.to_world(wo);
            medium = scene.medium_beyond(&s, d, medium);
            ray = s.leave(d);
        }
    }
}
