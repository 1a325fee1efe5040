//! Surface scattering models with their parameters as written.

use serde::{Deserialize, Serialize};

use super::{Color, ColorInput, FloatInput, Id, Origin};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bsdf {
    pub name: Option<String>,
    pub origin: Origin,
    pub kind: BsdfKind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BsdfKind {
    Diffuse {
        reflectance: ColorInput,
    },
    Dielectric(Dielectric),
    ThinDielectric(Dielectric),
    RoughDielectric {
        interface: Dielectric,
        microfacet: Microfacet,
    },
    Conductor(Conductor),
    RoughConductor {
        conductor: Conductor,
        microfacet: Microfacet,
    },
    Plastic(Plastic),
    RoughPlastic {
        plastic: Plastic,
        microfacet: Microfacet,
    },
    /// `back: None` serves the front on both sides.
    TwoSided {
        front: Id<Bsdf>,
        back: Option<Id<Bsdf>>,
    },
    /// `opacity`·nested + (1 − `opacity`)·straight through.
    Mask {
        opacity: FloatInput,
        nested: Id<Bsdf>,
    },
    /// Index-matched boundary: light passes straight through.
    Null,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dielectric {
    /// Index on the side away from the normal.
    pub int_ior: Ior,
    /// Index on the side of the normal.
    pub ext_ior: Ior,
    pub specular_reflectance: ColorInput,
    pub specular_transmittance: ColorInput,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conductor {
    pub material: ConductorMaterial,
    pub specular_reflectance: ColorInput,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ConductorMaterial {
    /// Perfect mirror (`material="none"`).
    Mirror,
    /// Measured metal by name, divided by the index around it where the dialect has one (0.6).
    Named {
        name: String,
        ext_eta: Option<Ior>,
    },
    EtaK {
        eta: Color,
        k: Color,
        ext_eta: Option<Ior>,
    },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plastic {
    pub int_ior: Ior,
    pub ext_ior: Ior,
    pub diffuse_reflectance: ColorInput,
    pub specular_reflectance: ColorInput,
    /// Colour shift by internal scattering.
    pub nonlinear: bool,
}

/// Index of refraction: a number, or a name of `crate::spectrum::ior`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ior {
    Value(f64),
    Named(String),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Microfacet {
    pub distribution: MicrofacetDistribution,
    pub alpha_u: FloatInput,
    pub alpha_v: FloatInput,
    pub sample_visible: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MicrofacetDistribution {
    Beckmann,
    Ggx,
    /// Mitsuba 0.6 `phong`/`as`: exponent 2/α² − 2.
    Phong,
}
