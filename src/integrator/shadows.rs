//! Shadow rays of camera paths that go together: sent with what they bring, answered in bundles.

use super::CameraSample;
use super::direct::Proposal;
use crate::film::Layer;
use crate::math::{Color, Ray};
use crate::scene::{Facts, Scene};
use crate::transport::{Vertex, shadow_ray, visibility};

/// Light on its way to samples, by their index.
#[derive(Debug, Default)]
pub struct Shadows {
    rays: Vec<Ray>,
    values: Vec<(usize, Layer, Color)>,
    occluded: Vec<bool>,
    /// Rays since the last time they were answered, with those that were answered at once.
    sent: u64,
}

impl Shadows {
    /// Sends light to `vertex`, which brings `value` to a layer of sample `i` if nothing stands between. `segments` is
    /// how many path segments may follow.
    #[inline(always)]
    pub fn send(
        &mut self,
        scene: &Scene,
        facts: &Facts,
        vertex: &Vertex<'_>,
        light: &Proposal,
        (i, layer, value): (usize, Layer, Color),
        segments: u32,
        sample: &mut CameraSample,
    ) {
        self.sent += 1;
        if facts.transparent_shadows {
            let through = visibility(scene, vertex.surface, &light.light, true, segments);
            sample.out.add(layer, value * through);
        } else {
            self.rays.push(shadow_ray(vertex.surface, &light.light));
            self.values.push((i, layer, value));
        }
    }

    /// Answers all rays and adds what arrives to the samples. Returns how many rays there were.
    #[inline(always)]
    pub fn answer(&mut self, scene: &Scene, samples: &mut [CameraSample]) -> u64 {
        scene.geometry.occluded_each(&self.rays, &mut self.occluded);
        for (&(i, layer, value), &occluded) in self.values.iter().zip(&self.occluded) {
            if !occluded {
                samples[i].out.add(layer, value);
            }
        }
        self.rays.clear();
        self.values.clear();
        std::mem::take(&mut self.sent)
    }

    /// Counts rays that were traced beside these.
    #[inline(always)]
    pub fn count(&mut self, rays: u64) {
        self.sent += rays;
    }
}
