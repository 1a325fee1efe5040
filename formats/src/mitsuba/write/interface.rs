//! What scattering models are made of: boundaries, metals, coats and microfacets.

use super::Writer;
use super::color::rgb_element;
use super::element::Element;
use crate::ir::{
    ColorInput, ColorSlot, Conductor, ConductorMaterial, Dielectric, FloatInput, Ior, Microfacet,
    MicrofacetDistribution, Origin, Plastic, RoughnessRemap, Shadowing,
};
use crate::spectrum::{conductor, ior};
use crate::write::WriteError;

use ColorSlot::{Reflectance, Unbounded};

impl Writer<'_, '_> {
    pub fn dielectric(
        &mut self,
        element: Element,
        d: &Dielectric,
        origin: Origin,
    ) -> Result<Element, WriteError> {
        self.check_indices([&d.int_ior, &d.ext_ior], origin);
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
                        .child(rgb_element("eta", metal.eta.map(|v| v / ext)))
                        .child(rgb_element("k", metal.k.map(|v| v / ext))),
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
                            Some(rgb_element(name, rgb.map(|v| v / ext)))
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
                // Kept below 1, as in pbrt: k goes to infinity there.
                let k = reflectance.map(|r| {
                    let r = r.clamp(0.0, 0.9999);
                    2.0 * (r / (1.0 - r)).sqrt()
                });
                element.child(rgb_element("eta", [1.0; 3])).child(rgb_element("k", k))
            }
            ConductorMaterial::Reflectance(ColorInput::Texture(id)) => {
                self.out.lose(
                    origin,
                    "a metal given by a textured reflectance at normal incidence",
                    "a mirror with this reflectance at all angles",
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
        self.check_indices([&p.int_ior, &p.ext_ior], origin);
        let element = index(element, "int_ior", &p.int_ior, "polypropylene");
        let element = index(element, "ext_ior", &p.ext_ior, "air");
        let (diffuse, specular) = (&p.diffuse_reflectance, &p.specular_reflectance);
        Ok(element
            .children(self.color_input("diffuse_reflectance", diffuse, Reflectance, Some(0.5), origin)?)
            .children(self.color_input("specular_reflectance", specular, Reflectance, Some(1.0), origin)?)
            .boolean_unless("nonlinear", p.nonlinear, false))
    }

    fn check_indices(&mut self, indices: [&Ior; 2], origin: Origin) {
        for index in indices {
            if let Ior::Value(v) = index
                && *v <= 0.0
            {
                self.out.lose(origin, format!("the index of refraction {v}"), "1, the index of empty space");
            }
        }
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
            (remap, FloatInput::Value(v)) => FloatInput::Value(remap.alpha(*v)),
            (remap, input) => {
                let what = match remap {
                    RoughnessRemap::Polynomial => "a roughness that alpha is a polynomial of",
                    _ => "a roughness that is the square of alpha",
                };
                FloatInput::Value(remap.alpha(self.one_number(input, what, origin)?))
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
}

/// Whether an interface between these indices lets all light pass unchanged.
pub fn same_index(inside: &Ior, outside: &Ior) -> bool {
    (value_of(inside) / value_of(outside) - 1.0).abs() < 1e-6
}

/// The number behind an index. pbrt reads 0 as 1; Mitsuba refuses what is not above 0.
fn value_of(index: &Ior) -> f64 {
    match index {
        Ior::Value(v) if *v <= 0.0 => 1.0,
        Ior::Value(v) => *v,
        Ior::Named(name) => ior(name).unwrap_or(1.0),
    }
}

fn index(element: Element, name: &str, index: &Ior, default: &str) -> Element {
    match index {
        Ior::Named(material) if material == default => element,
        Ior::Named(material) => element.string(name, material),
        Ior::Value(_) => element.float(name, value_of(index)),
    }
}
