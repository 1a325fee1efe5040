//! Light scattered into a segment of a camera path (Jarosz, Nowrouzezahrai, Jensen 2008; Křivánek et al. 2014), blurred
//! across it by the Epanechnikov kernel K(d) = 2/(π·r²)·(1 − d²/r²):
//!
//! - photons: L = Σ Φ·p(ω)·T(t)·K(d), where Φ is what the medium scatters (after the collision);
//! - beams: L = Σ Φ·σ_s·p(ω)·T(t)·∫K ds, where Φ is the flux on its way, and the integral goes along the beam.
//!
//! A photon is one random point of a beam, with density σ_t per length: so both have the same mean.

use std::fmt::Debug;

use super::{BeamMap, Crossing, Near, PointMap, Segment};
use crate::math::kernel::{Epanechnikov, Kernel};
use crate::math::{Color, Vec3, decode_direction};

/// What the medium of a segment says.
pub trait Passage: Debug + Sync {
    /// Share of the light that gets from the place at distance `t` of the segment to its start, and on to the camera.
    fn transmittance(&self, t: f32) -> Color;
    /// Phase function at `p`, 1/sr, of light that comes from the unit direction `wi` and goes back along the segment.
    fn phase(&self, p: Vec3, wi: Vec3) -> f32;
    /// Scattering coefficient at `p` of light that goes along the unit direction `d`, 1/length.
    fn scattering(&self, p: Vec3, d: Vec3) -> Color;
}

/// The segment that light is wanted for, and what of the photons counts.
#[derive(Clone, Copy, Debug)]
pub struct VolumeGather<'a, P: ?Sized> {
    /// Where.
    pub segment: &'a Segment,
    /// Photons of other media are no light in this one.
    pub medium: u32,
    /// Segments of the longest light path that counts.
    pub max_photon_depth: u32,
    /// The medium.
    pub passage: &'a P,
}

/// Scratch and counters of one thread.
#[derive(Debug, Default)]
pub struct Found {
    points: Vec<Near>,
    beams: Vec<Crossing>,
    /// Segments that were searched.
    pub lookups: u64,
    /// Photons and pieces of beams found.
    pub photons: u64,
}

impl PointMap {
    /// Radiance at the start of a segment.
    pub fn radiance<P: Passage>(&self, at: &VolumeGather<'_, P>, found: &mut Found) -> Color {
        found.lookups += 1;
        self.along(at.segment, &mut found.points);
        found.photons += found.points.len() as u64;
        let r2 = self.radius * self.radius;
        let mut sum = Color::ZERO;
        for near in &found.points {
            let i = near.index as usize;
            if self.medium[i] != at.medium || u32::from(self.depth[i]) > at.max_photon_depth {
                continue;
            }
            let phase = at.passage.phase(self.place(near.index), decode_direction(self.direction[i]));
            let flux = Color::from_lanes(self.flux.each_ref().map(|lane| lane[i]));
            sum += flux * at.passage.transmittance(near.t) * (phase * Epanechnikov::shape(near.d2 / r2));
        }
        sum * (1.0 / (Epanechnikov::mass() * f64::from(r2))) as f32
    }
}

impl BeamMap {
    /// Radiance at the start of a segment.
    pub fn radiance<P: Passage + ?Sized>(&self, at: &VolumeGather<'_, P>, found: &mut Found) -> Color {
        let mut sum = Color::ZERO;
        self.each(at, found, |_, light| sum += light);
        sum
    }

    /// The same piece by piece: calls `brings` with the number of each beam and what a piece of it adds.
    #[inline]
    pub fn each<P: Passage + ?Sized>(
        &self,
        at: &VolumeGather<'_, P>,
        found: &mut Found,
        mut brings: impl FnMut(u32, Color),
    ) {
        found.lookups += 1;
        self.along(at.segment, &mut found.beams);
        found.photons += found.beams.len() as u64;
        for crossing in &found.beams {
            let i = crossing.beam as usize;
            if self.medium[i] != at.medium || u32::from(self.depth[i]) > at.max_photon_depth {
                continue;
            }
            let phase = at.passage.phase(crossing.p, -crossing.d);
            let flux = Color::from_lanes(self.flux.each_ref().map(|lane| lane[i]));
            let scattered = flux * at.passage.scattering(crossing.p, crossing.d);
            brings(
                crossing.beam,
                scattered * at.passage.transmittance(crossing.t) * (phase * crossing.weight),
            );
        }
    }
}
