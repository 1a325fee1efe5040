use std::f32::consts::FRAC_1_PI;

use super::diffuse::cosine_pdf;
use super::{Bxdf, Lobe, Lobes, Nature, Parameters, Point, Range, Scatter, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Lambertian reflection and transmission, alike on both sides.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmissionModel {
    /// Albedo of the side that light comes from.
    pub reflectance: Param,
    /// Share of light that leaves from the other side.
    pub transmittance: Param,
}

impl Parameters for DiffuseTransmissionModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let (reflectance, transmittance) = (point.color(self.reflectance), point.color(self.transmittance));
        let (r, t) = (reflectance.max_element(), transmittance.max_element());
        let reflects = if r + t > 0.0 { r / (r + t) } else { 0.5 };
        DiffuseTransmission { reflectance, transmittance, reflects }.into()
    }

    fn params(&self) -> Vec<Param> {
        vec![self.reflectance, self.transmittance]
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.reflectance)
    }

    fn nature(&self) -> Nature {
        Nature { smooth: Some(Nature::DIFFUSE), transmits: true, ..Nature::default() }
    }
}

/// [`super::DiffuseTransmissionModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmission {
    reflectance: Color,
    transmittance: Color,
    /// Probability of reflection.
    reflects: f32,
}

impl Scatter for DiffuseTransmission {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::from([
            Lobe { probability: self.reflects, roughness: Range::DIFFUSE },
            Lobe { probability: 1.0 - self.reflects, roughness: Range::DIFFUSE },
        ])
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        match range.diffuse() {
            true if wi.z * wo.z > 0.0 => self.reflectance * FRAC_1_PI,
            true if wi.z * wo.z < 0.0 => self.transmittance * FRAC_1_PI,
            _ => Color::ZERO,
        }
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let choice = if wi.z * wo.z > 0.0 { self.reflects } else { 1.0 - self.reflects };
        if range.diffuse() { choice * cosine_pdf(wo.abs()) } else { 0.0 }
    }

    fn draw(&self, lobe: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let w = warp::cosine_hemisphere(u);
        let side = 1.0f32.copysign(wi.z) * if lobe == 0 { 1.0 } else { -1.0 };
        (w.z > 0.0).then(|| (Vec3::new(w.x, w.y, w.z * side), 1.0))
    }

    fn albedo(&self, _: Vec3, range: Range) -> Color {
        if range.diffuse() { self.reflectance + self.transmittance } else { Color::ZERO }
    }
}
