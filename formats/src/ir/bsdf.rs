//! Surface scattering models with their parameters as written.

use serde::{Deserialize, Serialize};

use super::{ColorInput, FloatInput, Id, Origin};

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
    /// Normals tilted by the gradient of `scale`·`height` per unit of uv; a number is a flat surface.
    BumpMap {
        height: FloatInput,
        scale: f64,
        shading: PerturbedShading,
        nested: Id<Bsdf>,
    },
    /// n = 2c − 1 in the shading frame whose first axis lies along ∂p/∂u.
    NormalMap {
        normals: ColorInput,
        shading: PerturbedShading,
        nested: Id<Bsdf>,
    },
    /// (1 − `weight`)·first + `weight`·second.
    Blend {
        weight: FloatInput,
        first: Id<Bsdf>,
        second: Id<Bsdf>,
    },
    /// Σ weight·nested (0.6 `mixturebsdf`); weights above 1 in sum are rescaled.
    Mixture {
        parts: Vec<(f64, Id<Bsdf>)>,
    },
    Principled(Box<Principled>),
    PrincipledThin(Box<PrincipledThin>),
    /// Oren-Nayar with σ = α/√2; `fast` leaves the interreflection out.
    RoughDiffuse {
        reflectance: ColorInput,
        alpha: FloatInput,
        fast: bool,
    },
    /// Modified Phong (Lafortune and Willems 1994).
    Phong {
        exponent: FloatInput,
        diffuse_reflectance: ColorInput,
        specular_reflectance: ColorInput,
    },
    Ward {
        variant: WardVariant,
        alpha_u: FloatInput,
        alpha_v: FloatInput,
        diffuse_reflectance: ColorInput,
        specular_reflectance: ColorInput,
    },
    /// Dielectric layer over another model; `microfacet: None` is smooth (0.6 `coating`, `roughcoating`).
    Coating {
        int_ior: Ior,
        ext_ior: Ior,
        thickness: f64,
        sigma_a: ColorInput,
        specular_reflectance: ColorInput,
        microfacet: Option<Microfacet>,
        nested: Id<Bsdf>,
    },
    /// Lambertian reflection and transmission on both sides (0.6 `difftrans` reflects nothing).
    DiffuseTransmission {
        reflectance: ColorInput,
        transmittance: ColorInput,
    },
    /// pbrt: a dielectric layer over a diffuse base, with multiple scattering between them.
    CoatedDiffuse {
        reflectance: ColorInput,
        coat: Coat,
    },
    /// pbrt: a dielectric layer over a metal; its index is relative to the air outside.
    CoatedConductor {
        conductor: Conductor,
        microfacet: Microfacet,
        coat: Coat,
    },
}

/// What a bump or normal map does where the tilted normal meets the geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PerturbedShading {
    /// Mirror a tilted frame that faces away (Mitsuba 3).
    pub flip_invalid_normals: bool,
    /// Estevez et al. 2019 shadowing (Mitsuba 3).
    pub shadowing: bool,
}

/// pbrt's layer of `coateddiffuse` and `coatedconductor`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coat {
    pub eta: Ior,
    pub microfacet: Microfacet,
    pub thickness: FloatInput,
    /// Of the medium inside the layer; black is empty.
    pub albedo: ColorInput,
    pub g: FloatInput,
    pub max_depth: u32,
    pub samples: u32,
}

/// Parameters as Mitsuba 3 names them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Principled {
    pub base_color: ColorInput,
    pub roughness: FloatInput,
    pub anisotropic: FloatInput,
    pub metallic: FloatInput,
    pub spec_trans: FloatInput,
    pub index: PrincipledIndex,
    pub spec_tint: FloatInput,
    pub sheen: FloatInput,
    pub sheen_tint: FloatInput,
    pub flatness: FloatInput,
    pub clearcoat: FloatInput,
    pub clearcoat_gloss: FloatInput,
}

/// One of the two ways to give the index of `principled`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PrincipledIndex {
    Eta(f64),
    /// η = 2/(1 − √(0.08·specular)) − 1.
    Specular(f64),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrincipledThin {
    pub base_color: ColorInput,
    pub roughness: FloatInput,
    pub anisotropic: FloatInput,
    pub spec_trans: FloatInput,
    pub eta: FloatInput,
    pub spec_tint: FloatInput,
    pub sheen: FloatInput,
    pub sheen_tint: FloatInput,
    pub flatness: FloatInput,
    /// 0..2: half of it is transmitted.
    pub diff_trans: FloatInput,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum WardVariant {
    Ward,
    Duer,
    Balanced,
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
        eta: ColorInput,
        k: ColorInput,
        ext_eta: Option<Ior>,
    },
    /// η = 1 and the k that gives this reflectance at normal incidence (pbrt's `reflectance`).
    Reflectance(ColorInput),
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
    /// Roughness as written; `remap` says what α is.
    pub alpha_u: FloatInput,
    pub alpha_v: FloatInput,
    pub sample_visible: bool,
    pub shadowing: Shadowing,
    pub remap: RoughnessRemap,
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
    None,
    /// α = √roughness (pbrt's `remaproughness`).
    Sqrt,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum MicrofacetDistribution {
    Beckmann,
    Ggx,
    /// Mitsuba 0.6 `phong`/`as`: exponent 2/α² − 2.
    Phong,
}
