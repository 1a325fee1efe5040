//! Materials of pbrt-v3 and before that are made of what pbrt-v4 has.

use super::color::Use;
use super::params::Params;
use super::reader::Reader;
use super::version3::facets;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    BsdfKind, Color, ColorInput, Conductor, ConductorMaterial, Dielectric, FloatInput, Ior, Microfacet,
    RoughnessRemap,
};

/// How materials of pbrt-v1 that were measured are rendered.
pub(super) const DIFFUSE_PART: &str = "its diffuse part alone";
/// How two lobes of a metal are rendered.
pub(super) const ONE_LOBE: &str = "as `conductor` of its glossy colour";

/// The diffuse part of measured materials of pbrt-v1.
const MEASURED: &[(&str, [f64; 3])] = &[
    ("bluepaint", [0.3094, 0.39667, 0.70837]),
    ("clay", [0.383626, 0.260749, 0.274207]),
    ("felt", [0.025865, 0.025865, 0.025865]),
    ("primer", [0.118230, 0.121218, 0.133209]),
    ("skin", [0.428425, 0.301341, 0.331054]),
];

pub(super) fn metal(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let conductor = r.metal(p, "eta", "k");
    let both = r.float_input(p, "roughness", 0.01);
    let alpha = ["uroughness", "vroughness"]
        .map(|name| r.optional_float_input(p, name).unwrap_or_else(|| both.clone()));
    let microfacet = facets(p, alpha);
    Some(if microfacet.is_smooth() {
        BsdfKind::Conductor(conductor)
    } else {
        BsdfKind::RoughConductor { conductor, microfacet }
    })
}

/// Tinted where it reflects and where it transmits; smooth where both roughnesses are zero.
pub(super) fn glass(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let name = if p.has("eta") { "eta" } else { "index" };
    let int_ior = r.index(p, name);
    p.ignore(&["eta", "index"]);
    let interface = Dielectric {
        int_ior,
        ext_ior: Ior::Value(1.0),
        specular_reflectance: r.color_input(p, "Kr", Use::Albedo, 1.0),
        specular_transmittance: r.color_input(p, "Kt", Use::Albedo, 1.0),
    };
    let alpha = ["uroughness", "vroughness"].map(|name| r.float_input(p, name, 0.0));
    if alpha.iter().all(|a| *a == FloatInput::Value(0.0)) {
        p.ignore(&["remaproughness"]);
        return Some(BsdfKind::Dielectric(interface));
    }
    let microfacet = facets(p, alpha);
    Some(BsdfKind::RoughDielectric { interface, microfacet })
}

/// The same reflectance from all directions.
pub(super) fn mirror(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let specular_reflectance = r.color_input(p, "Kr", Use::Albedo, 0.9);
    Some(BsdfKind::Conductor(Conductor { material: ConductorMaterial::Mirror, specular_reflectance }))
}

/// pbrt-v2: a glossy lobe and a mirror on top of each other.
pub(super) fn shiny_metal(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    p.ignore(&["Kr"]);
    let roughness = p.float("roughness", 0.1).max(1e-3);
    brushed(r, p, roughness, "the mirror on top of its gloss is left out")
}

/// pbrt-v1: measured, without a diffuse part.
pub(super) fn brushed_metal(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    brushed(r, p, 0.1, "a plain metal is used for the measured one")
}

fn brushed(r: &mut Reader<'_>, p: &mut Params, roughness: f64, loss: &str) -> Option<BsdfKind> {
    let reflectance = r.color_input(p, "Ks", Use::Albedo, 1.0);
    approximate(p, loss);
    // Blinn's exponent is the inverse of the roughness, and 2/α² − 2.
    let alpha = FloatInput::Value((2.0 / (1.0 / roughness + 2.0)).sqrt());
    Some(BsdfKind::RoughConductor {
        conductor: Conductor {
            material: ConductorMaterial::Reflectance(reflectance),
            specular_reflectance: ColorInput::Color(Color::Gray(1.0)),
        },
        microfacet: Microfacet::pbrt([alpha.clone(), alpha], RoughnessRemap::None),
    })
}

/// pbrt-v1: measured and fitted by Lafortune's lobes.
pub(super) fn measured(_: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let rgb = MEASURED.iter().find(|row| row.0 == p.kind)?.1;
    approximate(p, "only its diffuse part is rendered");
    Some(BsdfKind::Diffuse { reflectance: ColorInput::Color(Color::Rgb(rgb)) })
}

fn approximate(p: &mut Params, loss: &str) {
    let text = format!("material `{}` of old versions is approximated: {loss}", p.kind);
    p.problems.push(Diagnostic::warning(text, Some(p.span)));
}
