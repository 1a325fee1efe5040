//! What sampling a BSDF gives.

use crate::math::{Color, Vec3};

/// What a path carries. Refraction scales radiance by 1/eta², importance (photons) not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// What cameras measure: paths from the camera carry it.
    Radiance,
    /// What photons carry.
    Importance,
}

/// What importance is multiplied by where it is scattered by a shading normal (Veach 1997, eq. 5.19):
/// |wi·ns||wo·ng| / (|wi·ng||wo·ns|), from the cosines of wi and wo to the `shading` and to the `geometric`
/// normal. At grazing angles it has a finite mean but no bound; 100 is the most.
#[inline]
pub fn adjoint_correction(shading: [f32; 2], geometric: [f32; 2]) -> f32 {
    ((shading[0] * geometric[1]) / (geometric[0] * shading[1])).abs().min(100.0)
}

/// Which smooth lobes are meant, by their roughness (α of a microfacet lobe; diffuse is endless).
/// Lobes below the setting `glossy` are followed like mirrors; the others hold photons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    min: f32,
    max: f32,
}

impl Range {
    /// Every smooth lobe.
    pub const ALL: Self = Self { min: 0.0, max: f32::INFINITY };
    /// Roughness of Lambertian lobes.
    pub const DIFFUSE: f32 = f32::MAX;
    /// What counts as the roughness of lobes that camera paths follow however wide they are, unless all lobes
    /// hold photons: rough glass, behind which light is found by rays that go on, not by the few photons that
    /// come through.
    pub const FOLLOWED: f32 = 0.0;

    /// Lobes of roughness `threshold` and above.
    pub fn rough(threshold: f32) -> Self {
        Self { min: threshold, ..Self::ALL }
    }

    /// Lobes below `threshold`.
    pub fn glossy(threshold: f32) -> Self {
        Self { max: threshold, ..Self::ALL }
    }

    /// Whether lobes of this roughness are meant.
    #[inline(always)]
    pub fn contains(self, roughness: f32) -> bool {
        self.min <= roughness && roughness < self.max
    }

    /// Whether the range has lobes of `roughness` or less.
    pub fn begins_below(self, roughness: f32) -> bool {
        self.min <= roughness
    }

    /// Whether Lambertian lobes are meant.
    #[inline(always)]
    pub fn diffuse(self) -> bool {
        self.max > Self::DIFFUSE
    }
}

/// A direction drawn from the smooth part of a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct SmoothSample {
    /// Where the path goes on: of unit length, in the shading frame.
    pub wo: Vec3,
    /// f·|cosθo|/pdf.
    pub weight: Color,
    /// Density per solid angle.
    pub pdf: f32,
    /// As in [`DeltaLobe`].
    pub eta: f32,
}

/// One perfectly specular direction.
#[derive(Clone, Copy, Debug)]
pub struct DeltaLobe {
    /// Where the path goes on: of unit length, in the shading frame.
    pub wo: Vec3,
    /// Share of the incident quantity that goes this way.
    pub weight: Color,
    /// Probability with which a path should choose it among all lobes of the BSDF.
    pub probability: f32,
    /// Index of refraction behind over before the event; 1 for reflection.
    pub eta: f32,
    /// Straight through a pane with parallel faces.
    pub straight: bool,
}

impl DeltaLobe {
    /// What camera paths choose it by: a refracted share counts by the power it carries, without the 1/eta² of radiance.
    #[inline(always)]
    pub fn power(&self) -> f32 {
        (self.weight * (self.eta * self.eta)).max_element()
    }
}

/// Specular directions: rarely more than two.
#[derive(Clone, Debug, Default)]
pub struct Deltas {
    first: [Option<DeltaLobe>; 2],
    more: Vec<DeltaLobe>,
}

impl Deltas {
    pub(super) fn push(&mut self, lobe: DeltaLobe) {
        match self.first.iter_mut().find(|l| l.is_none()) {
            Some(free) => *free = Some(lobe),
            None => self.more.push(lobe),
        }
    }

    /// All of them, in the order in which they were found.
    pub fn iter(&self) -> impl Iterator<Item = &DeltaLobe> {
        self.first.iter().flatten().chain(&self.more)
    }

    pub(super) fn probability(&self) -> f32 {
        self.iter().map(|l| l.probability).sum()
    }
}

/// Where a sampled direction came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A lobe rough enough for photons to be stored.
    Smooth,
    /// A smooth lobe too narrow for that.
    Glossy,
    /// A perfectly specular direction.
    Delta,
    /// Straight through an opening of a mask or an index-matched boundary.
    Null,
}

/// A sampled continuation.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Where the path goes on: of unit length, in the shading frame.
    pub wo: Vec3,
    /// f·|cosθo|/pdf, or the share of the specular direction over its probability.
    pub weight: Color,
    /// Density of `wo` among the lobes of this kind of event, including the probability of choosing
    /// them; 0 for specular and null events.
    pub pdf: f32,
    /// As in [`DeltaLobe`].
    pub eta: f32,
    /// Which kind of lobe it came from.
    pub event: Event,
    /// As in [`DeltaLobe`].
    pub straight: bool,
}

impl Sample {
    /// Light that went on as if there were no surface.
    #[inline(always)]
    pub(super) fn through(wo: Vec3) -> Self {
        Self { wo, weight: Color::ONE, pdf: 0.0, eta: 1.0, event: Event::Null, straight: false }
    }

    /// What happened, in a scene where straight light through panes is a passage or is not.
    #[inline(always)]
    pub fn event_where(&self, panes_pass: bool) -> Event {
        if panes_pass && self.straight { Event::Null } else { self.event }
    }
}
