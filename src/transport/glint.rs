//! Glints: light of small lamps that the camera sees in a chain of two or more glossy or specular surfaces of which the
//! first that scatters is glossy.
//!
//! A camera path that leaves the glossy surface hardly ever heads for where the rest of the chain leads to the lamp, and
//! brings very much when it does. Photons that came along the chain from the lamp lie there in any number, and are read
//! at the glossy surface. Of a wide lamp, or for a sharp lobe, camera paths do better. Which of the two finds the light
//! is told by both from the path alone, so that every path counts once.

use crate::bsdf::Event;

/// How small a lamp looks from a surface: the density per solid angle with which it is sampled there, as the number of
/// half octaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Smallness(u8);

/// No lamp is smaller: lobes so sharp that photons hardly ever lie in them are left to camera paths.
const MOST: f32 = 34.0;

/// Lamps that are sampled with a lower density are found by camera paths. Lobes of roughness 0.1 have about this.
const LEAST: f32 = 32.0;

/// The lamp has to be this much smaller than the lobe of the glossy surface.
const SMALLER: f32 = 2.0;

impl Smallness {
    /// Of a lamp that is sampled with density `pdf`; 0 stands for one without size.
    #[inline]
    pub fn of(pdf: f32) -> Self {
        if pdf > 0.0 { Self((2.0 * pdf.log2()).clamp(0.0, MOST) as u8) } else { Self(MOST as u8) }
    }

    /// From which on lamps belong to photons where a glossy surface scatters with density `pdf` along the path.
    #[inline]
    pub fn least(pdf: f32) -> Self {
        Self::of(LEAST.max(SMALLER * pdf))
    }

    /// Whether photons may be wanted at all.
    #[inline]
    pub fn enough(self) -> bool {
        self >= Self::of(LEAST)
    }

    /// In six bits.
    #[inline]
    pub fn bits(self) -> u8 {
        self.0
    }

    /// From [`Smallness::bits`].
    #[inline]
    pub fn from_bits(bits: u8) -> Self {
        Self(bits)
    }
}

/// The glossy and specular surfaces of a camera path so far, where it has met no rough one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Chain {
    /// Smallness of lamps that belong to photons, by the first glossy scattering.
    least: Option<Smallness>,
    /// Another surface scattered after it.
    longer: bool,
}

impl Chain {
    /// Of a path that has scattered once more, with density `pdf` if by a glossy lobe.
    #[must_use]
    #[inline]
    pub fn after(self, event: Event, pdf: f32) -> Self {
        match (self.least, event) {
            (_, Event::Null) => self,
            (_, Event::Smooth) => Self::default(),
            (None, Event::Glossy) => Self { least: Some(Smallness::least(pdf)), longer: false },
            (None, Event::Delta) => self,
            (Some(_), _) => Self { longer: true, ..self },
        }
    }

    /// Whether no glossy surface has scattered so far.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.least.is_none()
    }

    /// Whether light belongs to photons that the next surface scatters towards the path, from a lamp that is sampled there
    /// with density `pdf`.
    #[inline]
    pub fn leaves(self, pdf: f32) -> bool {
        self.least.is_some_and(|least| Smallness::of(pdf) >= least)
    }

    /// The same of lamps that the path meets next.
    #[inline]
    pub fn on_the_way(self) -> Option<Smallness> {
        self.least.filter(|_| self.longer)
    }
}
