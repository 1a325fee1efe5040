//! What scattering models are made of: boundaries, metals, microfacets and coats.

use serde::{Deserialize, Serialize};

use super::arena::Reference;
use super::table::{Part, VisitField, joined, kinds, plain, record};
use super::texture::{ColorInput, FloatInput};

/// Index of refraction: a number, or a name of `crate::spectrum::ior`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ior {
    /// Relative to vacuum.
    Value(f64),
    /// A material such as `bk7`.
    Named(String),
}

plain! { Ior }

record! {
    /// Boundary between two dielectrics.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Dielectric {
        /// Index on the side away from the normal.
        pub int_ior: Ior,
        /// Index on the side of the normal.
        pub ext_ior: Ior,
        /// Factor on what is reflected.
        pub specular_reflectance: ColorInput,
        /// Factor on what is transmitted.
        pub specular_transmittance: ColorInput,
    }
}

record! {
    /// A metal.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Conductor {
        /// Its Fresnel reflectance.
        pub material: ConductorMaterial,
        /// Factor on what is reflected.
        pub specular_reflectance: ColorInput,
    }
}

kinds! {
    /// How the Fresnel reflectance of a metal is given.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub enum ConductorMaterial {
        /// Perfect mirror (`material="none"`).
        "perfect mirror" => Mirror,
        /// Measured metal by name, divided by the index around it where the dialect has one (0.6).
        "named metal" => Named {
            /// A name of `crate::spectrum::conductor`.
            name: String,
            /// Index around the metal.
            ext_eta: Option<Ior>,
        },
        /// Complex index of refraction η + i·k.
        "metal by eta and k" => EtaK {
            /// Real part.
            eta: ColorInput,
            /// Imaginary part.
            k: ColorInput,
            /// Index around the metal.
            ext_eta: Option<Ior>,
        },
        /// η = 1 and the k that gives this reflectance at normal incidence (pbrt's `reflectance`).
        "metal by reflectance" => Reflectance(reflectance: ColorInput),
    }
}

record! {
    /// A dielectric coat over a diffuse base.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Plastic {
        /// Index of the coat.
        pub int_ior: Ior,
        /// Index outside.
        pub ext_ior: Ior,
        /// Albedo of the base.
        pub diffuse_reflectance: ColorInput,
        /// Factor on the reflection of the coat.
        pub specular_reflectance: ColorInput,
        /// Colour shift by internal scattering.
        pub nonlinear: bool,
    }
}

/// A distribution of microfacets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Microfacet {
    /// Its shape.
    pub distribution: MicrofacetDistribution,
    /// Roughness along ∂p/∂u as written; `remap` says what α is.
    pub alpha_u: FloatInput,
    /// Roughness across it.
    pub alpha_v: FloatInput,
    /// Sample visible normals only; makes less noise, and no other difference.
    pub sample_visible: bool,
    /// How facets shadow each other.
    pub shadowing: Shadowing,
    /// From the roughness as written to α.
    pub remap: RoughnessRemap,
}

impl Part for Microfacet {
    fn references(&self, visit: &mut dyn FnMut(Reference)) {
        self.alpha_u.references(visit);
        self.alpha_v.references(visit);
    }

    fn references_mut(&mut self, visit: &mut dyn FnMut(&mut Reference)) {
        self.alpha_u.references_mut(visit);
        self.alpha_v.references_mut(visit);
    }

    fn fields(&mut self, path: &str, visit: &mut VisitField<'_>) {
        if visit(path, self) {
            self.alpha_u.fields(&joined(path, "alpha_u"), visit);
            self.alpha_v.fields(&joined(path, "alpha_v"), visit);
        }
    }

    fn anisotropic(&self) -> bool {
        self.alpha_u != self.alpha_v
    }
}

impl Microfacet {
    /// pbrt's distribution, for the roughness along ∂p/∂u and across it.
    pub(crate) fn pbrt([alpha_u, alpha_v]: [FloatInput; 2], remap: RoughnessRemap) -> Self {
        Self {
            distribution: MicrofacetDistribution::Ggx,
            alpha_u,
            alpha_v,
            sample_visible: true,
            shadowing: Shadowing::HeightCorrelated,
            remap,
        }
    }

    /// Whether its roughness is zero: a smooth surface.
    pub fn is_smooth(&self) -> bool {
        self.alpha_u == FloatInput::Value(0.0) && self.alpha_v == FloatInput::Value(0.0)
    }
}

/// Smith masking and shadowing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shadowing {
    /// G1(wi)·G1(wo): Mitsuba.
    Separable,
    /// 1/(1 + Λ(wi) + Λ(wo)): pbrt.
    HeightCorrelated,
}

/// From the roughness that is written to α.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RoughnessRemap {
    /// α = roughness.
    None,
    /// α = √roughness (pbrt-v4's `remaproughness`).
    Sqrt,
    /// α by a polynomial of ln(roughness) (pbrt-v3's `remaproughness`).
    Polynomial,
}

impl RoughnessRemap {
    /// α of a roughness.
    pub fn alpha(self, roughness: f64) -> f64 {
        match self {
            Self::None => roughness,
            Self::Sqrt => roughness.max(0.0).sqrt(),
            Self::Polynomial => {
                let x = roughness.max(1e-3).ln();
                1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)))
            }
        }
    }
}

/// Shapes of microfacet distributions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MicrofacetDistribution {
    /// Beckmann and Spizzichino.
    Beckmann,
    /// Trowbridge and Reitz.
    Ggx,
    /// Mitsuba 0.6 `phong`/`as`: exponent 2/α² − 2.
    Phong,
}

record! {
    /// pbrt's layer of `coateddiffuse` and `coatedconductor`.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    pub struct Coat {
        /// Index of the layer relative to the outside.
        pub eta: Ior,
        /// Facets of its boundary.
        pub microfacet: Microfacet,
        /// In units of the mean free path of the medium inside.
        pub thickness: FloatInput,
        /// Of the medium inside the layer; black is empty.
        pub albedo: ColorInput,
        /// Asymmetry of that medium.
        pub g: FloatInput,
        /// Bounces inside the layer that pbrt follows.
        pub max_depth: u32,
        /// Random walks that pbrt averages.
        pub samples: u32,
    }
}
