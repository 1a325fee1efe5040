use super::dielectric::Dielectric;
use super::{
    Bxdf, DeltaLobe, Deltas, DielectricModel, Nature, Parameters, Point, Scatter, Transport, fresnel,
};
use crate::math::Vec3;
use crate::texture::Param;

/// A pane with parallel faces: interreflection inside is summed, transmission goes straight on.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectricModel(pub DielectricModel);

impl Parameters for ThinDielectricModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        ThinDielectric(self.0.interface(point)).into()
    }

    fn params(&self) -> Vec<Param> {
        self.0.params()
    }

    fn nature(&self) -> Nature {
        self.0.nature()
    }
}

/// [`super::ThinDielectricModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric(Dielectric);

impl Scatter for ThinDielectric {
    fn deltas(&self, wi: Vec3, _: Transport) -> Deltas {
        let r = fresnel::dielectric(wi.z.abs(), self.0.eta).reflectance;
        // R + T R T + T R R R T + … = 2R / (1 + R).
        let r = if r < 1.0 { 2.0 * r / (1.0 + r) } else { 1.0 };
        let mut lobes = Deltas::default();
        lobes.push(DeltaLobe {
            wo: Vec3::new(-wi.x, -wi.y, wi.z),
            weight: self.0.reflectance * r,
            probability: r,
            eta: 1.0,
            straight: false,
        });
        lobes.push(DeltaLobe {
            wo: -wi,
            weight: self.0.transmittance * (1.0 - r),
            probability: 1.0 - r,
            eta: 1.0,
            straight: true,
        });
        lobes
    }
}
