use super::{Bxdf, DeltaLobe, Deltas, Nature, Parameters, Point, Scatter, Transport, fresnel};
use crate::math::{Color, Vec3};
use crate::texture::Param;

/// Smooth boundary between two dielectrics; `eta` = index behind the normal over index before it.
#[derive(Clone, Copy, Debug)]
pub struct DielectricModel {
    /// Index of refraction behind the normal over that before it.
    pub eta: f32,
    /// Share of the reflected light that is kept, by colour; 1 is physical.
    pub reflectance: Param,
    /// Share of the transmitted light that is kept, by colour; 1 is physical.
    pub transmittance: Param,
}

impl DielectricModel {
    pub(super) fn interface(&self, point: &Point<'_>) -> Dielectric {
        Dielectric {
            eta: self.eta,
            reflectance: point.color(self.reflectance),
            transmittance: point.color(self.transmittance),
        }
    }
}

impl Parameters for DielectricModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        self.interface(point).into()
    }

    fn params(&self) -> Vec<Param> {
        vec![self.reflectance, self.transmittance]
    }

    fn nature(&self) -> Nature {
        Nature { delta: true, transmits: true, ..Nature::default() }
    }
}

/// [`super::DielectricModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    /// Index of refraction behind the normal over that before it.
    pub eta: f32,
    /// Factor of the reflection.
    pub reflectance: Color,
    /// Factor of the refraction.
    pub transmittance: Color,
}

impl Scatter for Dielectric {
    /// Reflection and refraction. Radiance entering the denser side is compressed into a smaller cone:
    /// its transmitted part carries 1/eta², photons do not (Veach 1997, §5.2).
    fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        let f = fresnel::dielectric(wi.z, self.eta);
        let mut lobes = Deltas::default();
        lobes.push(DeltaLobe {
            wo: Vec3::new(-wi.x, -wi.y, wi.z),
            weight: self.reflectance * f.reflectance,
            probability: f.reflectance,
            eta: 1.0,
            straight: false,
        });
        let scale = match mode {
            Transport::Radiance => 1.0 / (f.eta * f.eta),
            Transport::Importance => 1.0,
        };
        lobes.push(DeltaLobe {
            wo: Vec3::new(-wi.x / f.eta, -wi.y / f.eta, f.cos_t),
            weight: self.transmittance * ((1.0 - f.reflectance) * scale),
            probability: 1.0 - f.reflectance,
            eta: f.eta,
            straight: false,
        });
        lobes
    }
}
