//! Metals: by their index, or by their reflectance at normal incidence.

use super::Writer;
use super::material::index;
use super::text::Params;
use crate::ir::{ColorInput, ColorSlot, Conductor, ConductorMaterial, Ior, Origin};
use crate::spectrum::{conductor, luminance};
use crate::write::WriteError;

use ColorSlot::{Reflectance, Unbounded};

impl Writer<'_, '_> {
    /// The parameters of a metal; `eta` and `k` are called differently under a coat.
    pub fn metal(
        &mut self,
        p: Params,
        c: &Conductor,
        [eta, k]: [&str; 2],
        origin: Origin,
    ) -> Result<Params, WriteError> {
        let factor = &c.specular_reflectance;
        if c.material != ConductorMaterial::Mirror && !self.is_one(factor, origin) {
            if let Some(normal) = self.at_normal(&c.material, origin) {
                return self.dimmed(p, normal, factor, origin);
            }
            self.lose_factor(factor, "the specular reflectance of a metal", origin);
        }
        match &c.material {
            ConductorMaterial::Mirror => {
                self.out.lose(
                    origin,
                    "a mirror with the same reflectance at all angles",
                    "a metal with this reflectance at normal incidence",
                );
                self.color_input(p, "reflectance", factor, Reflectance, origin)
            }
            ConductorMaterial::Reflectance(reflectance) => {
                self.color_input(p, "reflectance", reflectance, Reflectance, origin)
            }
            ConductorMaterial::Named { name, ext_eta } => {
                let ext = around(ext_eta);
                let Some(metal) = conductor(name) else { return Ok(p) };
                Ok(p.rgb(eta, metal.eta.map(|v| v / ext)).rgb(k, metal.k.map(|v| v / ext)))
            }
            ConductorMaterial::EtaK { eta: e, k: kappa, ext_eta } => {
                let ext = around(ext_eta);
                let mut p = p;
                for (name, input) in [(eta, e), (k, kappa)] {
                    p = match input {
                        ColorInput::Color(color) if ext != 1.0 => {
                            let rgb = self.out.rgb(color, Unbounded, origin);
                            p.rgb(name, rgb.map(|v| v / ext))
                        }
                        input => self.color_input(p, name, input, Unbounded, origin)?,
                    };
                }
                Ok(p)
            }
        }
    }

    /// Reflectance at normal incidence, without the factor; `None` where a texture says it.
    fn at_normal(&mut self, material: &ConductorMaterial, origin: Origin) -> Option<[f64; 3]> {
        let (eta, k, ext) = match material {
            ConductorMaterial::Mirror => return Some([1.0; 3]),
            ConductorMaterial::Reflectance(ColorInput::Color(color)) => {
                return Some(self.out.rgb(color, Reflectance, origin));
            }
            ConductorMaterial::Named { name, ext_eta } => {
                let metal = conductor(name)?;
                (metal.eta, metal.k, around(ext_eta))
            }
            ConductorMaterial::EtaK { eta: ColorInput::Color(eta), k: ColorInput::Color(k), ext_eta } => {
                let [eta, k] = [eta, k].map(|color| self.out.rgb(color, Unbounded, origin));
                (eta, k, around(ext_eta))
            }
            ConductorMaterial::Reflectance(ColorInput::Texture(_)) | ConductorMaterial::EtaK { .. } => {
                return None;
            }
        };
        Some(std::array::from_fn(|c| {
            let (eta, k) = (eta[c] / ext, k[c] / ext);
            ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k)
        }))
    }

    /// pbrt has no factor. Under even light the difference is a few percent: the metal that is written tends to 1 at
    /// grazing angles, whatever the factor.
    fn dimmed(
        &mut self,
        p: Params,
        normal: [f64; 3],
        factor: &ColorInput,
        origin: Origin,
    ) -> Result<Params, WriteError> {
        self.out.lose(
            origin,
            "the specular reflectance of a metal",
            "a metal with the same reflectance at normal incidence",
        );
        match factor {
            ColorInput::Color(color) => {
                let factor = self.out.rgb(color, Unbounded, origin);
                let rgb = self.within(std::array::from_fn(|c| normal[c] * factor[c]), Reflectance, origin);
                Ok(p.rgb("reflectance", rgb))
            }
            ColorInput::Texture(id) => {
                let texture = self.scaled_texture(*id, luminance(normal), false)?;
                Ok(p.texture("reflectance", &texture))
            }
        }
    }
}

fn around(ext: &Option<Ior>) -> f64 {
    ext.as_ref().map_or(1.0, index)
}
