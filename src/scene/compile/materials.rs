//! BSDFs of the IR → materials.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use caustica_formats::fourier;
use caustica_formats::ir::{self, BsdfKind, ColorSlot};

use super::Compiler;
use super::textures::DEFAULT_REFLECTANCE;
use crate::bsdf::microfacet::{Distribution, Remap, Shadowing};
use crate::bsdf::{
    DiffuseModel, DiffuseTransmissionModel, FourierModel, FourierTable, FresnelBlendModel, LobeSumModel,
    Material, Node, Perturbation, PhongModel, PlasticModel, Relief, RoughDiffuseModel, RoughPlasticModel,
    Roughness, ThinDielectricModel, Transmittance, WardModel, WardVariant,
};
use crate::math::Color;
use crate::texture::Param;

/// α below which pbrt-v4 drops the microfacets.
const PBRT_SMOOTH: f32 = 1e-3;

fn ward_variant(variant: ir::WardVariant) -> WardVariant {
    match variant {
        ir::WardVariant::Ward => WardVariant::Ward,
        ir::WardVariant::Duer => WardVariant::Duer,
        ir::WardVariant::Balanced => WardVariant::Balanced,
    }
}

/// Nested blends or two-sided materials double the parts at each level; thirty levels would fill the memory.
const MAX_PARTS: u32 = 1024;

#[derive(Default)]
pub struct MaterialTable {
    materials: Vec<Material>,
    known: HashMap<usize, u32>,
    default: Option<u32>,
    black: Option<u32>,
    /// BSDFs of the material that is being built.
    parts: u32,
    /// Coats around what is being built.
    pub(super) coats: u32,
    /// Tabulated BSDFs by their files; `None` is one that cannot be read.
    tables: HashMap<PathBuf, Option<Arc<FourierTable>>>,
}

impl MaterialTable {
    pub fn finish(self) -> Vec<Material> {
        self.materials
    }

    /// Every parameter of a material that may be a texture.
    pub fn params(&self, material: u32) -> Vec<Param> {
        self.materials[material as usize].params()
    }

    fn push(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }
}

fn diffuse(reflectance: Param) -> Node {
    DiffuseModel { reflectance }.into()
}

impl Compiler<'_> {
    /// Material of a shape: its BSDF, or the format's default (black under an area light).
    pub(super) fn material(&mut self, bsdf: Option<ir::Id<ir::Bsdf>>, emits: bool) -> u32 {
        let Some(id) = bsdf else {
            let (slot, color) = if emits {
                (&mut self.materials.black, Color::ZERO)
            } else {
                (&mut self.materials.default, DEFAULT_REFLECTANCE)
            };
            if let Some(index) = *slot {
                return index;
            }
            let index = self.materials.materials.len() as u32;
            *slot = Some(index);
            self.materials.materials.push(Material::new(diffuse(Param::Constant(color))));
            return index;
        };
        if let Some(index) = self.materials.known.get(&id.index()) {
            return *index;
        }
        self.materials.parts = 0;
        let node = self.node(id);
        if self.materials.parts > MAX_PARTS {
            let origin = self.ir.bsdfs[id].origin;
            self.refuse(format!("a material of more than {MAX_PARTS} BSDFs"), origin);
        }
        if node.tilts_twice() {
            let origin = self.ir.bsdfs[id].origin;
            self.refuse("a bump or normal map inside another one", origin);
        }
        let index = self.materials.push(Material::new(node));
        self.materials.known.insert(id.index(), index);
        index
    }

    /// Whether a material differs from point to point.
    pub(super) fn varies(&self, material: u32) -> bool {
        self.materials.materials[material as usize].varies()
    }

    /// Whether a material wants frames that follow uv.
    pub(super) fn oriented(&self, material: u32) -> bool {
        self.materials.materials[material as usize].nature().oriented
    }

    /// Whether light reaches the other side.
    pub(super) fn transmits(&self, material: u32) -> bool {
        self.materials.materials[material as usize].nature().transmits
    }

    pub(super) fn node(&mut self, id: ir::Id<ir::Bsdf>) -> Node {
        let bsdf = &self.ir.bsdfs[id];
        self.materials.parts = self.materials.parts.saturating_add(1);
        if self.materials.parts > MAX_PARTS {
            return diffuse(Param::Constant(DEFAULT_REFLECTANCE));
        }
        self.model(&bsdf.kind, bsdf.origin)
    }

    /// What [`Self::node`] makes of one kind of BSDF.
    fn model(&mut self, kind: &BsdfKind, origin: ir::Origin) -> Node {
        match kind {
            BsdfKind::Diffuse { reflectance } => diffuse(self.reflectance(reflectance, origin)),
            BsdfKind::Dielectric(d) => self.dielectric(d, origin).into(),
            BsdfKind::ThinDielectric(d) => ThinDielectricModel(self.dielectric(d, origin)).into(),
            BsdfKind::RoughDielectric { interface, microfacet } => {
                self.rough_dielectric(interface, microfacet, origin)
            }
            BsdfKind::Conductor(c) => self.conductor(c, origin).into(),
            BsdfKind::RoughConductor { conductor, microfacet } => {
                self.rough_conductor(conductor, microfacet, origin)
            }
            BsdfKind::Plastic(p) => self.plastic(p, origin).into(),
            BsdfKind::RoughPlastic { plastic, microfacet } => {
                let smooth = self.plastic(plastic, origin);
                match self.roughness(microfacet) {
                    Some(roughness) => self.rough_plastic(smooth, roughness).into(),
                    None => smooth.into(),
                }
            }
            BsdfKind::TwoSided { front, back } => self.two_sided(*front, *back, origin),
            BsdfKind::Mask { opacity, nested } => self.mask(opacity, *nested),
            BsdfKind::Null => Node::Null,
            BsdfKind::BumpMap { height, scale, shading, nested } => {
                let relief = self.bumps(height, *scale, origin);
                self.tilted(relief, *shading, *nested)
            }
            BsdfKind::NormalMap { normals, shading, nested } => {
                let relief = Relief::Normal(self.param(normals, ColorSlot::Unbounded, origin));
                self.tilted(relief, *shading, *nested)
            }
            BsdfKind::Blend { weight, first, second } => {
                let weight = self.scalar_param(weight);
                Node::Blend(weight, Box::new([self.node(*first), self.node(*second)]))
            }
            BsdfKind::Mixture { parts } => {
                let sum = parts.iter().map(|(w, _)| *w).sum::<f64>().max(1.0);
                Node::Mixture(parts.iter().map(|(w, id)| ((w / sum) as f32, self.node(*id))).collect())
            }
            BsdfKind::Principled(p) => self.principled(p, origin).into(),
            BsdfKind::PrincipledThin(p) => self.principled_thin(p, origin).into(),
            BsdfKind::RoughDiffuse { reflectance, alpha, fast } => {
                let reflectance = self.reflectance(reflectance, origin);
                RoughDiffuseModel { reflectance, alpha: self.scalar_param(alpha), fast: *fast }.into()
            }
            BsdfKind::Phong { exponent, diffuse_reflectance, specular_reflectance } => {
                let [diffuse, specular] =
                    self.reflectances([diffuse_reflectance, specular_reflectance], origin);
                PhongModel { diffuse, specular, exponent: self.scalar_param(exponent) }.into()
            }
            BsdfKind::Ward { variant, alpha_u, alpha_v, diffuse_reflectance, specular_reflectance } => {
                let [diffuse, specular] =
                    self.reflectances([diffuse_reflectance, specular_reflectance], origin);
                let [alpha_u, alpha_v] = [alpha_u, alpha_v].map(|alpha| self.scalar_param(alpha));
                WardModel { variant: ward_variant(*variant), diffuse, specular, alpha_u, alpha_v }.into()
            }
            BsdfKind::Coating {
                int_ior,
                ext_ior,
                thickness,
                sigma_a,
                specular_reflectance,
                microfacet,
                nested,
            } => {
                let (specular, rough) = (specular_reflectance, microfacet.as_ref());
                self.coat(int_ior, ext_ior, *thickness, sigma_a, specular, rough, *nested, origin)
            }
            BsdfKind::DiffuseTransmission { .. }
            | BsdfKind::CoatedDiffuse { .. }
            | BsdfKind::CoatedConductor { .. }
            | BsdfKind::LobeSum(_)
            | BsdfKind::FresnelBlend { .. }
            | BsdfKind::Fourier(_) => self.of_pbrt(kind, origin),
        }
    }

    fn reflectances(&mut self, inputs: [&ir::ColorInput; 2], origin: ir::Origin) -> [Param; 2] {
        inputs.map(|input| self.reflectance(input, origin))
    }

    /// What pbrt has and Mitsuba 3 has not.
    fn of_pbrt(&mut self, kind: &BsdfKind, origin: ir::Origin) -> Node {
        match kind {
            BsdfKind::LobeSum(lobes) => self.lobe_sum(lobes, origin).into(),
            BsdfKind::FresnelBlend { diffuse_reflectance, specular_reflectance, microfacet } => {
                let [diffuse, specular] =
                    self.reflectances([diffuse_reflectance, specular_reflectance], origin);
                FresnelBlendModel { diffuse, specular, roughness: self.distribution(microfacet) }.into()
            }
            BsdfKind::Fourier(file) => self.fourier(file, origin),
            BsdfKind::DiffuseTransmission { reflectance, transmittance } => {
                let [reflectance, transmittance] = self.reflectances([reflectance, transmittance], origin);
                DiffuseTransmissionModel { reflectance, transmittance }.into()
            }
            BsdfKind::CoatedDiffuse { reflectance, coat } => self.coated_diffuse(reflectance, coat, origin),
            BsdfKind::CoatedConductor { conductor, microfacet, coat } => {
                self.coated_conductor(conductor, microfacet, coat, origin)
            }
            other => self.model(other, origin),
        }
    }

    fn fourier(&mut self, file: &ir::BsdfFile, origin: ir::Origin) -> Node {
        let table = match self.materials.tables.get(&file.path) {
            Some(known) => known.clone(),
            None => {
                let read = self.files.read(&file.path).map_err(|e| e.to_string());
                let read = read.and_then(|bytes| fourier::read(&bytes).map_err(|e| e.to_string()));
                let table = match read {
                    Ok(t) => Some(Arc::new(FourierTable::new(
                        [t.eta, t.alpha],
                        t.channels,
                        t.mu,
                        t.series,
                        t.coefficients,
                    ))),
                    Err(e) => {
                        self.error(format!("cannot read `{}`: {e}", file.path.display()), origin);
                        None
                    }
                };
                self.materials.tables.insert(file.path.clone(), table.clone());
                table
            }
        };
        table
            .map_or_else(|| diffuse(Param::Constant(DEFAULT_REFLECTANCE)), |table| FourierModel(table).into())
    }

    fn lobe_sum(&mut self, l: &ir::LobeSum, origin: ir::Origin) -> LobeSumModel {
        LobeSumModel {
            diffuse: self.reflectances([&l.diffuse_reflectance, &l.diffuse_transmittance], origin),
            glossy: self.reflectances([&l.glossy_reflectance, &l.glossy_transmittance], origin),
            specular: self.reflectances([&l.specular_reflectance, &l.specular_transmittance], origin),
            eta: self.scalar_param(&l.eta),
            roughness: self.distribution(&l.microfacet),
        }
    }

    fn two_sided(
        &mut self,
        front: ir::Id<ir::Bsdf>,
        back: Option<ir::Id<ir::Bsdf>>,
        origin: ir::Origin,
    ) -> Node {
        let before = self.materials.parts;
        let f = self.node(front);
        let b = match back {
            Some(back) => self.node(back),
            None => self.twin(&f, self.materials.parts - before),
        };
        if f.nature().transmits || b.nature().transmits {
            self.error("only materials that let no light through can be made two-sided", origin);
        }
        Node::TwoSided(Box::new([f, b]))
    }

    fn mask(&mut self, opacity: &ir::FloatInput, nested: ir::Id<ir::Bsdf>) -> Node {
        let nested = self.node(nested);
        match self.scalar_param(opacity) {
            // An opaque mask is left out, so that shadow rays need not evaluate it.
            Param::Constant(o) if o == Color::ONE => nested,
            opacity => Node::Mask(opacity, Box::new(nested)),
        }
    }

    fn bumps(&mut self, height: &ir::FloatInput, scale: f64, origin: ir::Origin) -> Relief {
        let height = self.scalar_param(height);
        if !self.textures.so_far().attributes_in(&[height]).is_empty() {
            self.unsupported("a bump map from an attribute of the mesh", "a flat surface", origin);
        }
        Relief::Bump { height, scale: scale as f32 }
    }

    /// A second copy of a node, which counts as so many further parts.
    fn twin(&mut self, node: &Node, parts: u32) -> Node {
        self.materials.parts = self.materials.parts.saturating_add(parts);
        if self.materials.parts > MAX_PARTS {
            return diffuse(Param::Constant(DEFAULT_REFLECTANCE));
        }
        node.clone()
    }

    fn tilted(&mut self, relief: Relief, shading: ir::PerturbedShading, nested: ir::Id<ir::Bsdf>) -> Node {
        let nested = self.node(nested);
        // Lobes below a coat are drawn for one normal. No renderer has both: Mitsuba 3 flips, but has no coats.
        let flip_invalid = shading.flip_invalid_normals && self.materials.coats == 0;
        let shadowing = shading.shadowing;
        Node::Tilted(Perturbation { relief, flip_invalid, shadowing }, Box::new(nested))
    }

    /// `None` is a surface so smooth that pbrt treats it as perfectly specular. Mitsuba never does.
    pub(super) fn roughness(&mut self, m: &ir::Microfacet) -> Option<Roughness> {
        let roughness = self.distribution(m);
        let smooth = roughness.shadowing == Shadowing::HeightCorrelated
            && roughness.constant().is_some_and(|[u, v]| u.max(v) < PBRT_SMOOTH);
        (!smooth).then_some(roughness)
    }

    fn distribution(&mut self, m: &ir::Microfacet) -> Roughness {
        Roughness {
            kind: match m.distribution {
                ir::MicrofacetDistribution::Beckmann => Distribution::Beckmann,
                ir::MicrofacetDistribution::Ggx => Distribution::Ggx,
                ir::MicrofacetDistribution::Phong => Distribution::Phong,
            },
            shadowing: match m.shadowing {
                ir::Shadowing::Separable => Shadowing::Separable,
                ir::Shadowing::HeightCorrelated => Shadowing::HeightCorrelated,
            },
            u: self.scalar_param(&m.alpha_u),
            v: self.scalar_param(&m.alpha_v),
            remap: match m.remap {
                ir::RoughnessRemap::None => Remap::None,
                ir::RoughnessRemap::Sqrt => Remap::Sqrt,
                ir::RoughnessRemap::Polynomial => Remap::Polynomial,
            },
        }
    }

    pub(super) fn rough_plastic(&mut self, smooth: PlasticModel, roughness: Roughness) -> RoughPlasticModel {
        let PlasticModel { eta, diffuse, specular, between } = smooth;
        let transmittance = self.transmittance(&roughness, eta);
        RoughPlasticModel { eta, diffuse, specular, between, roughness, transmittance }
    }

    pub(super) fn transmittance(&mut self, roughness: &Roughness, eta: f32) -> Arc<Transmittance> {
        let alpha = roughness.isotropic();
        let (kind, shadowing) = (roughness.kind, roughness.shadowing);
        Transmittance::shared(kind, shadowing, alpha, eta)
    }
}
