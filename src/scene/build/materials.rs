//! BSDFs of the IR → materials.

use std::collections::HashMap;

use caustica_formats::ir::{self, BsdfKind, ColorSlot, ConductorMaterial, Ior};
use caustica_formats::spectrum;

use super::Builder;
use super::textures::DEFAULT_REFLECTANCE;
use crate::bsdf::{
    ConductorModel, DielectricModel, DiffuseModel, Material, Model, PlasticModel, ThinDielectricModel,
};
use crate::math::Rgb;
use crate::texture::Param;

#[derive(Default)]
pub struct MaterialTable {
    materials: Vec<Material>,
    known: HashMap<usize, u32>,
    default: Option<u32>,
    black: Option<u32>,
}

impl MaterialTable {
    pub fn finish(self) -> Vec<Material> {
        self.materials
    }

    fn push(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }
}

/// A material before it is frozen.
#[derive(Clone, Copy)]
struct Parts {
    front: Model,
    back: Option<Model>,
    opacity: Option<Param>,
}

impl From<Model> for Parts {
    fn from(front: Model) -> Self {
        Self { front, back: None, opacity: None }
    }
}

fn diffuse(reflectance: Param) -> Model {
    Model::Diffuse(DiffuseModel { reflectance })
}

impl Builder<'_> {
    /// Material of a shape: its BSDF, or the format's default (black under an area light).
    pub(super) fn material(&mut self, bsdf: Option<ir::Id<ir::Bsdf>>, emits: bool) -> u32 {
        let Some(id) = bsdf else {
            let (slot, color) = if emits {
                (&mut self.materials.black, Rgb::ZERO)
            } else {
                (&mut self.materials.default, DEFAULT_REFLECTANCE)
            };
            if let Some(index) = *slot {
                return index;
            }
            let index = self.materials.materials.len() as u32;
            *slot = Some(index);
            self.materials.materials.push(Material::new(diffuse(Param::Constant(color)), None, None));
            return index;
        };
        if let Some(index) = self.materials.known.get(&id.index()) {
            return *index;
        }
        let parts = self.parts(id);
        let index = self.materials.push(Material::new(parts.front, parts.back, parts.opacity));
        self.materials.known.insert(id.index(), index);
        index
    }

    fn parts(&mut self, id: ir::Id<ir::Bsdf>) -> Parts {
        let bsdf = &self.ir.bsdfs[id];
        let origin = bsdf.origin;
        match &bsdf.kind {
            BsdfKind::Diffuse { reflectance } => {
                diffuse(self.param(reflectance, ColorSlot::Reflectance, origin)).into()
            }
            BsdfKind::Dielectric(d) => Model::Dielectric(self.dielectric(d, origin)).into(),
            BsdfKind::ThinDielectric(d) => {
                Model::ThinDielectric(ThinDielectricModel(self.dielectric(d, origin))).into()
            }
            BsdfKind::RoughDielectric { interface, .. } => {
                self.unsupported("bsdf `roughdielectric`", "a smooth `dielectric`", origin);
                Model::Dielectric(self.dielectric(interface, origin)).into()
            }
            BsdfKind::Conductor(c) => Model::Conductor(self.conductor(c, origin)).into(),
            BsdfKind::RoughConductor { conductor, .. } => {
                self.unsupported("bsdf `roughconductor`", "a smooth `conductor`", origin);
                Model::Conductor(self.conductor(conductor, origin)).into()
            }
            BsdfKind::Plastic(p) => Model::Plastic(self.plastic(p, origin)).into(),
            BsdfKind::RoughPlastic { plastic, .. } => {
                self.unsupported("bsdf `roughplastic`", "a smooth `plastic`", origin);
                Model::Plastic(self.plastic(plastic, origin)).into()
            }
            BsdfKind::TwoSided { front, back } => self.two_sided(*front, *back, origin),
            BsdfKind::Mask { opacity, nested } => {
                let mut parts = self.parts(*nested);
                let opacity = self.scalar_param(opacity);
                parts.opacity = match (parts.opacity, opacity) {
                    (None, o) => Some(o),
                    (Some(Param::Constant(a)), Param::Constant(b)) => Some(Param::Constant(a * b)),
                    _ => {
                        self.error("a textured mask inside another mask cannot be rendered", origin);
                        None
                    }
                };
                // A mask of constant opacity 1 is no mask: the plan need not look through it.
                if parts.opacity == Some(Param::Constant(Rgb::ONE)) {
                    parts.opacity = None;
                }
                parts
            }
            BsdfKind::Null => Model::Null.into(),
            _ => {
                self.unsupported("this bsdf", "diffuse gray 0.5", origin);
                diffuse(Param::Constant(DEFAULT_REFLECTANCE)).into()
            }
        }
    }

    fn two_sided(
        &mut self,
        front: ir::Id<ir::Bsdf>,
        back: Option<ir::Id<ir::Bsdf>>,
        origin: ir::Origin,
    ) -> Parts {
        let f = self.parts(front);
        let b = back.map_or(f, |b| self.parts(b));
        if f.front.transmits() || b.front.transmits() {
            self.error("only materials that let no light through can be made two-sided", origin);
        }
        Parts { front: f.front, back: Some(b.front), opacity: f.opacity }
    }

    fn ior(&mut self, ior: &Ior, origin: ir::Origin) -> f32 {
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

    fn dielectric(&mut self, d: &ir::Dielectric, origin: ir::Origin) -> DielectricModel {
        DielectricModel {
            eta: self.ior(&d.int_ior, origin) / self.ior(&d.ext_ior, origin),
            reflectance: self.param(&d.specular_reflectance, ColorSlot::Reflectance, origin),
            transmittance: self.param(&d.specular_transmittance, ColorSlot::Reflectance, origin),
        }
    }

    fn conductor(&mut self, c: &ir::Conductor, origin: ir::Origin) -> ConductorModel {
        let reflectance = self.param(&c.specular_reflectance, ColorSlot::Reflectance, origin);
        let outside = |b: &mut Self, ext: &Option<Ior>| ext.as_ref().map_or(1.0, |e| b.ior(e, origin));
        let index = match &c.material {
            ConductorMaterial::Mirror => None,
            ConductorMaterial::Named { name, ext_eta } => {
                let ext = outside(self, ext_eta);
                let rgb = |c: [f64; 3]| Rgb::new(c[0] as f32, c[1] as f32, c[2] as f32) / ext;
                match spectrum::conductor(name) {
                    Some(metal) => Some((rgb(metal.eta), rgb(metal.k))),
                    None => {
                        self.error(format!("no metal is known by the name `{name}`"), origin);
                        None
                    }
                }
            }
            ConductorMaterial::EtaK { eta, k, ext_eta } => {
                let ext = outside(self, ext_eta);
                let constant = |b: &mut Self, input| match b.param(input, ColorSlot::Unbounded, origin) {
                    Param::Constant(c) => c,
                    Param::Texture(_) => {
                        b.unsupported("a textured index of refraction", "1", origin);
                        Rgb::ONE
                    }
                };
                let (eta, k) = (constant(self, eta), constant(self, k));
                Some((eta / ext, k / ext))
            }
            ConductorMaterial::Reflectance(_) => {
                self.unsupported("a conductor given by its reflectance", "a perfect mirror", origin);
                None
            }
        };
        ConductorModel { index, reflectance }
    }

    fn plastic(&mut self, p: &ir::Plastic, origin: ir::Origin) -> PlasticModel {
        PlasticModel {
            eta: self.ior(&p.int_ior, origin) / self.ior(&p.ext_ior, origin),
            diffuse: self.param(&p.diffuse_reflectance, ColorSlot::Reflectance, origin),
            specular: self.param(&p.specular_reflectance, ColorSlot::Reflectance, origin),
            nonlinear: p.nonlinear,
        }
    }
}
