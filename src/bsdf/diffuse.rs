use std::f32::consts::FRAC_1_PI;

use super::{Deltas, SmoothSample, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::{Param, Textures};

/// Lambertian reflection from the front side.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseModel {
    pub reflectance: Param,
}

impl DiffuseModel {
    pub fn lobe(&self, textures: &Textures, uv: Vec2) -> Diffuse {
        Diffuse { reflectance: textures.eval(self.reflectance, uv) }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    pub reflectance: Rgb,
}

impl Diffuse {
    #[inline]
    pub fn eval(&self, wi: Vec3, wo: Vec3, _: Transport) -> Rgb {
        if wi.z > 0.0 && wo.z > 0.0 { self.reflectance * FRAC_1_PI } else { Rgb::ZERO }
    }

    #[inline]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        if wi.z > 0.0 && wo.z > 0.0 { wo.z * FRAC_1_PI } else { 0.0 }
    }

    #[inline]
    pub fn sample(&self, wi: Vec3, u: Vec2, _: Transport) -> Option<SmoothSample> {
        let wo = warp::cosine_hemisphere(u);
        let pdf = wo.z * FRAC_1_PI;
        (wi.z > 0.0 && pdf > 0.0).then_some(SmoothSample { wo, weight: self.reflectance, pdf })
    }

    pub fn albedo(&self, wi: Vec3) -> Rgb {
        if wi.z > 0.0 { self.reflectance } else { Rgb::ZERO }
    }

    pub fn deltas(&self, _: Vec3, _: Transport) -> Deltas {
        Deltas::default()
    }
}
