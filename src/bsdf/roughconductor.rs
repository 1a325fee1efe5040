use super::metal::MetalAt;
use super::microfacet::{Microfacet, reflect};
use super::{Bxdf, Lobes, Metal, Nature, Parameters, Point, Range, Roughness, Scatter, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::texture::Param;

/// Metal with a rough surface, reflecting from the front side (Walter et al. 2007).
#[derive(Clone, Copy, Debug)]
pub struct RoughConductorModel {
    /// What the surface is made of: Fresnel's reflectance.
    pub metal: Metal,
    /// Share of the reflected light that is kept, by colour; 1 is physical.
    pub reflectance: Param,
    /// Microfacets of the surface.
    pub roughness: Roughness,
}

impl Parameters for RoughConductorModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        RoughConductor {
            metal: self.metal.at(point),
            reflectance: point.color(self.reflectance),
            microfacet: self.roughness.at(point),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        [self.metal.params(), self.roughness.params(), vec![self.reflectance]].concat()
    }

    fn nature(&self) -> Nature {
        Nature {
            smooth: Some(self.roughness.bounds()),
            oriented: self.roughness.oriented(),
            ..Nature::default()
        }
    }
}

/// [`super::RoughConductorModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor {
    metal: MetalAt,
    reflectance: Color,
    microfacet: Microfacet,
}

impl Scatter for RoughConductor {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::one(self.microfacet.roughness())
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        if wi.z <= 0.0 || wo.z <= 0.0 || !range.contains(self.microfacet.roughness()) {
            return Color::ZERO;
        }
        let m = (wi + wo).normalize();
        let dg = self.microfacet.d(m) * self.microfacet.g(wi, wo, m);
        if dg == 0.0 {
            return Color::ZERO;
        }
        self.reflectance * self.metal.fresnel(wi.dot(m)) * (dg / (4.0 * wi.z * wo.z))
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if wi.z <= 0.0 || wo.z <= 0.0 || !range.contains(self.microfacet.roughness()) {
            return 0.0;
        }
        reflected_pdf(&self.microfacet, wi, wo)
    }

    fn eval_pdf(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> (Color, f32) {
        if wi.z <= 0.0 || wo.z <= 0.0 || !range.contains(self.microfacet.roughness()) {
            return (Color::ZERO, 0.0);
        }
        let (m, dg, pdf) = reflected(&self.microfacet, wi, wo);
        let f = if dg == 0.0 {
            Color::ZERO
        } else {
            self.reflectance * self.metal.fresnel(wi.dot(m)) * (dg / (4.0 * wi.z * wo.z))
        };
        (f, pdf)
    }

    fn draw(&self, _: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        if wi.z <= 0.0 {
            return None;
        }
        let wo = reflect(wi, self.microfacet.sample(wi, u));
        (wo.z > 0.0).then_some((wo, 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if wi.z <= 0.0 || !range.contains(self.microfacet.roughness()) {
            return Color::ZERO;
        }
        self.reflectance * self.metal.fresnel(wi.z)
    }
}

/// The normal between two directions above the surface, D·G there, and [`reflected_pdf`].
pub(super) fn reflected(microfacet: &Microfacet, wi: Vec3, wo: Vec3) -> (Vec3, f32, f32) {
    let (m, cos) = between(wi, wo);
    let (dg, pdf) = microfacet.dg_pdf(wi, wo, m, cos);
    (m, dg, pdf / (4.0 * cos))
}

/// Density of reflection about a sampled normal; both directions above the surface.
pub(super) fn reflected_pdf(microfacet: &Microfacet, wi: Vec3, wo: Vec3) -> f32 {
    let (m, cos) = between(wi, wo);
    microfacet.pdf(wi, m, cos) / (4.0 * cos)
}

/// The normal between two directions, and its cosine to them.
fn between(wi: Vec3, wo: Vec3) -> (Vec3, f32) {
    let h = wi + wo;
    // wi·m = wo·m = |wi + wo|/2. Towards grazing the sum is all rounding: dot products with it would
    // differ, and f·cos/pdf with them, which is to be Fresnel's factor times masking and no more.
    (h.normalize_or(Vec3::Z), (0.5 * h.length()).max(f32::MIN_POSITIVE))
}
