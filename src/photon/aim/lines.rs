//! What photons in media are worth, by the camera rays that find them.

use rayon::prelude::*;

use crate::emitter::SceneSphere;
use crate::math::{Color, Vec3};
use crate::photon::radius::{self, Place};
use crate::photon::volume::{Beam, BeamMap, Found, Passage, Segment, VolumeGather};

/// A ray of a camera path through a medium.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Number of the place on the film.
    pub place: u32,
    /// Where it goes.
    pub segment: Segment,
    /// In which medium.
    pub medium: u32,
    /// What the medium does to light.
    pub passage: &'a dyn Passage,
    /// Share of its light that gets to the camera.
    pub throughput: Color,
    /// Segments of the longest light path that counts.
    pub max_photon_depth: u32,
    /// A place of it that is seen well.
    pub middle: Vec3,
}

/// Where a map of light in media is read.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a> {
    /// Rays of camera paths from a regular grid of the film.
    pub lines: &'a [Line<'a>],
    /// By place on the film: radiance that comes there besides what the map holds, its strongest channel.
    pub light: &'a [f32],
    /// Half the width of the line that stands for the rays around it.
    pub radius: f32,
}

/// What a piece of a beam brings to a place on the film.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brought {
    pub beam: u32,
    pub place: u32,
    /// Radiance, its strongest channel.
    pub light: f32,
}

/// No place is darker than this share of the mean: the error of what is black does not matter.
const DARKEST: f64 = 0.1;

impl Lines<'_> {
    /// What `beams` bring.
    pub(super) fn each(&self, beams: &[Beam]) -> Vec<Brought> {
        let map = BeamMap::build(beams, self.radius);
        let along = |found: &mut Found, line: &Line<'_>| {
            let Line { segment, medium, max_photon_depth, passage, .. } = line;
            let at = VolumeGather {
                segment,
                medium: *medium,
                max_photon_depth: *max_photon_depth,
                passage: *passage,
            };
            let mut all = Vec::new();
            map.each(&at, found, |beam, light| {
                let light = (light * line.throughput).max_element();
                if light > 0.0 && light.is_finite() {
                    all.push(Brought { beam, place: line.place, light });
                }
            });
            all
        };
        let all: Vec<Vec<Brought>> = self.lines.par_iter().map_init(Found::default, along).collect();
        all.concat()
    }

    /// By place: what the square of the radiance that a photon brings is worth, from what all bring: errors are relative.
    pub(super) fn worth(&self, brought: &[f64]) -> Vec<f64> {
        let light: Vec<f64> =
            self.light.iter().zip(brought).map(|(own, more)| f64::from(*own) + more).collect();
        let least = DARKEST * light.iter().sum::<f64>() / light.len().max(1) as f64;
        light.iter().map(|light| light.max(least)).map(|l| if l > 0.0 { l.powi(-2) } else { 0.0 }).collect()
    }

    /// A sphere around most of what is seen.
    pub(super) fn around(&self) -> SceneSphere {
        let place = |line: &Line<'_>| Place { p: line.middle, n: line.segment.d, lift: 0.0, footprint: 0.0 };
        radius::around(&self.lines.iter().map(place).collect::<Vec<_>>())
    }
}
