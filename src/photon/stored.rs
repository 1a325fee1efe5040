//! Photons in the order in which they were traced, packed until a map takes them.

use crate::math::{Color, LANES, Vec3, decode_direction, encode_direction};
use crate::transport::{PathClass, Smallness};

/// A photon as traced.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// In the world.
    pub p: Vec3,
    /// W per channel.
    pub flux: Color,
    /// Unit, back towards where it came from.
    pub wi: Vec3,
    /// Unit geometric normal of the side it arrived at.
    pub n: Vec3,
    /// Of the light path that left it.
    pub class: PathClass,
    /// Path segments from the lamp, saturating.
    pub depth: u8,
    /// Of the lamp, as the first surface saw it; counts for glints only.
    pub smallness: Smallness,
}

/// A list of photons in three parts. A map sorts one after the other and frees it, so that hardly more than one of them is
/// ever there twice.
#[derive(Clone, Debug, Default)]
pub struct Stored {
    pub(super) places: Vec<[f32; 3]>,
    pub(super) fluxes: Vec<[f32; LANES]>,
    pub(super) rest: Vec<Rest>,
}

/// What a photon is besides place and flux.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    pub direction: u32,
    /// In units of 1/127.
    pub normal: [i8; 3],
    /// Path class in the lowest two bits, smallness of the lamp above.
    pub tag: u8,
    pub depth: u8,
}

impl Rest {
    /// Class of the path.
    #[inline(always)]
    pub fn class(tag: u8) -> PathClass {
        PathClass::from_tag(tag & 3)
    }

    /// Smallness of the lamp.
    #[inline(always)]
    pub fn smallness(tag: u8) -> Smallness {
        Smallness::from_bits(tag >> 2)
    }
}

impl Stored {
    /// Memory of a photon.
    pub const BYTES: usize = size_of::<[f32; 3]>() + size_of::<[f32; LANES]>() + size_of::<Rest>();

    /// How many there are.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Takes memory for so many more, unless it is there.
    pub fn reserve(&mut self, more: usize) {
        self.places.reserve_exact(more);
        self.fluxes.reserve_exact(more);
        self.rest.reserve_exact(more);
    }

    /// For how many there is memory.
    pub fn capacity(&self) -> usize {
        self.places.capacity()
    }

    /// Multiplies the flux of all.
    pub fn scale(&mut self, factor: f32) {
        self.fluxes.iter_mut().flatten().for_each(|flux| *flux *= factor);
    }

    /// Where photon `i` lies.
    pub fn place(&self, i: usize) -> Vec3 {
        self.places[i].into()
    }

    /// Photon `i`; directions are as precise as they are stored.
    pub fn photon(&self, i: usize) -> Photon {
        let Rest { direction, normal, tag, depth } = self.rest[i];
        Photon {
            p: self.place(i),
            flux: Color::from_lanes(self.fluxes[i]),
            wi: decode_direction(direction),
            n: Vec3::from(normal.map(f32::from)).normalize_or(Vec3::Z),
            class: Rest::class(tag),
            depth,
            smallness: Rest::smallness(tag),
        }
    }

    /// Every `step`-th of them.
    pub(super) fn every(&self, step: usize) -> Self {
        Self {
            places: self.places.iter().step_by(step).copied().collect(),
            fluxes: self.fluxes.iter().step_by(step).copied().collect(),
            rest: self.rest.iter().step_by(step).copied().collect(),
        }
    }

    /// All photons.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Photon> {
        (0..self.len()).map(|i| self.photon(i))
    }
}

impl Extend<Photon> for Stored {
    fn extend<T: IntoIterator<Item = Photon>>(&mut self, photons: T) {
        for photon in photons {
            self.places.push(photon.p.to_array());
            self.fluxes.push(photon.flux.lanes());
            self.rest.push(Rest {
                direction: encode_direction(photon.wi),
                normal: photon.n.to_array().map(|x| (x * 127.0).round() as i8),
                tag: photon.class as u8 | photon.smallness.bits() << 2,
                depth: photon.depth,
            });
        }
    }
}

impl<P: AsRef<[Photon]> + ?Sized> From<&P> for Stored {
    fn from(photons: &P) -> Self {
        photons.as_ref().iter().copied().collect()
    }
}

impl FromIterator<Photon> for Stored {
    fn from_iter<T: IntoIterator<Item = Photon>>(photons: T) -> Self {
        let mut stored = Self::default();
        stored.extend(photons);
        stored
    }
}
