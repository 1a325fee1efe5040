use std::f32::consts::FRAC_1_PI;

use super::{DeltaLobe, Deltas, SmoothSample, Transport, fresnel};
use crate::math::{Rgb, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::{Param, Textures};

/// Diffuse base under a smooth dielectric coat, with interreflection between them
/// (Mitsuba's `plastic`; front side only).
#[derive(Clone, Copy, Debug)]
pub struct PlasticModel {
    /// Index of the coat over the index outside.
    pub eta: f32,
    pub diffuse: Param,
    pub specular: Param,
    /// The base colour shifts with every internal bounce.
    pub nonlinear: bool,
}

impl PlasticModel {
    pub fn lobe(&self, textures: &Textures, uv: Vec2) -> Plastic {
        let diffuse = textures.eval(self.diffuse, uv);
        let specular = textures.eval(self.specular, uv);
        let internal = fresnel::diffuse_reflectance(1.0 / self.eta);
        let shift = if self.nonlinear { diffuse } else { Rgb::ONE };
        let (d, s) = (diffuse.element_sum(), specular.element_sum());
        Plastic {
            eta: self.eta,
            base: diffuse / (Rgb::ONE - shift * internal) / (self.eta * self.eta),
            internal,
            specular,
            specular_weight: if d + s > 0.0 { s / (d + s) } else { 0.0 },
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    pub eta: f32,
    /// ρ / (1 − ρₓ·F̄) / η².
    base: Rgb,
    internal: f32,
    specular: Rgb,
    specular_weight: f32,
}

impl Plastic {
    fn transmitted(&self, cos: f32) -> f32 {
        1.0 - fresnel::dielectric(cos, self.eta).reflectance
    }

    pub fn eval(&self, wi: Vec3, wo: Vec3, _: Transport) -> Rgb {
        if wi.z > 0.0 && wo.z > 0.0 {
            self.base * (FRAC_1_PI * self.transmitted(wi.z) * self.transmitted(wo.z))
        } else {
            Rgb::ZERO
        }
    }

    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        if wi.z > 0.0 && wo.z > 0.0 { wo.z * FRAC_1_PI } else { 0.0 }
    }

    pub fn sample(&self, wi: Vec3, u: Vec2, _: Transport) -> Option<SmoothSample> {
        let wo = warp::cosine_hemisphere(u);
        (wi.z > 0.0 && wo.z > 0.0).then(|| SmoothSample {
            wo,
            weight: self.base * (self.transmitted(wi.z) * self.transmitted(wo.z)),
            pdf: wo.z * FRAC_1_PI,
        })
    }

    /// ∫(1 − F)cosθ/π over the outside, divided by η², equals 1 − F̄ inside.
    pub fn albedo(&self, wi: Vec3) -> Rgb {
        if wi.z > 0.0 {
            self.base * (self.transmitted(wi.z) * (1.0 - self.internal) * self.eta * self.eta)
        } else {
            Rgb::ZERO
        }
    }

    pub fn deltas(&self, wi: Vec3, _: Transport) -> Deltas {
        let mut lobes = Deltas::default();
        if wi.z > 0.0 {
            let f = fresnel::dielectric(wi.z, self.eta).reflectance;
            let (s, d) = (f * self.specular_weight, (1.0 - f) * (1.0 - self.specular_weight));
            lobes.push(DeltaLobe {
                wo: Vec3::new(-wi.x, -wi.y, wi.z),
                weight: self.specular * f,
                probability: if s + d > 0.0 { s / (s + d) } else { 0.0 },
                eta: 1.0,
            });
        }
        lobes
    }
}
