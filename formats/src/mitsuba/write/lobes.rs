//! Materials of pbrt-v3 that are sums of lobes, as blends of what Mitsuba has for each lobe.

use super::Writer;
use super::element::Element;
use super::substitute::diffuse;
use crate::ir::{
    Color, ColorInput, ColorSlot, Dielectric, FloatInput, Ior, LobeSum, Microfacet, Origin, Plastic,
    RoughnessRemap,
};
use crate::spectrum::luminance;
use crate::write::WriteError;

use ColorSlot::Reflectance;

/// A pair of lobes: what is reflected and what is transmitted.
type Pair<'a> = [&'a ColorInput; 2];

impl Writer<'_, '_> {
    /// Each lobe by the plugin that has it and no other, its colour divided by its share of the blend.
    pub fn lobe_sum(&mut self, l: &LobeSum, origin: Origin) -> Result<Element, WriteError> {
        let eta = self.one_number(&l.eta, "the index of a sum of lobes", origin)?;
        let glossy = if (eta - 1.0).abs() < 1e-6 {
            None
        } else {
            Some([&l.glossy_reflectance, &l.glossy_transmittance])
        };
        let pairs: Vec<(Lobes, Pair<'_>)> = [
            (Lobes::Diffuse, Some([&l.diffuse_reflectance, &l.diffuse_transmittance])),
            (Lobes::Glossy, glossy),
            (Lobes::Specular, Some([&l.specular_reflectance, &l.specular_transmittance])),
        ]
        .into_iter()
        .filter_map(|(kind, pair)| Some((kind, pair?)))
        .filter(|(_, pair)| pair.iter().any(|input| !input.is_black()))
        .collect();
        let most: Vec<f64> = pairs.iter().map(|(kind, pair)| self.most(*kind, *pair, origin)).collect();
        let sum: f64 = most.iter().sum();
        if sum > 1.0 + 1e-6 && pairs.len() > 1 {
            self.out.lose(
                origin,
                "lobes that reflect more than 1 together",
                "a blend of them, each with what its share of the blend can hold",
            );
        }
        let mut rest: Option<(f64, Element)> = None;
        for ((kind, pair), most) in pairs.iter().zip(&most).rev() {
            let share = most / sum.max(1e-9);
            let part = match kind {
                Lobes::Diffuse => self.diffuse_pair(*pair, share, origin)?,
                Lobes::Glossy => {
                    let interface = self.interface_pair(*pair, share, eta, origin);
                    let element =
                        self.dielectric(Element::plugin("bsdf", "roughdielectric"), &interface, origin)?;
                    self.microfacet(element, &facets(&l.microfacet), origin)?
                }
                Lobes::Specular => {
                    let interface = self.interface_pair(*pair, share, eta, origin);
                    self.dielectric(Element::plugin("bsdf", "dielectric"), &interface, origin)?
                }
            };
            rest = Some(match rest {
                None => (share, part),
                Some((others, below)) => (
                    others + share,
                    Element::plugin("bsdf", "blendbsdf")
                        .float("weight", others / (others + share).max(1e-9))
                        .child(part)
                        .child(below),
                ),
            });
        }
        Ok(rest.map_or_else(|| diffuse(0.0), |(_, element)| element))
    }

    /// The most that a pair of lobes scatters of any colour. A texture is taken to stay below 1/2.
    fn most(&mut self, kind: Lobes, pair: Pair<'_>, origin: Origin) -> f64 {
        let [r, t] = pair.map(|input| match input {
            ColorInput::Color(color) => self.rgb(color, Reflectance, origin).into_iter().fold(0.0, f64::max),
            ColorInput::Texture(_) => 0.5,
        });
        // An interface shares light out between its two lobes.
        if kind == Lobes::Diffuse { r + t } else { r.max(t) }
    }

    /// A colour over a share of a blend.
    fn over(&mut self, input: &ColorInput, share: f64, origin: Origin) -> ColorInput {
        match input {
            ColorInput::Color(color) => {
                let rgb = self.rgb(color, Reflectance, origin).map(|c| (c / share).clamp(0.0, 1.0));
                ColorInput::Color(Color::Rgb(rgb))
            }
            ColorInput::Texture(_) => {
                if share < 1.0 - 1e-6 {
                    let instead = format!("the texture without it, darker by the factor {share:.4}");
                    self.out.lose(origin, "a textured lobe's factor in a blend", instead);
                }
                input.clone()
            }
        }
    }

    fn diffuse_pair(&mut self, pair: Pair<'_>, share: f64, origin: Origin) -> Result<Element, WriteError> {
        if pair[1].is_black() {
            let color = self.share("reflectance", pair[0], share, origin)?;
            let front = Element::plugin("bsdf", "diffuse").child(color);
            return Ok(Element::plugin("bsdf", "twosided").child(front));
        }
        let [r, t] = pair.map(|input| self.over(input, share, origin));
        self.diffuse_transmission(&r, &t, origin)
    }

    fn interface_pair(&mut self, pair: Pair<'_>, share: f64, eta: f64, origin: Origin) -> Dielectric {
        let [specular_reflectance, specular_transmittance] =
            pair.map(|input| self.over(input, share, origin));
        Dielectric {
            int_ior: Ior::Value(eta),
            ext_ior: Ior::Value(1.0),
            specular_reflectance,
            specular_transmittance,
        }
    }

    /// Plastic of the same reflectance at normal incidence.
    pub fn fresnel_blend(
        &mut self,
        [base, gloss]: Pair<'_>,
        microfacet: &Microfacet,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        self.out.lose(
            origin,
            "gloss by `fresnelblend`",
            "`roughplastic` of the same reflectance at normal incidence",
        );
        let rgb = match gloss {
            ColorInput::Color(color) => self.rgb(color, Reflectance, origin),
            ColorInput::Texture(id) => {
                [self.one_number(&FloatInput::Texture(*id), "the gloss of fresnelblend", origin)?; 3]
            }
        };
        let normal = luminance(rgb).clamp(5e-4, 0.9);
        let base = match base {
            ColorInput::Color(color) => {
                let base = self.rgb(color, Reflectance, origin);
                let left: [f64; 3] =
                    std::array::from_fn(|i| (base[i] * (1.0 - rgb[i]) / (1.0 - normal)).clamp(0.0, 1.0));
                ColorInput::Color(Color::Rgb(left))
            }
            texture => texture.clone(),
        };
        let plastic = Plastic {
            int_ior: Ior::Value((1.0 + normal.sqrt()) / (1.0 - normal.sqrt())),
            ext_ior: Ior::Value(1.0),
            diffuse_reflectance: base,
            specular_reflectance: ColorInput::Color(Color::Rgb(rgb.map(|c| (c / normal).min(1.0)))),
            nonlinear: false,
        };
        let microfacet = self.single_alpha(&facets(microfacet), origin)?;
        let element = self.plastic(Element::plugin("bsdf", "roughplastic"), &plastic, origin)?;
        self.microfacet(element, &microfacet, origin)
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Lobes {
    Diffuse,
    Glossy,
    Specular,
}

/// pbrt-v3's facets, of which none is quite smooth.
fn facets(m: &Microfacet) -> Microfacet {
    let rough = |alpha: &FloatInput| match (m.remap, alpha) {
        (RoughnessRemap::None, FloatInput::Value(v)) => FloatInput::Value(v.max(1e-3)),
        _ => alpha.clone(),
    };
    Microfacet { alpha_u: rough(&m.alpha_u), alpha_v: rough(&m.alpha_v), ..m.clone() }
}
