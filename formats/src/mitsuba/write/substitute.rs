//! Models that Mitsuba 3 lacks: the closest it has, each with its loss.

use super::Writer;
use super::color::rgb_element;
use super::element::Element;
use super::interface::same_index;
use crate::ir::{Bsdf, BsdfKind, Coat, Color, ColorInput, ColorSlot, Id, Ior, Origin, Plastic};
use crate::spectrum::luminance;
use crate::write::WriteError;

use ColorSlot::Reflectance;

impl Writer<'_, '_> {
    pub fn substitute(&mut self, kind: &BsdfKind, origin: Origin) -> Result<Element, WriteError> {
        match kind {
            BsdfKind::RoughDiffuse { reflectance, .. } => {
                self.out.lose(origin, "Oren-Nayar reflection (`roughdiffuse`)", "`diffuse`");
                let color = self.color_input("reflectance", reflectance, Reflectance, None, origin)?;
                Ok(Element::plugin("bsdf", "diffuse").children(color))
            }
            BsdfKind::Phong { exponent, diffuse_reflectance, specular_reflectance } => {
                let n = self.one_number(exponent, "the exponent of phong", origin)?;
                // The exponent whose lobe is as wide about the normal: 2/α² − 2.
                let alpha = (2.0 / (n + 2.0)).sqrt();
                let instead = format!("a blend of `diffuse` and a rough mirror with alpha {alpha:.4}");
                self.out.lose(origin, "the `phong` model", instead);
                self.layered([diffuse_reflectance, specular_reflectance], [alpha; 2], origin)
            }
            BsdfKind::Ward { alpha_u, alpha_v, diffuse_reflectance, specular_reflectance, .. } => {
                let u = self.one_number(alpha_u, "the alpha of ward", origin)?;
                let v = self.one_number(alpha_v, "the alpha of ward", origin)?;
                self.out.lose(origin, "the `ward` model", "a blend of `diffuse` and a rough mirror");
                self.layered([diffuse_reflectance, specular_reflectance], [u, v], origin)
            }
            BsdfKind::Coating { int_ior, ext_ior, specular_reflectance, nested, .. } => {
                self.coating([int_ior, ext_ior], specular_reflectance, *nested, origin)
            }
            BsdfKind::LobeSum(lobes) => self.lobe_sum(lobes, origin),
            BsdfKind::FresnelBlend { diffuse_reflectance, specular_reflectance, microfacet } => {
                self.fresnel_blend([diffuse_reflectance, specular_reflectance], microfacet, origin)
            }
            BsdfKind::DiffuseTransmission { reflectance, transmittance } => {
                self.diffuse_transmission(reflectance, transmittance, origin)
            }
            // A coat of index 1 is not there.
            BsdfKind::CoatedDiffuse { reflectance, coat } if same_index(&coat.eta, &Ior::Value(1.0)) => {
                self.coat(coat, origin);
                let color = self.color_input("reflectance", reflectance, Reflectance, Some(0.5), origin)?;
                Ok(Element::plugin("bsdf", "diffuse").children(color))
            }
            BsdfKind::CoatedDiffuse { reflectance, coat } => self.coated_diffuse(reflectance, coat, origin),
            BsdfKind::CoatedConductor { conductor, microfacet, coat } => {
                if !same_index(&coat.eta, &Ior::Value(1.0)) {
                    self.out.lose(origin, "a coat over a metal (`coatedconductor`)", "the bare metal");
                }
                self.coat(coat, origin);
                if microfacet.is_smooth() {
                    return self.conductor(Element::plugin("bsdf", "conductor"), conductor, origin);
                }
                let element = self.conductor(Element::plugin("bsdf", "roughconductor"), conductor, origin)?;
                self.microfacet(element, microfacet, origin)
            }
            other => {
                self.out.lose(origin, format!("the `{}` model", other.name()), "diffuse gray 0.5");
                Ok(diffuse(0.5))
            }
        }
    }

    /// Mitsuba 3 has a coat over a diffuse base only.
    fn coating(
        &mut self,
        [int_ior, ext_ior]: [&Ior; 2],
        specular_reflectance: &ColorInput,
        nested: Id<Bsdf>,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let scene = self.scene;
        if let BsdfKind::Diffuse { reflectance } = &scene.bsdfs[nested].kind {
            self.out.lose(origin, "a coating", "`plastic` over the same diffuse base");
            let plastic = Plastic {
                int_ior: int_ior.clone(),
                ext_ior: ext_ior.clone(),
                diffuse_reflectance: reflectance.clone(),
                specular_reflectance: specular_reflectance.clone(),
                nonlinear: true,
            };
            return self.plastic(Element::plugin("bsdf", "plastic"), &plastic, origin);
        }
        self.out.lose(origin, "a coating", "the bare material below it");
        self.bsdf(nested)
    }

    fn coated_diffuse(
        &mut self,
        reflectance: &ColorInput,
        coat: &Coat,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        self.out.lose(
            origin,
            "multiple scattering under a coat (`coateddiffuse`)",
            "plastic with `nonlinear`",
        );
        let plastic = Plastic {
            int_ior: coat.eta.clone(),
            ext_ior: Ior::Value(1.0),
            diffuse_reflectance: reflectance.clone(),
            specular_reflectance: ColorInput::Color(Color::Gray(1.0)),
            nonlinear: true,
        };
        self.coat(coat, origin);
        let microfacet = self.single_alpha(&coat.microfacet, origin)?;
        if microfacet.is_smooth() {
            return self.plastic(Element::plugin("bsdf", "plastic"), &plastic, origin);
        }
        let element = self.plastic(Element::plugin("bsdf", "roughplastic"), &plastic, origin)?;
        self.microfacet(element, &microfacet, origin)
    }

    fn coat(&mut self, coat: &Coat, origin: Origin) {
        let empty = matches!(&coat.albedo, ColorInput::Color(Color::Gray(0.0) | Color::Rgb([0.0, 0.0, 0.0])));
        if !empty {
            self.out.lose(origin, "a scattering medium inside a coat", "an empty coat");
        }
    }

    /// `diffuse` + a rough mirror, as a blend that keeps both reflectances where they are constant
    /// and sum below 1.
    fn layered(
        &mut self,
        [diffuse, specular]: [&ColorInput; 2],
        [alpha_u, alpha_v]: [f64; 2],
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let weight = match specular {
            ColorInput::Color(color) => {
                let rgb = self.rgb(color, Reflectance, origin);
                let largest = rgb.into_iter().fold(0.0, f64::max);
                let base = match diffuse {
                    ColorInput::Color(color) => luminance(self.rgb(color, Reflectance, origin)),
                    ColorInput::Texture(_) => 0.5,
                };
                (largest / (largest + base).max(1e-6)).clamp(0.01, 0.99)
            }
            ColorInput::Texture(_) => 0.5,
        };
        let diffuse = self.share("reflectance", diffuse, 1.0 - weight, origin)?;
        let specular = self.share("specular_reflectance", specular, weight, origin)?;
        let mut mirror = Element::plugin("bsdf", "roughconductor")
            .string("material", "none")
            .string("distribution", "beckmann");
        mirror = if alpha_u == alpha_v {
            mirror.float("alpha", alpha_u)
        } else {
            mirror.float("alpha_u", alpha_u).float("alpha_v", alpha_v)
        };
        Ok(Element::plugin("bsdf", "blendbsdf")
            .float("weight", weight)
            .child(Element::plugin("bsdf", "diffuse").child(diffuse))
            .child(mirror.child(specular)))
    }

    /// `input` / `weight`, at most 1.
    pub fn share(
        &mut self,
        name: &str,
        input: &ColorInput,
        weight: f64,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        match input {
            ColorInput::Color(color) => {
                let rgb = self.rgb(color, Reflectance, origin);
                Ok(rgb_element(name, rgb.map(|v| (v / weight).clamp(0.0, 1.0))))
            }
            ColorInput::Texture(id) => self.scaled_texture(name, *id, 1.0 / weight),
        }
    }

    pub fn diffuse_transmission(
        &mut self,
        reflectance: &ColorInput,
        transmittance: &ColorInput,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        let constant = |w: &mut Self, input: &ColorInput| match input {
            ColorInput::Color(color) => Some(w.rgb(color, Reflectance, origin)),
            ColorInput::Texture(_) => None,
        };
        let (r, t) = (constant(self, reflectance), constant(self, transmittance));
        let thin = Element::plugin("bsdf", "principledthin");
        self.out.lose(
            origin,
            "diffuse transmission with a colour of its own",
            "`principledthin`, which has one colour and a faint gloss",
        );
        let (base, share) = match (r, t) {
            (Some(r), Some(t)) => {
                let sum: [f64; 3] = std::array::from_fn(|i| r[i] + t[i]);
                let share = luminance(t) / luminance(sum).max(1e-9);
                (rgb_element("base_color", sum.map(|v| v.clamp(0.0, 1.0))), share)
            }
            _ => {
                let input = if r.is_none() { reflectance } else { transmittance };
                let base = self.color_input("base_color", input, Reflectance, None, origin)?;
                (base.unwrap_or_else(|| rgb_element("base_color", [0.5; 3])), 0.5)
            }
        };
        Ok(thin.child(base).float("roughness", 1.0).float("eta", 1.01).float("diff_trans", 2.0 * share))
    }
}

pub(super) fn diffuse(gray: f64) -> Element {
    Element::plugin("bsdf", "diffuse").float("reflectance", gray)
}
