use std::f32::consts::{FRAC_1_PI, PI};

use super::diffuse::cosine_pdf;
use super::plastic::specular_weight;
use super::{Bxdf, Lobe, Lobes, Nature, Parameters, Point, Range, Scatter, Transport};
use crate::math::{Color, Frame, Vec2, Vec3};
use crate::sampling::warp;
use crate::spectrum::scalar;
use crate::texture::Param;

/// Modified Phong model (Lafortune and Willems 1994): a cosine power about the mirror direction.
#[derive(Clone, Copy, Debug)]
pub struct PhongModel {
    /// Reflectance of the diffuse part.
    pub diffuse: Param,
    /// Factor of the specular reflection; 1 is physical.
    pub specular: Param,
    /// Exponent of the cosine; 0 is the widest lobe.
    pub exponent: Param,
}

impl Parameters for PhongModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let [diffuse, specular] = conserving(point.color(self.diffuse), point.color(self.specular));
        let specular_weight = specular_weight(diffuse, specular);
        Phong { diffuse, specular, specular_weight, exponent: point.scalar(self.exponent).max(0.0) }.into()
    }

    fn params(&self) -> Vec<Param> {
        vec![self.diffuse, self.specular, self.exponent]
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.diffuse)
    }

    fn nature(&self) -> Nature {
        let least = self.exponent.constant().map_or(0.0, |n| roughness(scalar(n).max(0.0)));
        Nature { smooth: Some([least, Range::DIFFUSE]), ..Nature::default() }
    }
}

/// Both scaled down where they would reflect more than there is.
pub(super) fn conserving(diffuse: Color, specular: Color) -> [Color; 2] {
    let most = (diffuse + specular).max_element().max(1.0);
    [diffuse / most, specular / most]
}

/// α of the microfacet lobe that is as wide.
fn roughness(exponent: f32) -> f32 {
    (2.0 / (exponent + 2.0)).sqrt()
}

/// [`super::PhongModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    diffuse: Color,
    specular: Color,
    specular_weight: f32,
    exponent: f32,
}

fn mirror(w: Vec3) -> Vec3 {
    Vec3::new(-w.x, -w.y, w.z)
}

impl Phong {
    fn power(&self, wi: Vec3, wo: Vec3) -> f32 {
        let cos = mirror(wi).dot(wo);
        if cos > 0.0 { cos.powf(self.exponent) } else { 0.0 }
    }
}

impl Scatter for Phong {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::from([
            Lobe { probability: self.specular_weight, roughness: roughness(self.exponent) },
            Lobe { probability: 1.0 - self.specular_weight, roughness: Range::DIFFUSE },
        ])
    }

    fn eval(&self, wi: Vec3, wo: Vec3, _: Transport, range: Range) -> Color {
        let mut f = Color::ZERO;
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return f;
        }
        if range.contains(roughness(self.exponent)) {
            f += self.specular * (self.power(wi, wo) * (self.exponent + 2.0) / (2.0 * PI));
        }
        if range.diffuse() {
            f += self.diffuse * FRAC_1_PI;
        }
        f
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let mut pdf = 0.0;
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return pdf;
        }
        if range.contains(roughness(self.exponent)) {
            pdf += self.specular_weight * self.power(wi, wo) * (self.exponent + 1.0) / (2.0 * PI);
        }
        if range.diffuse() {
            pdf += (1.0 - self.specular_weight) * cosine_pdf(wo);
        }
        pdf
    }

    fn draw(&self, lobe: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        if wi.z <= 0.0 {
            return None;
        }
        let wo = if lobe == 0 {
            let z = u.x.powf(1.0 / (self.exponent + 1.0));
            let (r, (sin, cos)) = ((1.0 - z * z).max(0.0).sqrt(), (2.0 * PI * u.y).sin_cos());
            Frame::from_normal(mirror(wi)).to_world(Vec3::new(r * cos, r * sin, z))
        } else {
            warp::cosine_hemisphere(u)
        };
        (wo.z > 0.0).then_some((wo, 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let mut albedo = Color::ZERO;
        if wi.z > 0.0 && range.contains(roughness(self.exponent)) {
            albedo += self.specular;
        }
        if wi.z > 0.0 && range.diffuse() {
            albedo += self.diffuse;
        }
        albedo
    }
}
