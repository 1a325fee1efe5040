//! Materials of pbrt-v3 that pbrt-v4 no longer has: the closest it has, each with its loss.

use super::Writer;
use super::material::Said;
use super::text::Params;
use crate::ir::{ColorInput, ColorSlot, FloatInput, LobeSum, Microfacet, Origin};
use crate::spectrum::luminance;
use crate::write::WriteError;

use ColorSlot::Reflectance;

impl Writer<'_, '_> {
    /// `diffuse` and `diffusetransmission` are exact where there is no other lobe.
    pub fn lobe_sum(&mut self, l: &LobeSum, origin: Origin) -> Result<Said, WriteError> {
        let [gloss, mirror] = [&l.glossy_reflectance, &l.specular_reflectance].map(|input| !input.is_black());
        let [diffuse, glossy, specular] =
            [&l.diffuse_transmittance, &l.glossy_transmittance, &l.specular_transmittance]
                .map(|input| !input.is_black());
        let p = Params::default();
        let eta = match l.eta {
            FloatInput::Value(eta) => eta,
            FloatInput::Texture(_) => {
                self.out.lose(origin, "an index by a texture", "1.5");
                1.5
            }
        };
        if specular {
            self.out.lose(
                origin,
                "a sum of lobes that transmits like glass",
                "clear glass of the same index",
            );
            return Ok(("dielectric", p.float("eta", eta)));
        }
        if diffuse || glossy {
            if gloss || mirror || glossy {
                self.out.lose(origin, "the gloss of a translucent surface", "its diffuse lobes only");
            }
            let p = self.color_input(p, "reflectance", &l.diffuse_reflectance, Reflectance, origin)?;
            let p = self.color_input(p, "transmittance", &l.diffuse_transmittance, Reflectance, origin)?;
            return Ok(("diffusetransmission", p));
        }
        if !gloss && !mirror {
            return Ok((
                "diffuse",
                self.color_input(p, "reflectance", &l.diffuse_reflectance, Reflectance, origin)?,
            ));
        }
        self.out.lose(
            origin,
            "gloss that adds to a diffuse lobe",
            "`coateddiffuse` with a coat of the same index",
        );
        // pbrt-v3's plastic has the index of air seen from inside.
        let eta = if eta < 1.0 { 1.0 / eta } else { eta };
        let facets = gloss.then_some(&l.microfacet);
        self.coated(&l.diffuse_reflectance, eta, facets, origin)
    }

    /// A coat of the same reflectance at normal incidence.
    pub fn fresnel_blend(
        &mut self,
        base: &ColorInput,
        gloss: &ColorInput,
        microfacet: &Microfacet,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        self.out.lose(
            origin,
            "gloss by `fresnelblend`",
            "`coateddiffuse` with a coat of the same reflectance at normal incidence",
        );
        let normal = match gloss {
            ColorInput::Color(color) => luminance(self.out.rgb(color, Reflectance, origin)).clamp(5e-4, 0.9),
            ColorInput::Texture(_) => 0.04,
        };
        let eta = (1.0 + normal.sqrt()) / (1.0 - normal.sqrt());
        self.coated(base, eta, Some(microfacet), origin)
    }
}
