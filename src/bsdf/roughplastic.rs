use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;

use super::diffuse::cosine_pdf;
use super::microfacet::{Microfacet, reflect};
use super::plastic::specular_weight;
use super::roughconductor::{reflected, reflected_pdf};
use super::{
    Bxdf, DiffuseBase, Lobe, Lobes, Nature, Parameters, Point, Range, Roughness, Scatter, Transmittance,
    Transport, fresnel,
};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Diffuse base under a rough dielectric coat (front side only).
#[derive(Clone, Debug)]
pub struct RoughPlasticModel {
    /// Index of the coat over the index outside.
    pub eta: f32,
    /// Reflectance of the diffuse part.
    pub diffuse: Param,
    /// Factor of the specular reflection; 1 is physical.
    pub specular: Param,
    /// What becomes of light between coat and base.
    pub between: DiffuseBase,
    /// Microfacets of the surface.
    pub roughness: Roughness,
    /// For this `eta`.
    pub transmittance: Arc<Transmittance>,
}

impl Parameters for RoughPlasticModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let (diffuse, specular) = (point.color(self.diffuse), point.color(self.specular));
        let microfacet = self.roughness.at(point);
        let internal = self.transmittance.internal(microfacet.roughness());
        RoughPlastic {
            eta: self.eta,
            base: self.between.base(diffuse, internal) / (self.eta * self.eta),
            leaves: self.between.leaves(internal),
            between: self.between,
            specular,
            specular_weight: specular_weight(diffuse, specular),
            microfacet,
            transmittance: self.transmittance.clone(),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        [self.roughness.params(), vec![self.diffuse, self.specular]].concat()
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.diffuse)
    }

    fn nature(&self) -> Nature {
        let [min, _] = self.roughness.bounds();
        Nature {
            smooth: Some([min, Range::DIFFUSE]),
            oriented: self.roughness.oriented(),
            ..Nature::default()
        }
    }
}

/// [`super::RoughPlasticModel`] at a point.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    eta: f32,
    base: Color,
    leaves: f32,
    between: DiffuseBase,
    specular: Color,
    specular_weight: f32,
    microfacet: Microfacet,
    transmittance: Arc<Transmittance>,
}

impl RoughPlastic {
    fn transmitted(&self, cos: f32) -> f32 {
        self.transmittance.external(self.microfacet.roughness(), cos)
    }

    /// From outside to the base, or back.
    fn reaches(&self, cos: f32) -> f32 {
        self.transmitted(cos) * self.between.passage(cos, self.eta)
    }

    /// Probability of choosing the coat.
    fn specular_probability(&self, wi: Vec3) -> f32 {
        let t = self.transmitted(wi.z);
        let (s, d) = ((1.0 - t) * self.specular_weight, t * (1.0 - self.specular_weight));
        if s + d > 0.0 { s / (s + d) } else { 0.0 }
    }
}

impl Scatter for RoughPlastic {
    fn lobes(&self, wi: Vec3) -> Lobes {
        let s = self.specular_probability(wi);
        Lobes::from([
            Lobe { probability: s, roughness: self.microfacet.roughness() },
            Lobe { probability: 1.0 - s, roughness: Range::DIFFUSE },
        ])
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        let mut f = Color::ZERO;
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return f;
        }
        if range.contains(self.microfacet.roughness()) {
            let m = (wi + wo).normalize();
            let dg = self.microfacet.d(m) * self.microfacet.g(wi, wo, m);
            let reflected = fresnel::dielectric(wi.dot(m), self.eta).reflectance;
            f += self.specular * (reflected * dg / (4.0 * wi.z * wo.z));
        }
        if range.diffuse() {
            f += self.base * (FRAC_1_PI * self.reaches(wi.z) * self.reaches(wo.z));
        }
        f
    }

    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> (Color, f32) {
        let (mut f, mut pdf) = (Color::ZERO, 0.0);
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return (f, pdf);
        }
        let s = self.specular_probability(wi);
        if range.contains(self.microfacet.roughness()) {
            let (m, dg, density) = reflected(&self.microfacet, wi, wo);
            let fresnel = fresnel::dielectric(wi.dot(m), self.eta).reflectance;
            f += self.specular * (fresnel * dg / (4.0 * wi.z * wo.z));
            pdf += s * density;
        }
        if range.diffuse() {
            f += self.base * (FRAC_1_PI * self.reaches(wi.z) * self.reaches(wo.z));
            pdf += (1.0 - s) * cosine_pdf(wo);
        }
        (f, pdf)
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return 0.0;
        }
        let s = self.specular_probability(wi);
        let mut pdf = 0.0;
        if range.contains(self.microfacet.roughness()) {
            pdf += s * reflected_pdf(&self.microfacet, wi, wo);
        }
        if range.diffuse() {
            pdf += (1.0 - s) * cosine_pdf(wo);
        }
        pdf
    }

    fn draw(&self, lobe: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        if wi.z <= 0.0 {
            return None;
        }
        let wo = match lobe {
            0 => reflect(wi, self.microfacet.sample(wi, u)),
            _ => warp::cosine_hemisphere(u),
        };
        (wo.z > 0.0).then_some((wo, 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let mut albedo = Color::ZERO;
        if wi.z <= 0.0 {
            return albedo;
        }
        let t = self.transmitted(wi.z);
        if range.contains(self.microfacet.roughness()) {
            albedo += self.specular * (1.0 - t);
        }
        if range.diffuse() {
            albedo += self.base * (self.reaches(wi.z) * self.leaves * self.eta * self.eta);
        }
        albedo
    }
}
