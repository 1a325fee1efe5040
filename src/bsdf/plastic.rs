use std::f32::consts::FRAC_1_PI;

use super::diffuse::cosine_pdf;
use super::{
    Bxdf, DeltaLobe, Deltas, DiffuseBase, Lobes, Nature, Parameters, Point, Range, Scatter, Transport,
    fresnel,
};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Diffuse base under a smooth dielectric coat, with interreflection between them
/// (Mitsuba's `plastic`, pbrt's `coateddiffuse`; front side only).
#[derive(Clone, Copy, Debug)]
pub struct PlasticModel {
    /// Index of the coat over the index outside.
    pub eta: f32,
    /// Reflectance of the diffuse part.
    pub diffuse: Param,
    /// Factor of the specular reflection; 1 is physical.
    pub specular: Param,
    /// What becomes of light between coat and base.
    pub between: DiffuseBase,
}

impl Parameters for PlasticModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let (diffuse, specular) = (point.color(self.diffuse), point.color(self.specular));
        let internal = fresnel::diffuse_reflectance(1.0 / self.eta);
        Plastic {
            eta: self.eta,
            base: self.between.base(diffuse, internal) / (self.eta * self.eta),
            leaves: self.between.leaves(internal),
            between: self.between,
            specular,
            specular_weight: specular_weight(diffuse, specular),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        vec![self.diffuse, self.specular]
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.diffuse)
    }

    fn nature(&self) -> Nature {
        Nature { delta: true, smooth: Some(Nature::DIFFUSE), ..Nature::default() }
    }
}

/// How much of sampling the coat should get, before Fresnel.
pub(super) fn specular_weight(diffuse: Color, specular: Color) -> f32 {
    let (d, s) = (diffuse.sum_of_lanes(), specular.sum_of_lanes());
    if d + s > 0.0 { s / (d + s) } else { 0.0 }
}

/// [`super::PlasticModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    eta: f32,
    /// ρ / (1 − ρₓ·F̄) / η².
    base: Color,
    leaves: f32,
    between: DiffuseBase,
    specular: Color,
    specular_weight: f32,
}

impl Plastic {
    fn transmitted(&self, cos: f32) -> f32 {
        (1.0 - fresnel::dielectric(cos, self.eta).reflectance) * self.between.passage(cos, self.eta)
    }
}

impl Scatter for Plastic {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::one(Range::DIFFUSE)
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        if wi.z > 0.0 && wo.z > 0.0 && range.diffuse() {
            self.base * (FRAC_1_PI * self.transmitted(wi.z) * self.transmitted(wo.z))
        } else {
            Color::ZERO
        }
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if wi.z > 0.0 && range.diffuse() { cosine_pdf(wo) } else { 0.0 }
    }

    fn draw(&self, _: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        (wi.z > 0.0).then(|| (warp::cosine_hemisphere(u), 1.0))
    }

    /// ∫(1 − F)cosθ/π over the outside, divided by η², equals 1 − F̄ inside.
    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if wi.z > 0.0 && range.diffuse() {
            self.base * (self.transmitted(wi.z) * self.leaves * self.eta * self.eta)
        } else {
            Color::ZERO
        }
    }

    fn deltas(&self, wi: Vec3, _: Transport) -> Deltas {
        let mut lobes = Deltas::default();
        if wi.z > 0.0 {
            let f = fresnel::dielectric(wi.z, self.eta).reflectance;
            let (s, d) = (f * self.specular_weight, (1.0 - f) * (1.0 - self.specular_weight));
            lobes.push(DeltaLobe {
                wo: Vec3::new(-wi.x, -wi.y, wi.z),
                weight: self.specular * f,
                probability: if s + d > 0.0 { s / (s + d) } else { 0.0 },
                eta: 1.0,
                straight: false,
            });
        }
        lobes
    }
}
