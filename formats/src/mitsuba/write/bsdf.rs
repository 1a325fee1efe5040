//! Surface scattering models that Mitsuba 3 has; `substitute` has the others.

use super::Writer;
use super::element::Element;
use super::interface::same_index;
use super::substitute;
use crate::ir::{
    Bsdf, BsdfKind, ColorSlot, FloatInput, Id, Origin, Part, PerturbedShading, Principled, PrincipledIndex,
    PrincipledThin,
};
use crate::write::WriteError;

use ColorSlot::Reflectance;

impl Writer<'_, '_> {
    pub fn bsdf_definition(&mut self, id: Id<Bsdf>) -> Result<Element, WriteError> {
        let (mut element, mut at) = (self.bsdf_itself(id)?, id);
        // A reference cannot have an id of its own: what is written as its nested model becomes a copy of it.
        while let Some(nested) = self.first_nested(at).filter(|_| element.is_reference()) {
            (element, at) = (self.bsdf_itself(nested)?, nested);
        }
        Ok(element.id(self.ids.bsdfs[id.index()].as_deref()))
    }

    /// A reference where the BSDF is shared, otherwise the BSDF itself.
    pub fn bsdf(&mut self, id: Id<Bsdf>) -> Result<Element, WriteError> {
        match &self.ids.bsdfs[id.index()] {
            Some(shared) => Ok(Element::new("ref").with("id", shared.as_str())),
            None => self.bsdf_itself(id),
        }
    }

    fn first_nested(&self, id: Id<Bsdf>) -> Option<Id<Bsdf>> {
        let mut nested = None;
        self.scene.bsdfs[id].kind.references(&mut |to| nested = nested.or(to.to()));
        nested
    }

    fn bsdf_itself(&mut self, id: Id<Bsdf>) -> Result<Element, WriteError> {
        let scene = self.scene;
        let Bsdf { origin, kind, .. } = &scene.bsdfs[id];
        let origin = *origin;
        let bsdf = |plugin: &str| Element::plugin("bsdf", plugin);
        match kind {
            BsdfKind::Diffuse { reflectance } => {
                let color = self.color_input("reflectance", reflectance, Reflectance, Some(0.5), origin)?;
                Ok(bsdf("diffuse").children(color))
            }
            BsdfKind::Dielectric(d) => self.dielectric(bsdf("dielectric"), d, origin),
            BsdfKind::ThinDielectric(d) => self.dielectric(bsdf("thindielectric"), d, origin),
            // pbrt's roughness 0 is a smooth surface; Mitsuba's rough models want alpha above it.
            // Mitsuba refuses roughness between equal indices, which nothing scatters.
            BsdfKind::RoughDielectric { interface, microfacet }
                if microfacet.is_smooth() || same_index(&interface.int_ior, &interface.ext_ior) =>
            {
                self.dielectric(bsdf("dielectric"), interface, origin)
            }
            BsdfKind::RoughConductor { conductor, microfacet } if microfacet.is_smooth() => {
                self.conductor(bsdf("conductor"), conductor, origin)
            }
            BsdfKind::RoughDielectric { interface, microfacet } => {
                let element = self.dielectric(bsdf("roughdielectric"), interface, origin)?;
                self.microfacet(element, microfacet, origin)
            }
            BsdfKind::Conductor(c) => self.conductor(bsdf("conductor"), c, origin),
            BsdfKind::RoughConductor { conductor, microfacet } => {
                let element = self.conductor(bsdf("roughconductor"), conductor, origin)?;
                self.microfacet(element, microfacet, origin)
            }
            BsdfKind::RoughPlastic { plastic: p, .. } if same_index(&p.int_ior, &p.ext_ior) => {
                let base = &p.diffuse_reflectance;
                let color = self.color_input("reflectance", base, Reflectance, Some(0.5), origin)?;
                Ok(bsdf("diffuse").children(color))
            }
            BsdfKind::Plastic(p) => self.plastic(bsdf("plastic"), p, origin),
            BsdfKind::RoughPlastic { plastic, microfacet } => {
                let element = self.plastic(bsdf("roughplastic"), plastic, origin)?;
                let microfacet = self.single_alpha(microfacet, origin)?;
                self.microfacet(element, &microfacet, origin)
            }
            BsdfKind::Null => Ok(bsdf("null")),
            BsdfKind::Principled(p) => self.principled(p, origin),
            BsdfKind::PrincipledThin(p) => self.principled_thin(p, origin),
            other => match self.wrapper(other, origin)? {
                Some(element) => Ok(element),
                None => self.substitute(other, origin),
            },
        }
    }

    /// A model made of other models.
    fn wrapper(&mut self, kind: &BsdfKind, origin: Origin) -> Result<Option<Element>, WriteError> {
        let bsdf = |plugin: &str| Element::plugin("bsdf", plugin);
        Ok(Some(match kind {
            BsdfKind::TwoSided { front, back } => {
                let sides = [Some(*front), *back].into_iter().flatten();
                let bsdfs = &self.scene.bsdfs;
                let passes = sides.clone().any(|id| self.query.bsdf(bsdfs, id).transmits);
                let mut element = bsdf("twosided").boolean_unless("allow_transmission", passes, false);
                for side in sides {
                    element = element.child(self.bsdf(side)?);
                }
                element
            }
            BsdfKind::Mask { opacity, nested } => bsdf("mask")
                .children(self.float_input("opacity", opacity, Some(0.5))?)
                .child(self.bsdf(*nested)?),
            BsdfKind::BumpMap { height, scale, shading, nested } => {
                let Some(height) = self.heights(height, origin)? else { return self.bsdf(*nested).map(Some) };
                let element = bsdf("bumpmap").float_unless("scale", *scale, 1.0).child(height);
                perturbed(element, *shading).child(self.bsdf(*nested)?)
            }
            BsdfKind::NormalMap { normals, shading, nested } => {
                let Some(normals) = self.normals(normals, origin)? else {
                    return self.bsdf(*nested).map(Some);
                };
                let element = bsdf("normalmap").child(normals);
                perturbed(element, *shading).child(self.bsdf(*nested)?)
            }
            BsdfKind::Blend { weight, first, second } => bsdf("blendbsdf")
                .children(self.float_input("weight", weight, None)?)
                .child(self.bsdf(*first)?)
                .child(self.bsdf(*second)?),
            BsdfKind::Mixture { parts } => self.mixture(parts)?,
            _ => return Ok(None),
        }))
    }

    fn principled(&mut self, p: &Principled, origin: Origin) -> Result<Element, WriteError> {
        let color = self.color_input("base_color", &p.base_color, Reflectance, Some(0.5), origin)?;
        let element = Element::plugin("bsdf", "principled").children(color);
        let element = match p.index {
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
        )
    }

    fn principled_thin(&mut self, p: &PrincipledThin, origin: Origin) -> Result<Element, WriteError> {
        let color = self.color_input("base_color", &p.base_color, Reflectance, Some(0.5), origin)?;
        self.floats(
            Element::plugin("bsdf", "principledthin").children(color),
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
        )
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
