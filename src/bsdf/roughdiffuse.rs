use std::f32::consts::{FRAC_1_PI, FRAC_1_SQRT_2, PI};

use super::diffuse::cosine_pdf;
use super::{Bxdf, Lobes, Nature, Parameters, Point, Range, Scatter, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Oren and Nayar 1994: V-shaped grooves of diffuse walls, slopes of standard deviation σ = α/√2.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuseModel {
    /// Albedo of the walls of the grooves.
    pub reflectance: Param,
    /// √2 times the standard deviation of the grooves' slope.
    pub alpha: Param,
    /// Without interreflection in the grooves (the paper's qualitative model).
    pub fast: bool,
}

impl Parameters for RoughDiffuseModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let sigma = point.scalar(self.alpha).max(0.0) * FRAC_1_SQRT_2;
        RoughDiffuse { reflectance: point.color(self.reflectance), sigma2: sigma * sigma, fast: self.fast }
            .into()
    }

    fn params(&self) -> Vec<Param> {
        vec![self.reflectance, self.alpha]
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.reflectance)
    }

    fn nature(&self) -> Nature {
        Nature { smooth: Some(Nature::DIFFUSE), ..Nature::default() }
    }
}

/// [`super::RoughDiffuseModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct RoughDiffuse {
    reflectance: Color,
    sigma2: f32,
    fast: bool,
}

impl RoughDiffuse {
    fn f(&self, wi: Vec3, wo: Vec3) -> Color {
        let sin = |w: Vec3| (1.0 - w.z * w.z).max(0.0).sqrt();
        let (sin_i, sin_o) = (sin(wi), sin(wo));
        let cos_phi = if sin_i > 1e-4 && sin_o > 1e-4 {
            ((wi.x * wo.x + wi.y * wo.y) / (sin_i * sin_o)).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        let s2 = self.sigma2;
        let (alpha, beta) = (wi.z.min(wo.z).acos(), wi.z.max(wo.z).acos());
        let (sin_alpha, tan_beta) = (alpha.sin(), beta.tan());
        if self.fast {
            let (a, b) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
            return self.reflectance * (FRAC_1_PI * (a + b * cos_phi.max(0.0) * sin_alpha * tan_beta));
        }
        // Equations 27 to 30 of the paper.
        let steep = 4.0 * alpha * beta / (PI * PI);
        let c1 = 1.0 - 0.5 * s2 / (s2 + 0.33);
        let shape = if cos_phi >= 0.0 { sin_alpha } else { sin_alpha - (2.0 * beta / PI).powi(3) };
        let c2 = 0.45 * s2 / (s2 + 0.09) * shape;
        let c3 = 0.125 * s2 / (s2 + 0.09) * steep * steep;
        let tan_mean = (0.5 * (alpha + beta)).tan();
        let direct = c1 + c2 * cos_phi * tan_beta + (1.0 - cos_phi.abs()) * c3 * tan_mean;
        let groove = 2.0 * beta / PI;
        let again = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_phi * groove * groove);
        (self.reflectance * direct + self.reflectance * self.reflectance * again) * FRAC_1_PI
    }
}

impl Scatter for RoughDiffuse {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::one(Range::DIFFUSE)
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        if wi.z > 0.0 && wo.z > 0.0 && range.diffuse() { self.f(wi, wo) } else { Color::ZERO }
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if wi.z > 0.0 && range.diffuse() { cosine_pdf(wo) } else { 0.0 }
    }

    fn draw(&self, _: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        (wi.z > 0.0).then(|| (warp::cosine_hemisphere(u), 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if wi.z > 0.0 && range.diffuse() { self.reflectance } else { Color::ZERO }
    }
}
