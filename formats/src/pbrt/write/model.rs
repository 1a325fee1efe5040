//! Models that pbrt lacks: the closest it has, each with its loss.

use super::Writer;
use super::material::{Said, index};
use super::text::Params;
use crate::ir::{
    Bsdf, BsdfKind, ColorInput, ColorSlot, FloatInput, Id, Microfacet, Origin, PerturbedShading, Plastic,
    Principled, PrincipledIndex, RoughnessRemap,
};
use crate::write::{Tone, WriteError};

use ColorSlot::Reflectance;

impl Writer<'_, '_> {
    pub fn modelled(&mut self, kind: &BsdfKind, origin: Origin) -> Result<Said, WriteError> {
        match kind {
            BsdfKind::Plastic(plastic) => self.plastic(plastic, None, origin),
            BsdfKind::RoughPlastic { plastic, microfacet } => self.plastic(plastic, Some(microfacet), origin),
            BsdfKind::Mask { nested, .. } => {
                self.out.lose(origin, "a mask inside another material", "the material without it");
                self.said_of(*nested)
            }
            BsdfKind::TwoSided { front, .. } => self.said_of(*front),
            BsdfKind::BumpMap { height, scale, shading, nested } => {
                self.lose_shading(*shading, origin);
                let FloatInput::Texture(id) = height else { return self.said_of(*nested) };
                let texture = self.scaled_texture(*id, *scale, true)?;
                self.with_relief(*nested, &|p| p.texture("displacement", &texture), origin)
            }
            BsdfKind::NormalMap { normals, shading, nested } => {
                self.normal_map(normals, *shading, *nested, origin)
            }
            BsdfKind::Mixture { parts } => {
                self.out.lose(origin, "a mixture of materials by weights", "the heaviest of them");
                let heaviest = parts.iter().max_by(|a, b| a.0.total_cmp(&b.0));
                match heaviest {
                    Some((_, id)) => self.said_of(*id),
                    None => Ok(("diffuse", Params::default().rgb("reflectance", [0.0; 3]))),
                }
            }
            BsdfKind::Principled(p) => self.principled(p, origin),
            BsdfKind::PrincipledThin(p) => {
                self.out.lose(origin, "the `principledthin` model", "half reflection and half transmission");
                let m = Params::default();
                let m = self.color_input(m, "reflectance", &p.base_color, Reflectance, origin)?;
                let m = self.color_input(m, "transmittance", &p.base_color, Reflectance, origin)?;
                Ok(("diffusetransmission", m.float("scale", 0.5)))
            }
            BsdfKind::RoughDiffuse { reflectance, .. } => {
                self.out.lose(origin, "Oren-Nayar reflection (`roughdiffuse`)", "`diffuse`");
                let p = Params::default();
                Ok(("diffuse", self.color_input(p, "reflectance", reflectance, Reflectance, origin)?))
            }
            BsdfKind::Phong { exponent, diffuse_reflectance, .. } => {
                // The exponent whose lobe is as wide about the normal: 2/α² − 2.
                let n = if let FloatInput::Value(n) = exponent { *n } else { 30.0 };
                let alpha = (2.0 / (n + 2.0)).sqrt();
                self.out.lose(origin, "the `phong` model", format!("a coat with alpha {alpha:.4}"));
                let alpha = FloatInput::Value(alpha);
                self.coated(
                    diffuse_reflectance,
                    1.5,
                    Some(&Microfacet::pbrt([alpha.clone(), alpha], RoughnessRemap::None)),
                    origin,
                )
            }
            BsdfKind::Ward { alpha_u, alpha_v, diffuse_reflectance, .. } => {
                self.out.lose(origin, "the `ward` model", "a coat of the same roughness");
                let m = Microfacet::pbrt([alpha_u.clone(), alpha_v.clone()], RoughnessRemap::None);
                self.coated(diffuse_reflectance, 1.5, Some(&m), origin)
            }
            BsdfKind::LobeSum(lobes) => self.lobe_sum(lobes, origin),
            BsdfKind::FresnelBlend { diffuse_reflectance, specular_reflectance, microfacet } => {
                self.fresnel_blend(diffuse_reflectance, specular_reflectance, microfacet, origin)
            }
            BsdfKind::Coating { int_ior, ext_ior, microfacet, nested, .. } => {
                let scene = self.scene;
                if let BsdfKind::Diffuse { reflectance } = &scene.bsdfs[*nested].kind {
                    self.out.lose(origin, "a coating", "`coateddiffuse` over the same base");
                    let eta = index(int_ior) / index(ext_ior);
                    return self.coated(reflectance, eta, microfacet.as_ref(), origin);
                }
                self.out.lose(origin, "a coating", "the bare material below it");
                self.said_of(*nested)
            }
            other => {
                self.out.lose(origin, format!("the `{}` model", other.name()), "diffuse gray 0.5");
                Ok(("diffuse", Params::default()))
            }
        }
    }

    fn principled(&mut self, p: &Principled, origin: Origin) -> Result<Said, WriteError> {
        let metal = matches!(p.metallic, FloatInput::Value(m) if m > 0.5);
        let glass = matches!(p.spec_trans, FloatInput::Value(t) if t > 0.5);
        let eta = match p.index {
            PrincipledIndex::Eta(eta) => eta,
            PrincipledIndex::Specular(s) => 2.0 / (1.0 - (0.08 * s.clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        let squared = squared(&p.roughness);
        if metal {
            self.out.lose(origin, "the `principled` model", "a metal of its colour");
            let m = Params::default();
            let m = self.color_input(m, "reflectance", &p.base_color, Reflectance, origin)?;
            return Ok(("conductor", self.roughness(m, &squared, ROUGHNESS, origin)?));
        }
        if glass {
            self.out.lose(origin, "the `principled` model", "rough glass");
            let d = Params::default().float("eta", eta);
            return Ok(("dielectric", self.roughness(d, &squared, ROUGHNESS, origin)?));
        }
        self.out.lose(origin, "the `principled` model", "a rough coat over its colour");
        self.coated(&p.base_color, eta, Some(&squared), origin)
    }

    fn normal_map(
        &mut self,
        normals: &ColorInput,
        shading: PerturbedShading,
        nested: Id<Bsdf>,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        self.lose_shading(shading, origin);
        match self.normal_picture(normals, origin)? {
            Some(name) => self.with_relief(nested, &|p| p.string("normalmap", &name), origin),
            None => {
                self.out.lose(origin, "a normal map that is not by uv", "no normal map");
                self.said_of(nested)
            }
        }
    }

    fn plastic(
        &mut self,
        p: &Plastic,
        microfacet: Option<&Microfacet>,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let eta = index(&p.int_ior) / index(&p.ext_ior);
        let base = self.base_of(p, eta, origin)?;
        self.out.lose(
            origin,
            "plastic in closed form",
            "`coateddiffuse`, which simulates scattering between coat and base",
        );
        self.lose_factor(&p.specular_reflectance, "the specular reflectance of plastic", origin);
        self.coat_over(base, eta, microfacet, origin)
    }

    /// The reflectance below pbrt's coat, between which and the base light keeps its colour.
    fn base_of(&mut self, p: &Plastic, eta: f64, origin: Origin) -> Result<Params, WriteError> {
        let tone = Tone::UnderCoat(diffuse_reflectance_from_inside(eta));
        let base = Params::default();
        match &p.diffuse_reflectance {
            same if p.nonlinear => self.color_input(base, "reflectance", same, Reflectance, origin),
            ColorInput::Color(color) => {
                let rgb = tone.of(self.out.rgb(color, Reflectance, origin));
                let rgb = self.within(rgb, Reflectance, origin);
                Ok(base.rgb("reflectance", rgb))
            }
            ColorInput::Texture(id) => match self.toned_texture(*id, tone)? {
                Some(name) => Ok(base.texture("reflectance", &name)),
                None => {
                    let what = "plastic without `nonlinear` over a texture that is not an image";
                    self.out.lose(origin, what, "its colours unchanged, up to a third darker");
                    self.color_input(base, "reflectance", &p.diffuse_reflectance, Reflectance, origin)
                }
            },
        }
    }

    fn lose_shading(&mut self, s: PerturbedShading, origin: Origin) {
        if s.flip_invalid_normals || s.shadowing {
            self.out.lose(origin, "the shadowing of tilted normals", "tilted normals unchanged");
        }
    }
}

/// Of a smooth coat for diffuse light below it: Mitsuba's fit for 1/eta.
fn diffuse_reflectance_from_inside(eta: f64) -> f64 {
    let inverse = 1.0 / eta;
    -1.4399 * inverse * inverse + 0.7099 * inverse + 0.6681 + 0.0636 * eta
}

const ROUGHNESS: [&str; 3] = ["roughness", "uroughness", "vroughness"];

/// α = roughness², as `principled` has it.
fn squared(roughness: &FloatInput) -> Microfacet {
    let alpha = match roughness {
        FloatInput::Value(v) => FloatInput::Value(v * v),
        texture => texture.clone(),
    };
    Microfacet::pbrt([alpha.clone(), alpha], RoughnessRemap::None)
}
