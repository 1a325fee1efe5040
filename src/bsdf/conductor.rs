use super::metal::MetalAt;
use super::{Bxdf, DeltaLobe, Deltas, Metal, Nature, Parameters, Point, Scatter, Transport};
use crate::math::{Color, Vec3};
use crate::texture::Param;

/// Smooth metal or perfect mirror, reflecting from the front side.
#[derive(Clone, Copy, Debug)]
pub struct ConductorModel {
    /// What the surface is made of: Fresnel's reflectance.
    pub metal: Metal,
    /// Share of the reflected light that is kept, by colour; 1 is physical.
    pub reflectance: Param,
}

impl Parameters for ConductorModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        Conductor { metal: self.metal.at(point), reflectance: point.color(self.reflectance) }.into()
    }

    fn params(&self) -> Vec<Param> {
        [self.metal.params(), vec![self.reflectance]].concat()
    }

    fn nature(&self) -> Nature {
        Nature { delta: true, ..Nature::default() }
    }
}

/// [`super::ConductorModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    metal: MetalAt,
    reflectance: Color,
}

impl Scatter for Conductor {
    fn deltas(&self, wi: Vec3, _: Transport) -> Deltas {
        let mut lobes = Deltas::default();
        if wi.z > 0.0 {
            lobes.push(DeltaLobe {
                wo: Vec3::new(-wi.x, -wi.y, wi.z),
                weight: self.reflectance * self.metal.fresnel(wi.z),
                probability: 1.0,
                eta: 1.0,
                straight: false,
            });
        }
        lobes
    }
}
