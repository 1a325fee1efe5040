//! Perturbed shading frames: bump and normal maps.

use crate::bsdf::Point;
use crate::math::{Frame, Vec2, Vec3};
use crate::spectrum::to_rgb;
use crate::texture::Param;

/// Where the tilted normal comes from.
#[derive(Clone, Copy, Debug)]
pub enum Relief {
    /// A bump map.
    Bump {
        /// Height over the surface as a function of uv.
        height: Param,
        /// Scene units of a height of 1.
        scale: f32,
    },
    /// n = 2c − 1 in the shading frame.
    Normal(Param),
}

impl Relief {
    pub(super) fn param(&self) -> Param {
        match *self {
            Self::Bump { height, .. } => height,
            Self::Normal(normals) => normals,
        }
    }
}

/// A bump or normal map.
#[derive(Clone, Copy, Debug)]
pub struct Perturbation {
    /// Where the normal comes from.
    pub relief: Relief,
    /// A normal that faces away from the viewer is mirrored about the untilted one (Mitsuba 3).
    pub flip_invalid: bool,
    /// Shadowing by Conty Estevez et al. 2019 (Mitsuba 3).
    pub shadowing: bool,
}

/// Step of the gradient, in uv: a fraction of a texel of all but huge textures, and large enough for
/// differences of f32 heights.
const STEP: f32 = 1.0 / 16_384.0;

impl Perturbation {
    pub(super) fn at(&self, point: &Point<'_>) -> Tilt {
        let n = match self.relief {
            Relief::Normal(param) => Vec3::from(to_rgb(point.color(param))) * 2.0 - Vec3::ONE,
            Relief::Bump { height, scale } => {
                let h = |d: Vec2| point.shifted(d).scalar(height);
                let slope = |d: Vec2| (h(d) - h(-d)) * (scale / (2.0 * STEP));
                let (gu, gv) = (slope(Vec2::new(STEP, 0.0)), slope(Vec2::new(0.0, STEP)));
                let [u, v] = point.tangents;
                let n = Vec3::new(u.x, u.y, gu).cross(Vec3::new(v.x, v.y, gv));
                if n.z < 0.0 { -n } else { n }
            }
        };
        let n = n.normalize_or(Vec3::Z);
        Tilt {
            n: if n.is_finite() { n } else { Vec3::Z },
            flip: self.flip_invalid,
            shadowing: self.shadowing,
        }
    }
}

/// A tilted normal at a point, in the shading frame.
#[derive(Clone, Copy, Debug)]
pub struct Tilt {
    n: Vec3,
    flip: bool,
    shadowing: bool,
}

impl Tilt {
    /// Whether `viewer` sees the normal mirrored about the untilted one.
    pub fn flipped(&self, viewer: Vec3) -> bool {
        self.flip && viewer.z * viewer.dot(self.n) <= 0.0
    }

    /// Probability with which light whose viewer is not known yet is scattered by the mirrored normal: half
    /// the sine of the tilt, 0 where no viewer sees that normal. Viewers who do lie between the two planes,
    /// and the share of light that they get falls with the square of the tilt; the larger probability keeps
    /// the weights of those paths small.
    pub fn flip_probability(&self) -> f32 {
        if self.flip { 0.5 * (1.0 - self.n.z * self.n.z).max(0.0).sqrt() } else { 0.0 }
    }

    /// The frame of the normal as it is, or mirrored; its s follows the untilted one.
    pub fn frame(&self, flipped: bool) -> Frame {
        let mut n = self.n;
        if flipped {
            n = Vec3::new(-n.x, -n.y, n.z);
        }
        let s = (Vec3::X - n * n.x).normalize_or(Vec3::Y);
        Frame { s, t: n.cross(s), n }
    }

    /// Share of light along `light` that the imagined facets let through.
    pub fn shadow(&self, light: Vec3) -> f32 {
        if !self.shadowing {
            return 1.0;
        }
        let tan2 = |w: Vec3| (1.0 - w.z * w.z).max(0.0) / (w.z * w.z);
        let alpha2 = (0.125 * tan2(self.n)).min(1.0);
        2.0 / (1.0 + (1.0 + alpha2 * tan2(light)).sqrt())
    }
}
