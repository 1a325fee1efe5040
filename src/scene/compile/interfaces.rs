//! Interfaces of dielectrics and conductors: indices of refraction, metals, smooth and rough.

use caustica_formats::ir::{self, ColorSlot, ConductorMaterial, Ior};
use caustica_formats::spectrum;

use super::Compiler;
use crate::bsdf::{
    ConductorModel, DielectricModel, DiffuseBase, Metal, Node, PlasticModel, RoughConductorModel,
    RoughDielectricModel, Roughness,
};
use crate::spectrum::rgb;
use crate::texture::Param;

impl Compiler<'_> {
    /// [`Self::roughness`] of an interface of relative index `eta`. Without a step of the index no facet bends
    /// or reflects anything: it is smooth, as in pbrt-v4.
    pub(super) fn interface_roughness(&mut self, m: &ir::Microfacet, eta: f32) -> Option<Roughness> {
        if eta == 1.0 { None } else { self.roughness(m) }
    }

    pub(super) fn rough_dielectric(
        &mut self,
        interface: &ir::Dielectric,
        microfacet: &ir::Microfacet,
        origin: ir::Origin,
    ) -> Node {
        let smooth = self.dielectric(interface, origin);
        match self.interface_roughness(microfacet, smooth.eta) {
            Some(roughness) => {
                let DielectricModel { eta, reflectance, transmittance } = smooth;
                RoughDielectricModel { eta, reflectance, transmittance, roughness }.into()
            }
            None => smooth.into(),
        }
    }

    pub(super) fn rough_conductor(
        &mut self,
        conductor: &ir::Conductor,
        microfacet: &ir::Microfacet,
        origin: ir::Origin,
    ) -> Node {
        let smooth = self.conductor(conductor, origin);
        match self.roughness(microfacet) {
            Some(roughness) => {
                let ConductorModel { metal, reflectance } = smooth;
                RoughConductorModel { metal, reflectance, roughness }.into()
            }
            None => smooth.into(),
        }
    }

    pub(super) fn ior(&mut self, ior: &Ior, origin: ir::Origin) -> f32 {
        match ior {
            Ior::Value(v) if *v > 0.0 => *v as f32,
            Ior::Value(v) => {
                self.error(format!("an index of refraction must be positive, not {v}"), origin);
                1.0
            }
            Ior::Named(name) => spectrum::ior(name).map_or_else(
                || {
                    self.error(format!("no index of refraction is known for `{name}`"), origin);
                    1.0
                },
                |v| v as f32,
            ),
        }
    }

    pub(super) fn dielectric(&mut self, d: &ir::Dielectric, origin: ir::Origin) -> DielectricModel {
        DielectricModel {
            eta: self.ior(&d.int_ior, origin) / self.ior(&d.ext_ior, origin),
            reflectance: self.reflectance(&d.specular_reflectance, origin),
            transmittance: self.reflectance(&d.specular_transmittance, origin),
        }
    }

    pub(super) fn conductor(&mut self, c: &ir::Conductor, origin: ir::Origin) -> ConductorModel {
        let reflectance = self.reflectance(&c.specular_reflectance, origin);
        let outside = |b: &mut Self, ext: &Option<Ior>| ext.as_ref().map_or(1.0, |e| b.ior(e, origin));
        let metal = match &c.material {
            ConductorMaterial::Mirror => Metal::Mirror,
            ConductorMaterial::Named { name, ext_eta } => {
                let outside = outside(self, ext_eta);
                let constant = |c: [f64; 3]| Param::Constant(rgb(c.map(|v| v as f32)));
                match spectrum::conductor(name) {
                    Some(metal) => Metal::Index { eta: constant(metal.eta), k: constant(metal.k), outside },
                    None => {
                        self.error(format!("no metal is known by the name `{name}`"), origin);
                        Metal::Mirror
                    }
                }
            }
            ConductorMaterial::EtaK { eta, k, ext_eta } => Metal::Index {
                eta: self.param(eta, ColorSlot::Unbounded, origin),
                k: self.param(k, ColorSlot::Unbounded, origin),
                outside: outside(self, ext_eta),
            },
            ConductorMaterial::Reflectance(r) => {
                Metal::Reflectance { normal: self.reflectance(r, origin), outside: 1.0 }
            }
        };
        ConductorModel { metal, reflectance }
    }

    pub(super) fn plastic(&mut self, p: &ir::Plastic, origin: ir::Origin) -> PlasticModel {
        PlasticModel {
            eta: self.ior(&p.int_ior, origin) / self.ior(&p.ext_ior, origin),
            diffuse: self.reflectance(&p.diffuse_reflectance, origin),
            specular: self.reflectance(&p.specular_reflectance, origin),
            between: if p.nonlinear { DiffuseBase::Colored } else { DiffuseBase::White },
        }
    }
}
