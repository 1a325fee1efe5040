use std::f32::consts::FRAC_1_PI;

use super::{Nature, Parameters, PartList, Point, Range, Scatter, Transport, one_part};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Lambertian reflection from the front side.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseModel {
    pub reflectance: Param,
}

impl Parameters for DiffuseModel {
    type At = Diffuse;

    fn at(&self, point: &Point<'_>) -> Diffuse {
        Diffuse { reflectance: point.color(self.reflectance) }
    }

    fn params(&self) -> Vec<Param> {
        vec![self.reflectance]
    }

    fn nature(&self) -> Nature {
        Nature { smooth: Some(Nature::DIFFUSE), ..Nature::default() }
    }
}

/// A closure that is nothing else than this is handled by [`super::Closure`] itself.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    pub reflectance: Color,
}

impl Scatter for Diffuse {
    fn parts(&self, _: Vec3) -> PartList {
        one_part(Range::DIFFUSE)
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

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if wi.z > 0.0 && range.diffuse() { self.reflectance } else { Color::ZERO }
    }
}

/// Density of the cosine-weighted upper hemisphere.
#[inline]
pub(super) fn cosine_pdf(wo: Vec3) -> f32 {
    if wo.z > 0.0 { wo.z * FRAC_1_PI } else { 0.0 }
}
