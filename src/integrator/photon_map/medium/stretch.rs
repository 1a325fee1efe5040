//! A piece of a camera path in one medium.

use crate::math::{Color, Ray, Vec3};
use crate::medium::{Heterogeneous, Medium};
use crate::photon::volume::{Passage, Segment};
use crate::sampling::Sampler;

/// Optical depth at which a ray without an end is cut.
const DEEPEST: f32 = 1e3;

/// Light left at which an estimate plays roulette, and the probability of going on.
const LITTLE: f32 = 0.05;
const KEEP: f32 = 0.25;

/// See the module.
#[derive(Debug)]
pub struct Stretch<'a> {
    medium: &'a Medium,
    /// Of finite length: beyond it nothing is scattered that would get back.
    pub segment: Segment,
    left: Left,
}

/// What is left of light on its way back to the start.
#[derive(Debug)]
enum Left {
    /// By an extinction that is the same everywhere.
    Even(Color),
    /// An estimate whose mean is right at each place (ratio tracking): from each distance on, what is left there.
    Steps(Vec<(f32, Color)>),
}

impl<'a> Stretch<'a> {
    /// Of a ray with unit direction that is in the medium all along; its two ends may be at surfaces, whose normals they
    /// are then.
    pub fn new(medium: &'a Medium, part: &Ray, ends: [Option<Vec3>; 2], sampler: &mut Sampler) -> Self {
        let (left, reach) = match medium {
            Medium::Homogeneous(_) => {
                let sigma = medium.mean().sigma_t;
                (Left::Even(sigma), DEEPEST / sigma.max_element().max(f32::MIN_POSITIVE))
            }
            Medium::Heterogeneous(m) => {
                let (steps, end) = track(m, medium, part, sampler);
                (Left::Steps(steps), if part.tmax < f32::INFINITY { part.tmax } else { end })
            }
        };
        let mut segment = Segment::new(part.o, part.d, part.tmax.min(reach).min(f32::MAX));
        if let Some(normal) = ends[0] {
            segment = segment.begins_at(normal);
        }
        if let Some(normal) = ends[1].filter(|_| segment.length == part.tmax) {
            segment = segment.ends_at(normal);
        }
        Self { medium, segment, left }
    }

    /// What is left of light from the end of the ray.
    pub fn all(&self) -> Color {
        self.transmittance(self.segment.length)
    }
}

/// What is left of light by distance, and where the medium ends.
fn track(m: &Heterogeneous, medium: &Medium, ray: &Ray, sampler: &mut Sampler) -> (Vec<(f32, Color)>, f32) {
    let mut steps = Vec::new();
    let (mut left, mut end) = (Color::ONE, 0.0);
    for part in m.majorants().along(ray) {
        if part.majorant <= 0.0 {
            continue;
        }
        end = part.end;
        let mut t = part.begin;
        loop {
            t -= (-sampler.random()).ln_1p() / part.majorant;
            if t >= part.end || left.max_element() <= 0.0 {
                break;
            }
            let extinction = medium.at(ray.at(t), ray.d).sigma_t;
            left *= Color::ONE - (extinction / part.majorant).min(Color::ONE);
            if left.max_element() < LITTLE {
                left = if sampler.random() < KEEP { left / KEEP } else { Color::ZERO };
            }
            steps.push((t, left));
        }
    }
    (steps, end)
}

impl Passage for Stretch<'_> {
    #[inline]
    fn transmittance(&self, t: f32) -> Color {
        match &self.left {
            Left::Even(sigma) => (*sigma * -t).exp(),
            Left::Steps(steps) => {
                let before = steps.partition_point(|(at, _)| *at <= t);
                before.checked_sub(1).map_or(Color::ONE, |last| steps[last].1)
            }
        }
    }

    #[inline]
    fn phase(&self, p: Vec3, wi: Vec3) -> f32 {
        // As photons are scattered: from where they came to the camera.
        self.medium.phase().eval(p, wi, -self.segment.d)
    }

    #[inline]
    fn scattering(&self, p: Vec3, d: Vec3) -> Color {
        self.medium.at(p, d).sigma_s
    }
}
