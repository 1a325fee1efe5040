//! Surface scattering models that Mitsuba 3 has, and the way to those it has not.

use super::Writer;
use super::element::Element;
use super::substitute;
use crate::ir::{
    Bsdf, BsdfKind, ColorInput, ColorSlot, Conductor, ConductorMaterial, Dielectric, FloatInput, Id, Ior,
    Microfacet, MicrofacetDistribution, Origin, PerturbedShading, Plastic, PrincipledIndex, RoughnessRemap,
    Shadowing,
};
use crate::spectrum::{conductor, ior};
use crate::write::WriteError;

use ColorSlot::{Reflectance, Unbounded};

impl Writer<'_, '_> {
    pub fn bsdf_definition(&mut self, id: Id<Bsdf>) -> Result<Element, WriteError> {
        let element = self.bsdf_itself(id)?;
        Ok(element.id(self.ids.bsdfs[id.index()].as_deref()))
    }

    /// A reference, or the thing itself.
    pub fn bsdf(&mut self, id: Id<Bsdf>) -> Result<Element, WriteError> {
        match &self.ids.bsdfs[id.index()] {
            Some(shared) => Ok(Element::new("ref").with("id", shared.as_str())),
            None => self.bsdf_itself(id),
        }
    }

    fn bsdf_itself(&mut self, id: Id<Bsdf>) -> Result<Element, WriteError> {
        let scene = self.scene;
        let Bsdf { origin, kind, .. } = &scene.bsdfs[id];
        let origin = *origin;
        let bsdf = |plugin: &str| Element::plugin("bsdf", plugin);
        Ok(match kind {
            BsdfKind::Diffuse { reflectance } => bsdf("diffuse").children(self.color_input(
                "reflectance",
                reflectance,
                Reflectance,
                Some(0.5),
                origin,
            )?),
            BsdfKind::Dielectric(d) => self.dielectric(bsdf("dielectric"), d, origin)?,
            BsdfKind::ThinDielectric(d) => self.dielectric(bsdf("thindielectric"), d, origin)?,
            // pbrt's roughness 0 is a smooth surface; Mitsuba's rough models want alpha above it.
            BsdfKind::RoughDielectric { interface, microfacet } if microfacet.is_smooth() => {
                self.dielectric(bsdf("dielectric"), interface, origin)?
            }
            BsdfKind::RoughConductor { conductor, microfacet } if microfacet.is_smooth() => {
                self.conductor(bsdf("conductor"), conductor, origin)?
            }
            BsdfKind::RoughDielectric { interface, microfacet } => {
                let element = self.dielectric(bsdf("roughdielectric"), interface, origin)?;
                self.microfacet(element, microfacet, origin)?
            }
            BsdfKind::Conductor(c) => self.conductor(bsdf("conductor"), c, origin)?,
            BsdfKind::RoughConductor { conductor, microfacet } => {
                let element = self.conductor(bsdf("roughconductor"), conductor, origin)?;
                self.microfacet(element, microfacet, origin)?
            }
            BsdfKind::Plastic(p) => self.plastic(bsdf("plastic"), p, origin)?,
            BsdfKind::RoughPlastic { plastic, microfacet } => {
                let element = self.plastic(bsdf("roughplastic"), plastic, origin)?;
                let microfacet = self.single_alpha(microfacet, origin)?;
                self.microfacet(element, &microfacet, origin)?
            }
            BsdfKind::TwoSided { front, back } => {
                let sides = [Some(*front), *back].into_iter().flatten();
                let passes = sides.clone().any(|id| self.query.bsdf(&scene.bsdfs, id).transmits);
                let mut element = bsdf("twosided").boolean_unless("allow_transmission", passes, false);
                for side in sides {
                    element = element.child(self.bsdf(side)?);
                }
                element
            }
            BsdfKind::Mask { opacity, nested } => bsdf("mask")
                .children(self.float_input("opacity", opacity, Some(0.5))?)
                .child(self.bsdf(*nested)?),
            BsdfKind::Null => bsdf("null"),
            BsdfKind::BumpMap { height, scale, shading, nested } => {
                let FloatInput::Texture(height) = height else { return self.bsdf(*nested) };
                let element = bsdf("bumpmap").float_unless("scale", *scale, 1.0);
                let element = element.child(self.float_texture("height", *height)?);
                perturbed(element, *shading).child(self.bsdf(*nested)?)
            }
            BsdfKind::NormalMap { normals, shading, nested } => {
                let normals = self.color_input("normalmap", normals, Unbounded, None, origin)?;
                let element = bsdf("normalmap").children(normals);
                perturbed(element, *shading).child(self.bsdf(*nested)?)
            }
            BsdfKind::Blend { weight, first, second } => bsdf("blendbsdf")
                .children(self.float_input("weight", weight, None)?)
                .child(self.bsdf(*first)?)
                .child(self.bsdf(*second)?),
            BsdfKind::Mixture { parts } => self.mixture(parts)?,
            BsdfKind::Principled(p) => {
                let mut element = bsdf("principled").children(self.color_input(
                    "base_color",
                    &p.base_color,
                    Reflectance,
                    Some(0.5),
                    origin,
                )?);
                element = match p.index {
                    PrincipledIndex::Eta(eta) => element.float("eta", eta),
                    PrincipledIndex::Specular(specular) => element.float("specular", specular),
                };
                self.floats(
                    element,
                    &[
                        ("roughness", &p.roughness, 0.5),
                        ("anisotropic", &p.anisotropic, 0.0),
                        ("metallic", &p.metallic, 0.0),
                        ("spec_trans", &p.spec_trans, 0.0),
                        ("spec_tint", &p.spec_tint, 0.0),
                        ("sheen", &p.sheen, 0.0),
                        ("sheen_tint", &p.sheen_tint, 0.0),
                        ("flatness", &p.flatness, 0.0),
                        ("clearcoat", &p.clearcoat, 0.0),
                        ("clearcoat_gloss", &p.clearcoat_gloss, 0.0),
                    ],
                )?
            }
            BsdfKind::PrincipledThin(p) => {
                let element = bsdf("principledthin").children(self.color_input(
                    "base_color",
                    &p.base_color,
                    Reflectance,
                    Some(0.5),
                    origin,
                )?);
                self.floats(
                    element,
                    &[
                        ("roughness", &p.roughness, 0.5),
                        ("anisotropic", &p.anisotropic, 0.0),
                        ("spec_trans", &p.spec_trans, 0.0),
                        ("eta", &p.eta, 1.5),
                        ("spec_tint", &p.spec_tint, 0.0),
                        ("sheen", &p.sheen, 0.0),
                        ("sheen_tint", &p.sheen_tint, 0.0),
                        ("flatness", &p.flatness, 0.0),
                        ("diff_trans", &p.diff_trans, 0.0),
                    ],
                )?
            }
            other => self.substitute(other, origin)?,
        })
    }

    fn floats(
        &mut self,
        mut element: Element,
        rows: &[(&str, &FloatInput, f64)],
    ) -> Result<Element, WriteError> {
        for (name, input, default) in rows {
            element = element.children(self.float_input(name, input, Some(*default))?);
        }
        Ok(element)
    }

    pub fn dielectric(
        &mut self,
        element: Element,
        d: &Dielectric,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let mut element = index(element, "int_ior", &d.int_ior, "bk7");
        element = index(element, "ext_ior", &d.ext_ior, "air");
        for (name, input) in [
            ("specular_reflectance", &d.specular_reflectance),
            ("specular_transmittance", &d.specular_transmittance),
        ] {
            element = element.children(self.color_input(name, input, Reflectance, Some(1.0), origin)?);
        }
        Ok(element)
    }

    pub fn conductor(
        &mut self,
        element: Element,
        c: &Conductor,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let around = |ext: &Option<Ior>| ext.as_ref().map_or(1.0, value_of);
        let mut factor = None;
        let element = match &c.material {
            ConductorMaterial::Mirror => element.string("material", "none"),
            ConductorMaterial::Named { name, ext_eta } => {
                let ext = around(ext_eta);
                match conductor(name).filter(|_| ext != 1.0) {
                    // 0.6 divides by the index around the metal; Mitsuba 3 has no parameter for it.
                    Some(metal) => element
                        .comment(format!("{name} in a medium of index {ext}"))
                        .child(super::color::rgb_element("eta", metal.eta.map(|v| v / ext)))
                        .child(super::color::rgb_element("k", metal.k.map(|v| v / ext))),
                    None => element.string("material", name),
                }
            }
            ConductorMaterial::EtaK { eta, k, ext_eta } => {
                let ext = around(ext_eta);
                let mut element = element;
                for (name, input) in [("eta", eta), ("k", k)] {
                    let child = match input {
                        ColorInput::Color(color) if ext != 1.0 => {
                            let rgb = self.rgb(color, Unbounded, origin);
                            Some(super::color::rgb_element(name, rgb.map(|v| v / ext)))
                        }
                        ColorInput::Texture(id) => Some(self.scaled_texture(name, *id, 1.0 / ext)?),
                        color => self.color_input(name, color, Unbounded, None, origin)?,
                    };
                    element = element.children(child);
                }
                element
            }
            ConductorMaterial::Reflectance(ColorInput::Color(color)) => {
                let reflectance = self.rgb(color, Reflectance, origin);
                // As pbrt does, kept off 1, where k has no end.
                let k = reflectance.map(|r| {
                    let r = r.clamp(0.0, 0.9999);
                    2.0 * (r / (1.0 - r)).sqrt()
                });
                element
                    .child(super::color::rgb_element("eta", [1.0; 3]))
                    .child(super::color::rgb_element("k", k))
            }
            ConductorMaterial::Reflectance(ColorInput::Texture(id)) => {
                self.out.lose(
                    origin,
                    "a metal given by a textured reflectance at normal incidence",
                    "a mirror that reflects this share at all angles",
                );
                factor = Some(self.texture("specular_reflectance", *id)?);
                element.string("material", "none")
            }
        };
        let factor = match factor {
            Some(factor) => Some(factor),
            None => self.color_input(
                "specular_reflectance",
                &c.specular_reflectance,
                Reflectance,
                Some(1.0),
                origin,
            )?,
        };
        Ok(element.children(factor))
    }

    pub fn plastic(&mut self, element: Element, p: &Plastic, origin: Origin) -> Result<Element, WriteError> {
        let element = index(element, "int_ior", &p.int_ior, "polypropylene");
        let element = index(element, "ext_ior", &p.ext_ior, "air");
        let (diffuse, specular) = (&p.diffuse_reflectance, &p.specular_reflectance);
        Ok(element
            .children(self.color_input("diffuse_reflectance", diffuse, Reflectance, Some(0.5), origin)?)
            .children(self.color_input("specular_reflectance", specular, Reflectance, Some(1.0), origin)?)
            .boolean_unless("nonlinear", p.nonlinear, false))
    }

    pub fn microfacet(
        &mut self,
        element: Element,
        m: &Microfacet,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let distribution = match m.distribution {
            MicrofacetDistribution::Beckmann => "beckmann",
            MicrofacetDistribution::Ggx => "ggx",
            MicrofacetDistribution::Phong => {
                self.out.lose(
                    origin,
                    "the Phong distribution of microfacets",
                    "beckmann with the same alpha",
                );
                "beckmann"
            }
        };
        if m.shadowing == Shadowing::HeightCorrelated {
            self.out.lose(
                origin,
                "height-correlated shadowing of microfacets",
                "Mitsuba's separable shadowing, darker by up to 8 % at grazing angles",
            );
        }
        let mut element = element.string("distribution", distribution);
        let (u, v) = (self.alpha(&m.alpha_u, m.remap, origin)?, self.alpha(&m.alpha_v, m.remap, origin)?);
        if u == v {
            element = element.children(self.float_input("alpha", &u, None)?);
        } else {
            element = element.children(self.float_input("alpha_u", &u, None)?);
            element = element.children(self.float_input("alpha_v", &v, None)?);
        }
        Ok(element.boolean_unless("sample_visible", m.sample_visible, true))
    }

    /// Roughness as α.
    pub fn alpha(
        &mut self,
        input: &FloatInput,
        remap: RoughnessRemap,
        origin: Origin,
    ) -> Result<FloatInput, WriteError> {
        Ok(match (remap, input) {
            (RoughnessRemap::None, input) => input.clone(),
            (RoughnessRemap::Sqrt, FloatInput::Value(v)) => FloatInput::Value(v.max(0.0).sqrt()),
            (RoughnessRemap::Sqrt, input) => {
                let mean = self.one_number(input, "a roughness whose root is alpha", origin)?;
                FloatInput::Value(mean.max(0.0).sqrt())
            }
        })
    }

    /// `roughplastic` takes one number.
    pub fn single_alpha(&mut self, m: &Microfacet, origin: Origin) -> Result<Microfacet, WriteError> {
        let u = self.alpha(&m.alpha_u, m.remap, origin)?;
        let u = self.one_number(&u, "the alpha of roughplastic", origin)?;
        let v = self.alpha(&m.alpha_v, m.remap, origin)?;
        let v = self.one_number(&v, "the alpha of roughplastic", origin)?;
        let alpha = if u == v {
            u
        } else {
            let alpha = (u * v).sqrt();
            self.out.lose(origin, "an anisotropic coat", format!("the isotropic alpha {alpha:.4}"));
            alpha
        };
        let alpha = FloatInput::Value(alpha);
        Ok(Microfacet { alpha_u: alpha.clone(), alpha_v: alpha, remap: RoughnessRemap::None, ..m.clone() })
    }

    /// Σ weight·part as a chain of blends of two.
    fn mixture(&mut self, parts: &[(f64, Id<Bsdf>)]) -> Result<Element, WriteError> {
        let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
        let mut left = sum.max(1.0);
        let mut weights = Vec::new();
        for (weight, id) in parts {
            weights.push((if left > 0.0 { 1.0 - weight / left } else { 1.0 }, *id));
            left -= weight;
        }
        let black = || substitute::diffuse(0.0);
        // From the last part backwards; what the weights leave is black.
        let mut rest = None;
        for (others, id) in weights.into_iter().rev() {
            let part = self.bsdf(id)?;
            rest = Some(if others <= 1e-12 {
                part
            } else {
                Element::plugin("bsdf", "blendbsdf")
                    .float("weight", others)
                    .child(part)
                    .child(rest.unwrap_or_else(black))
            });
        }
        Ok(rest.unwrap_or_else(black))
    }
}

fn perturbed(element: Element, shading: PerturbedShading) -> Element {
    element.boolean_unless("flip_invalid_normals", shading.flip_invalid_normals, true).boolean_unless(
        "use_shadowing_function",
        shading.shadowing,
        true,
    )
}

/// The number behind an index.
pub(super) fn value_of(index: &Ior) -> f64 {
    match index {
        Ior::Value(v) => *v,
        Ior::Named(name) => ior(name).unwrap_or(1.0),
    }
}

pub(super) fn index(element: Element, name: &str, index: &Ior, default: &str) -> Element {
    match index {
        Ior::Named(material) if material == default => element,
        Ior::Named(material) => element.string(name, material),
        Ior::Value(v) => element.float(name, *v),
    }
}
