use super::{DeltaLobe, Deltas, DielectricModel, Transport, fresnel};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Textures;

/// A pane with parallel faces: interreflection inside is summed, transmission goes straight on.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectricModel(pub DielectricModel);

impl ThinDielectricModel {
    pub fn lobe(&self, textures: &Textures, uv: Vec2) -> ThinDielectric {
        let d = self.0.lobe(textures, uv);
        ThinDielectric { eta: d.eta, reflectance: d.reflectance, transmittance: d.transmittance }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    pub eta: f32,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl ThinDielectric {
    pub fn deltas(&self, wi: Vec3, _: Transport) -> Deltas {
        let r = fresnel::dielectric(wi.z.abs(), self.eta).reflectance;
        // R + T R T + T R R R T + … = 2R / (1 + R).
        let r = if r < 1.0 { 2.0 * r / (1.0 + r) } else { 1.0 };
        let mut lobes = Deltas::default();
        lobes.push(DeltaLobe {
            wo: Vec3::new(-wi.x, -wi.y, wi.z),
            weight: self.reflectance * r,
            probability: r,
            eta: 1.0,
        });
        lobes.push(DeltaLobe {
            wo: -wi,
            weight: self.transmittance * (1.0 - r),
            probability: 1.0 - r,
            eta: 1.0,
        });
        lobes
    }
}
