use super::{Distribution, Microfacet, Shadowing};
use crate::bsdf::{Point, Range};
use crate::spectrum::scalar;
use crate::texture::Param;

/// From a parameter to α.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remap {
    /// α itself.
    None,
    /// Its square root (pbrt-v4's `remaproughness`).
    Sqrt,
    /// A polynomial of its logarithm (pbrt-v3's `remaproughness`).
    Polynomial,
}

/// Parameters of a microfacet distribution.
#[derive(Clone, Copy, Debug)]
pub struct Roughness {
    /// How normals are distributed.
    pub kind: Distribution,
    /// How masking and shadowing are combined.
    pub shadowing: Shadowing,
    /// α along s and t, or what `remap` makes it of.
    pub u: Param,
    /// Of the axis t.
    pub v: Param,
    /// What `u` and `v` are.
    pub remap: Remap,
}

impl Roughness {
    fn alpha(&self, value: f32) -> f32 {
        match self.remap {
            Remap::None => value,
            Remap::Sqrt => value.max(0.0).sqrt(),
            Remap::Polynomial => {
                let x = value.max(1e-3).ln();
                1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)))
            }
        }
    }

    pub(in crate::bsdf) fn at(&self, point: &Point<'_>) -> Microfacet {
        let [u, v] = [self.u, self.v].map(|p| self.alpha(point.scalar(p)));
        Microfacet::new(self.kind, self.shadowing, u, v)
    }

    pub(in crate::bsdf) fn params(&self) -> Vec<Param> {
        vec![self.u, self.v]
    }

    /// α where it is the same everywhere.
    pub fn constant(&self) -> Option<[f32; 2]> {
        match (self.u, self.v) {
            (Param::Constant(u), Param::Constant(v)) => Some([self.alpha(scalar(u)), self.alpha(scalar(v))]),
            _ => None,
        }
    }

    /// Mean of both axes' α where it is the same everywhere.
    pub fn isotropic(&self) -> Option<f32> {
        self.constant().map(|[u, v]| (u * v).max(0.0).sqrt())
    }

    /// Bounds of what [`Microfacet::roughness`] may be.
    pub(in crate::bsdf) fn bounds(&self) -> [f32; 2] {
        match self.constant() {
            Some([u, v]) => [Microfacet::new(self.kind, self.shadowing, u, v).roughness(); 2],
            None => [0.0, Range::DIFFUSE],
        }
    }

    pub(in crate::bsdf) fn oriented(&self) -> bool {
        self.u != self.v
    }
}
