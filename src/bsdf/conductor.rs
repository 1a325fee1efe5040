use super::{DeltaLobe, Deltas, Transport, fresnel};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::{Param, Textures};

/// Smooth metal or perfect mirror, reflecting from the front side.
#[derive(Clone, Copy, Debug)]
pub struct ConductorModel {
    /// Complex index relative to the outside; `None` is a perfect mirror.
    pub index: Option<(Rgb, Rgb)>,
    pub reflectance: Param,
}

impl ConductorModel {
    pub fn lobe(&self, textures: &Textures, uv: Vec2) -> Conductor {
        Conductor { index: self.index, reflectance: textures.eval(self.reflectance, uv) }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    pub index: Option<(Rgb, Rgb)>,
    pub reflectance: Rgb,
}

impl Conductor {
    pub fn deltas(&self, wi: Vec3, _: Transport) -> Deltas {
        let mut lobes = Deltas::default();
        if wi.z > 0.0 {
            let fresnel = self.index.map_or(Rgb::ONE, |(eta, k)| fresnel::conductor(wi.z, eta, k));
            lobes.push(DeltaLobe {
                wo: Vec3::new(-wi.x, -wi.y, wi.z),
                weight: self.reflectance * fresnel,
                probability: 1.0,
                eta: 1.0,
            });
        }
        lobes
    }
}
