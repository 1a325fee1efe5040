use std::f32::consts::PI;

use super::diffuse::cosine_pdf;
use super::lobesum::{LEAST_ALPHA, facets};
use super::microfacet::{Microfacet, reflect};
use super::principled::schlick;
use super::roughconductor::reflected_pdf;
use super::{Bxdf, Lobe, Lobes, Nature, Parameters, Point, Range, Roughness, Scatter, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Gloss over a diffuse base that gets what the gloss leaves (Ashikhmin and Shirley 2000), with pbrt-v3's distributions
/// of facets (front side only).
#[derive(Clone, Copy, Debug)]
pub struct FresnelBlendModel {
    /// Reflectance of the base.
    pub diffuse: Param,
    /// Reflectance of the gloss at normal incidence.
    pub specular: Param,
    /// Microfacets of the gloss; they do not mask each other.
    pub roughness: Roughness,
}

impl Parameters for FresnelBlendModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let [diffuse, specular] = [self.diffuse, self.specular].map(|p| point.color(p).max(Color::ZERO));
        let left = (Color::ONE - specular).max(Color::ZERO);
        // As in pbrt-v3, a black surface is black at grazing angles too.
        let black = diffuse == Color::ZERO && specular == Color::ZERO;
        FresnelBlend {
            below: diffuse * left,
            specular,
            grazing: if black { Color::ZERO } else { left },
            microfacet: facets(&self.roughness, point),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        [self.roughness.params(), vec![self.diffuse, self.specular]].concat()
    }

    fn nature(&self) -> Nature {
        let [least, _] = self.roughness.bounds();
        Nature {
            smooth: Some([least.max(LEAST_ALPHA), Range::DIFFUSE]),
            oriented: self.roughness.oriented(),
            ..Nature::default()
        }
    }
}

/// [`super::FresnelBlendModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct FresnelBlend {
    /// Reflectance of the base times what the gloss leaves at normal incidence.
    below: Color,
    specular: Color,
    /// What grazing angles add to it.
    grazing: Color,
    microfacet: Microfacet,
}

/// Share of light along a direction that reaches the base and leaves it; its mean by cosine is 23/28.
fn reaches(cos: f32) -> f32 {
    1.0 - (1.0 - 0.5 * cos).powi(5)
}

const GLOSS: usize = 0;
const BASE: usize = 1;

impl FresnelBlend {
    fn reflected(&self, cos: f32) -> Color {
        self.specular + self.grazing * schlick(cos)
    }

    fn gloss(&self, wi: Vec3, wo: Vec3) -> Color {
        let h = wi + wo;
        // Of the half vector with both directions.
        let cos = 0.5 * h.length();
        let f = self.microfacet.d(h.normalize_or(Vec3::Z)) / (4.0 * cos * wi.z.max(wo.z));
        self.reflected(cos) * f
    }
}

impl Scatter for FresnelBlend {
    fn lobes(&self, wi: Vec3) -> Lobes {
        if wi.z <= 0.0 {
            return Lobes::default();
        }
        // Tilted facets are met at grazing angles whatever the angle with the surface.
        let gloss = self.reflected(wi.z).max_element().max(0.05);
        let probability = gloss / (gloss + (self.below * reaches(wi.z)).max_element());
        Lobes::from([
            Lobe { probability, roughness: self.microfacet.roughness() },
            Lobe { probability: 1.0 - probability, roughness: Range::DIFFUSE },
        ])
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        let mut f = Color::ZERO;
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return f;
        }
        if range.contains(self.microfacet.roughness()) {
            f += self.gloss(wi, wo);
        }
        if range.diffuse() {
            f += self.below * (28.0 / (23.0 * PI) * reaches(wi.z) * reaches(wo.z));
        }
        f
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let mut pdf = 0.0;
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return pdf;
        }
        let lobes = self.lobes(wi);
        if range.contains(self.microfacet.roughness()) {
            pdf += lobes[GLOSS].probability * reflected_pdf(&self.microfacet, wi, wo);
        }
        if range.diffuse() {
            pdf += lobes[BASE].probability * cosine_pdf(wo);
        }
        pdf
    }

    fn draw(&self, lobe: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let wo = match lobe {
            GLOSS => reflect(wi, self.microfacet.sample(wi, u)),
            _ => warp::cosine_hemisphere(u),
        };
        (wo.z > 0.0).then_some((wo, 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let mut albedo = Color::ZERO;
        if wi.z <= 0.0 {
            return albedo;
        }
        if range.contains(self.microfacet.roughness()) {
            albedo += self.reflected(wi.z);
        }
        if range.diffuse() {
            albedo += self.below * reaches(wi.z);
        }
        albedo
    }
}
