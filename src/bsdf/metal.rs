use super::{Point, fresnel};
use crate::math::Color;
use crate::texture::Param;

/// What a conductor is made of.
#[derive(Clone, Copy, Debug)]
pub enum Metal {
    /// Reflects everything.
    Mirror,
    /// Complex index, in units of the index outside.
    Index {
        /// Real part.
        eta: Param,
        /// Imaginary part: absorption.
        k: Param,
        /// Index of what lies above the metal.
        outside: f32,
    },
    /// η = 1 and the k with this reflectance at normal incidence in air (pbrt).
    Reflectance {
        /// At normal incidence in air.
        normal: Param,
        /// Index of what lies above the metal.
        outside: f32,
    },
}

impl Metal {
    pub(super) fn at(&self, point: &Point<'_>) -> MetalAt {
        match *self {
            Self::Mirror => MetalAt(None),
            Self::Index { eta, k, outside } => {
                MetalAt(Some((point.color(eta) / outside, point.color(k) / outside)))
            }
            Self::Reflectance { normal, outside } => {
                let r = point.color(normal).clamp(Color::ZERO, Color::splat(0.9999));
                let root = |c: Color| c.map(f32::sqrt);
                let k = root(r) * 2.0 / root(Color::ONE - r);
                MetalAt(Some((Color::ONE / outside, k / outside)))
            }
        }
    }

    pub(super) fn params(&self) -> Vec<Param> {
        match *self {
            Self::Mirror => vec![],
            Self::Index { eta, k, .. } => vec![eta, k],
            Self::Reflectance { normal, .. } => vec![normal],
        }
    }
}

/// η and k at a point.
#[derive(Clone, Copy, Debug)]
pub struct MetalAt(pub(super) Option<(Color, Color)>);

impl MetalAt {
    /// Reflectance by colour at the cosine `cos` of the angle to the normal.
    pub fn fresnel(&self, cos: f32) -> Color {
        self.0.map_or(Color::ONE, |(eta, k)| fresnel::conductor(cos, eta, k))
    }
}
