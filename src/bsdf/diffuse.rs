use std::f32::consts::FRAC_1_PI;

use super::{Bxdf, Lobes, Nature, Parameters, Point, Range, Scatter, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Lambertian reflection from the front side.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseModel {
    /// Albedo.
    pub reflectance: Param,
}

impl Parameters for DiffuseModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        Diffuse { reflectance: point.color(self.reflectance) }.into()
    }

    fn params(&self) -> Vec<Param> {
        vec![self.reflectance]
    }

    fn lambertian(&self) -> Option<Param> {
        Some(self.reflectance)
    }

    fn nature(&self) -> Nature {
        Nature { smooth: Some(Nature::DIFFUSE), ..Nature::default() }
    }
}

/// A closure that is nothing else than this is handled by [`super::Closure`] itself.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Albedo.
    pub reflectance: Color,
}

impl Scatter for Diffuse {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::one(Range::DIFFUSE)
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        if wi.z > 0.0 && wo.z > 0.0 && range.diffuse() { self.reflectance * FRAC_1_PI } else { Color::ZERO }
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if wi.z > 0.0 && range.diffuse() { cosine_pdf(wo) } else { 0.0 }
    }

    fn draw(&self, _: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        (wi.z > 0.0).then(|| (warp::cosine_hemisphere(u), 1.0))
    }

    fn lambertian(&self) -> Option<Color> {
        Some(self.reflectance)
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if wi.z > 0.0 && range.diffuse() { self.reflectance } else { Color::ZERO }
    }
}

/// Density of the cosine-weighted upper hemisphere.
#[inline]
pub(super) fn cosine_pdf(wo: Vec3) -> f32 {
    if wo.z > 0.0 { wo.z * FRAC_1_PI } else { 0.0 }
}
