//! Distributions of microfacet normals, with Smith's masking.

mod alpha_table;
mod roughness;
mod transmittance;
mod visible;

pub(super) use alpha_table::{AlphaTable, cosine_entry};
pub use roughness::{Remap, Roughness};
pub use transmittance::Transmittance;
pub(super) use visible::VisibleNormals;

use std::f32::consts::{FRAC_2_SQRT_PI, PI};

use crate::math::{Vec2, Vec3, erf, erf_inv, gauss};
use crate::sampling::warp;

/// How normals are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Gaussian slopes (Beckmann and Spizzichino 1963).
    Beckmann,
    /// Long tails (Trowbridge and Reitz 1975; Walter et al. 2007).
    Ggx,
    /// Ashikhmin and Shirley's cosine power of exponents 2/α² − 2 (Mitsuba 0.6).
    Phong,
}

/// Masking and shadowing together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shadowing {
    /// G1(wi)·G1(wo): Mitsuba.
    Separable,
    /// 1/(1 + Λ(wi) + Λ(wo)): pbrt.
    HeightCorrelated,
}

/// A distribution at a point; α along the frame's s and t.
#[derive(Clone, Copy, Debug)]
pub struct Microfacet {
    /// How normals are distributed.
    pub kind: Distribution,
    /// How masking and shadowing are combined.
    pub shadowing: Shadowing,
    /// α along s.
    pub au: f32,
    /// α along t.
    pub av: f32,
}

/// Smoothest surface that single precision resolves (Mitsuba's clamp).
pub const MIN_ALPHA: f32 = 1e-4;

impl Microfacet {
    /// α is at least [`MIN_ALPHA`]; that of a broken texture (NaN) becomes it.
    pub fn new(kind: Distribution, shadowing: Shadowing, au: f32, av: f32) -> Self {
        // f32::max drops a NaN of a broken texture.
        Self { kind, shadowing, au: au.max(MIN_ALPHA), av: av.max(MIN_ALPHA) }
    }

    /// What the lobe counts as among rough and glossy ones.
    pub fn roughness(&self) -> f32 {
        (self.au * self.av).sqrt()
    }

    /// Density of normals per solid angle and projected area.
    pub fn d(&self, m: Vec3) -> f32 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let (x, y) = (m.x / self.au, m.y / self.av);
        let slope = x * x + y * y;
        let z2 = m.z * m.z;
        let d = match self.kind {
            Distribution::Beckmann => gauss(slope / z2) / (PI * self.au * self.av * z2 * z2),
            Distribution::Ggx => {
                let t = slope + z2;
                1.0 / (PI * self.au * self.av * t * t)
            }
            Distribution::Phong => {
                let [eu, ev] = self.exponents();
                let sin2 = m.x * m.x + m.y * m.y;
                let e = if sin2 > 0.0 { (eu * m.x * m.x + ev * m.y * m.y) / sin2 } else { eu };
                ((eu + 2.0) * (ev + 2.0)).sqrt() / (2.0 * PI) * m.z.powf(e)
            }
        };
        // Products with reciprocals of tiny values further on must stay finite.
        if d * m.z > 1e-20 { d } else { 0.0 }
    }

    fn exponents(&self) -> [f32; 2] {
        [self.au, self.av].map(|a| (2.0 / (a * a) - 2.0).max(0.0))
    }

    /// Smith's masking of the direction `v`; 0 where v and its microfacet disagree about the side.
    pub fn g1(&self, v: Vec3, m: Vec3) -> f32 {
        if v.dot(m) * v.z <= 0.0 { 0.0 } else { 1.0 / (1.0 + self.lambda(v)) }
    }

    fn lambda(&self, v: Vec3) -> f32 {
        let (x, y) = (self.au * v.x, self.av * v.y);
        let tan2 = (x * x + y * y) / (v.z * v.z);
        if tan2 == 0.0 {
            return 0.0;
        }
        match self.kind {
            Distribution::Ggx => 0.5 * ((1.0 + tan2).sqrt() - 1.0),
            // Walter et al. 2007, eq. 27.
            Distribution::Beckmann | Distribution::Phong => {
                let a = 1.0 / tan2.sqrt();
                if a >= 1.6 {
                    return 0.0;
                }
                let g = (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a);
                1.0 / g - 1.0
            }
        }
    }

    /// Masking and shadowing of both directions.
    pub fn g(&self, wi: Vec3, wo: Vec3, m: Vec3) -> f32 {
        match self.shadowing {
            Shadowing::Separable => self.g1(wi, m) * self.g1(wo, m),
            Shadowing::HeightCorrelated => {
                if wi.dot(m) * wi.z <= 0.0 || wo.dot(m) * wo.z <= 0.0 {
                    return 0.0;
                }
                1.0 / (1.0 + self.lambda(wi) + self.lambda(wo))
            }
        }
    }

    /// Density of [`Microfacet::sample`] per solid angle of `m`; `wi.z` > 0, `cos` = |wi·m|.
    pub fn pdf(&self, wi: Vec3, m: Vec3, cos: f32) -> f32 {
        match self.kind {
            Distribution::Phong => self.d(m) * m.z,
            Distribution::Beckmann | Distribution::Ggx => self.d(m) * self.g1(wi, m) * cos / wi.z,
        }
    }

    /// D·G of both directions and [`Microfacet::pdf`].
    pub fn dg_pdf(&self, wi: Vec3, wo: Vec3, m: Vec3, cos: f32) -> (f32, f32) {
        let d = self.d(m);
        if self.kind == Distribution::Phong {
            return (d * self.g(wi, wo, m), d * m.z);
        }
        let seen = self.g1(wi, m);
        let g = match self.shadowing {
            Shadowing::Separable => seen * self.g1(wo, m),
            Shadowing::HeightCorrelated => self.g(wi, wo, m),
        };
        (d * g, d * seen * cos / wi.z)
    }

    /// A normal visible from `wi` (Heitz and d'Eon 2014); any normal for the Phong distribution.
    pub fn sample(&self, wi: Vec3, u: Vec2) -> Vec3 {
        if self.kind == Distribution::Phong {
            return self.sample_phong(u);
        }
        let stretched = self.stretched(wi);
        let r = (stretched.x * stretched.x + stretched.y * stretched.y).sqrt();
        let (cos, sin) = if r > 0.0 { (stretched.x / r, stretched.y / r) } else { (1.0, 0.0) };
        let slope = match self.kind {
            Distribution::Ggx => ggx_slope(stretched.z, warp::disk(u)),
            _ => Vec2::new(beckmann_slope_x(stretched.z, u.x), beckmann_slope_y(u.y)),
        };
        let x = (cos * slope.x - sin * slope.y) * self.au;
        let y = (sin * slope.x + cos * slope.y) * self.av;
        Vec3::new(-x, -y, 1.0).normalize_or(Vec3::Z)
    }

    fn stretched(&self, wi: Vec3) -> Vec3 {
        Vec3::new(self.au * wi.x, self.av * wi.y, wi.z).normalize_or(Vec3::Z)
    }

    /// Ashikhmin and Shirley 2000.
    fn sample_phong(&self, u: Vec2) -> Vec3 {
        let [eu, ev] = self.exponents();
        let phi = (((eu + 2.0) / (ev + 2.0)).sqrt() * (2.0 * PI * u.y).tan()).atan();
        // The arctangent folds the circle onto half of it.
        let phi = if (u.y - 0.5).abs() < 0.25 { phi + PI } else { phi };
        let (sin, cos) = phi.sin_cos();
        let e = eu * cos * cos + ev * sin * sin;
        let z = (1.0 - u.x).powf(1.0 / (e + 2.0));
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, z)
    }
}

/// Slope seen under cosθ for α = 1, from a point of the unit disk (Heitz 2018, projected hemisphere).
fn ggx_slope(cos: f32, p: Vec2) -> Vec2 {
    let s = 0.5 * (1.0 + cos);
    let x = p.x;
    let y = (1.0 - s) * (1.0 - x * x).max(0.0).sqrt() + s * p.y;
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vec2::new(cos * y - sin * z, x) / (sin * y + cos * z)
}

/// The same for Beckmann: the distribution function inverted in the domain of erf (Jakob 2014), by Halley's method: its
/// second derivative costs nothing, and two steps are as good as three of Newton's.
fn beckmann_slope_x(cos: f32, u: f32) -> f32 {
    const INV_SQRT_PI: f32 = 0.5 * FRAC_2_SQRT_PI;
    let tan = (1.0 - cos * cos).max(0.0).sqrt() / cos;
    let cot = 1.0 / tan;
    let u = u.clamp(1e-6, 1.0 - 1e-6);
    let max = erf(cot);
    let mut x = max - (max + 1.0) * erf((-u.ln()).sqrt());
    let wanted = u * (1.0 + max + INV_SQRT_PI * tan * gauss(cot * cot));
    for _ in 0..2 {
        let slope = erf_inv(x);
        let height = gauss(slope * slope);
        let value = 1.0 + x + INV_SQRT_PI * tan * height - wanted;
        let derivative = 1.0 - slope * tan;
        let newton = value / derivative;
        x -= newton / (1.0 + newton * tan / (4.0 * INV_SQRT_PI * height * derivative));
    }
    erf_inv(x)
}

/// Across the direction that it is seen from, the slope is a Gaussian.
fn beckmann_slope_y(u: f32) -> f32 {
    erf_inv(2.0 * u.clamp(1e-6, 1.0 - 1e-6) - 1.0)
}

/// Mirror image of `wi` about the normal `m`.
#[inline]
pub fn reflect(wi: Vec3, m: Vec3) -> Vec3 {
    m * (2.0 * wi.dot(m)) - wi
}

/// Refraction about `m`, with the signed cosine and the relative index of `fresnel::dielectric`.
#[inline]
pub fn refract(wi: Vec3, m: Vec3, cos_t: f32, eta: f32) -> Vec3 {
    m * (wi.dot(m) / eta + cos_t) - wi / eta
}
