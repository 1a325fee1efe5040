use super::{Distribution, Microfacet, Shadowing};
use crate::bsdf::{Point, Range};
use crate::spectrum::scalar;
use crate::texture::Param;

/// Parameters of a microfacet distribution.
#[derive(Clone, Copy, Debug)]
pub struct Roughness {
    /// How normals are distributed.
    pub kind: Distribution,
    /// How masking and shadowing are combined.
    pub shadowing: Shadowing,
    /// α along s and t, or what its square root is taken of.
    pub u: Param,
    /// Of the axis t.
    pub v: Param,
    /// α = √parameter (pbrt's `remaproughness`).
    pub root: bool,
}

impl Roughness {
    fn alpha(&self, value: f32) -> f32 {
        if self.root { value.max(0.0).sqrt() } else { value }
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
