use std::f32::consts::{PI, TAU};

use super::Site;
use crate::math::{Vec2, Vec3};

/// Affine map of uv.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    /// u' = u[0]·u + u[1]·v + u[2].
    pub u: [f32; 3],
    /// v' likewise.
    pub v: [f32; 3],
}

impl UvTransform {
    /// The transformed uv.
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        let row = |r: &[f32; 3]| r[0] * uv.x + r[1] * uv.y + r[2];
        Vec2::new(row(&self.u), row(&self.v))
    }
}

/// Affine map of the compiled scene into the space of a texture: rows, the last entry being the offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToTexture(pub [[f32; 4]; 3]);

/// A function of the position of the form a·p + b.
fn affine(row: &[f32; 4], p: Vec3) -> f32 {
    row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]
}

impl ToTexture {
    /// A world-space point in the space of the texture.
    pub fn point(&self, p: Vec3) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(affine(x, p), affine(y, p), affine(z, p))
    }
}

/// How a point of a surface finds its place on a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mapping {
    /// The uv of the surface, transformed.
    Uv(UvTransform),
    /// (θ/π, φ/2π) of the direction from the origin of texture space.
    Spherical(ToTexture),
    /// (½ + φ/2π, z).
    Cylindrical(ToTexture),
    /// Two affine functions of the position.
    Planar([[f32; 4]; 2]),
}

impl Mapping {
    /// Where the texture is looked up.
    #[inline]
    pub fn apply(&self, at: &Site) -> Vec2 {
        match self {
            Self::Uv(m) => m.apply(at.uv),
            Self::Spherical(m) => {
                let d = m.point(at.p).normalize_or(Vec3::Z);
                let phi = d.y.atan2(d.x);
                let turns = if phi < 0.0 { phi / TAU + 1.0 } else { phi / TAU };
                Vec2::new(d.z.clamp(-1.0, 1.0).acos() / PI, turns)
            }
            Self::Cylindrical(m) => {
                let q = m.point(at.p);
                Vec2::new(0.5 + q.y.atan2(q.x) / TAU, q.z)
            }
            Self::Planar([s, t]) => Vec2::new(affine(s, at.p), affine(t, at.p)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice as large as the scene, and moved by one along z.
    const TWICE: ToTexture = ToTexture([[2.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 1.0]]);

    #[test]
    fn angles_and_heights_are_those_of_texture_space() {
        let at = |mapping: Mapping, p: [f32; 3]| {
            mapping.apply(&Site { p: Vec3::from(p), ..Site::flat(Vec2::new(9.0, 9.0)) })
        };
        // (x, y, z) of the scene is (2x, 2y, 2z + 1) there: on its equator where z is −½.
        for (p, expected) in [
            ([1.0, 0.0, -0.5], [0.5, 0.0]),
            ([0.0, 1.0, -0.5], [0.5, 0.25]),
            ([0.0, -1.0, -0.5], [0.5, 0.75]),
            ([0.0, 0.0, 3.0], [0.0, 0.0]),
        ] {
            assert!(at(Mapping::Spherical(TWICE), p).distance(Vec2::from(expected)) < 1e-6, "{p:?}");
        }
        assert!(at(Mapping::Cylindrical(TWICE), [0.0, 3.0, 1.0]).distance(Vec2::new(0.75, 3.0)) < 1e-6);
        let planar = Mapping::Planar([[0.0, 0.0, 1.0, 0.5], [2.0, 0.0, 0.0, 0.0]]);
        assert_eq!(at(planar, [1.0, 7.0, 3.0]), Vec2::new(3.5, 2.0));
    }
}
