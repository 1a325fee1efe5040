//! Materials of pbrt-v3 that pbrt-v4 no longer has.

use super::color::{Use, scaled};
use super::params::Params;
use super::reader::Reader;
use crate::ir::{
    BsdfFile, BsdfKind, Color, ColorInput, ColorSlot, FloatInput, LobeSum, Microfacet, RoughnessRemap,
    SpectrumRule, Texture, TextureKind,
};
use crate::spectrum::{luminance, to_linear_rgb};

pub(super) const BLACK: ColorInput = ColorInput::Color(Color::Gray(0.0));

/// Index of `translucent`.
const GLASS: FloatInput = FloatInput::Value(1.5);

/// pbrt-v3's distribution of facets.
pub(super) fn facets(p: &mut Params, alpha: [FloatInput; 2]) -> Microfacet {
    let remap =
        if p.boolean("remaproughness", true) { RoughnessRemap::Polynomial } else { RoughnessRemap::None };
    Microfacet::pbrt(alpha, remap)
}

/// A colour that scatters light. pbrt-v3 takes any; more than 1 would make light from nothing.
pub(super) fn factor(r: &mut Reader<'_>, p: &mut Params, name: &'static str, default: f64) -> ColorInput {
    let input = r.color_input(p, name, Use::Unbounded, default);
    match input {
        ColorInput::Color(Color::Rgb(rgb)) if rgb.iter().any(|c| *c > 1.0) => {
            let [red, green, blue] = rgb;
            p.warn(
                name,
                format!(
                    "`{name}` ({red}, {green}, {blue}) reflects more light than arrives: at most 1 is used"
                ),
            );
            ColorInput::Color(Color::Rgb(rgb.map(|c| c.min(1.0))))
        }
        input => input,
    }
}

/// The product of two of them.
pub(super) fn product(r: &mut Reader<'_>, p: &Params, a: &ColorInput, b: &ColorInput) -> ColorInput {
    use ColorInput::Color as Constant;
    match (a, b) {
        _ if a.is_black() || b.is_black() => BLACK,
        (Constant(Color::Gray(s)), Constant(c @ (Color::Gray(_) | Color::Rgb(_))))
        | (Constant(c @ Color::Rgb(_)), Constant(Color::Gray(s))) => Constant(scaled(c.clone(), *s)),
        (Constant(Color::Rgb(a)), Constant(Color::Rgb(b))) => {
            Constant(Color::Rgb([a[0] * b[0], a[1] * b[1], a[2] * b[2]]))
        }
        _ => {
            let kind = TextureKind::Scale { value: a.clone(), factor: b.clone() };
            ColorInput::Texture(r.scene.textures.push(Texture { name: None, origin: p.origin(), kind }))
        }
    }
}

impl Reader<'_> {
    /// The opacity of `uber`; `None` where nothing passes.
    pub fn opacity(&mut self, p: &mut Params) -> Option<FloatInput> {
        match self.optional_color_input(p, "opacity", Use::Unbounded)? {
            ColorInput::Texture(id) => Some(FloatInput::Texture(id)),
            ColorInput::Color(color) => {
                // What is not a spectrum was reported.
                let rgb = to_linear_rgb(&color, ColorSlot::Reflectance, SpectrumRule::Pbrt).ok()?;
                let opacity = luminance(rgb).clamp(0.0, 1.0);
                if rgb.iter().any(|c| (c - rgb[0]).abs() > 1e-3) {
                    let text = format!("an opacity cannot be coloured: its luminance, {opacity:.4}, is used");
                    p.warn("opacity", text);
                }
                (opacity < 1.0 - 1e-6).then_some(FloatInput::Value(opacity))
            }
        }
    }
}

pub(super) fn uber(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let index = r.float_input(p, "index", 1.5);
    let eta = r.optional_float_input(p, "eta").unwrap_or(index);
    if let FloatInput::Value(v) = eta
        && v <= 0.0
    {
        let name = if p.has("eta") { "eta" } else { "index" };
        p.complain(name, format!("an index of refraction must be positive, not {v}"));
    }
    let both = r.float_input(p, "roughness", 0.1);
    let alphas = ["uroughness", "vroughness"]
        .map(|name| r.optional_float_input(p, name).unwrap_or_else(|| both.clone()));
    Some(BsdfKind::LobeSum(Box::new(LobeSum {
        diffuse_reflectance: factor(r, p, "Kd", 0.25),
        diffuse_transmittance: BLACK,
        glossy_reflectance: factor(r, p, "Ks", 0.25),
        glossy_transmittance: BLACK,
        specular_reflectance: factor(r, p, "Kr", 0.0),
        specular_transmittance: factor(r, p, "Kt", 0.0),
        eta,
        microfacet: facets(p, alphas),
    })))
}

/// Its index is that of air seen from inside, which pbrt-v3 has in front of the surface: beyond the critical angle the
/// gloss is that of a mirror.
pub(super) fn plastic(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let alpha = r.float_input(p, "roughness", 0.1);
    Some(BsdfKind::LobeSum(Box::new(LobeSum {
        diffuse_reflectance: factor(r, p, "Kd", 0.25),
        diffuse_transmittance: BLACK,
        glossy_reflectance: factor(r, p, "Ks", 0.25),
        glossy_transmittance: BLACK,
        specular_reflectance: BLACK,
        specular_transmittance: BLACK,
        eta: FloatInput::Value(1.0 / 1.5),
        microfacet: facets(p, [alpha.clone(), alpha]),
    })))
}

/// Oren and Nayar's qualitative model, where there is a roughness.
pub(super) fn matte(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let reflectance = factor(r, p, "Kd", 0.5);
    // The standard deviation of the slopes in degrees, which is α/√2.
    let scale = std::f64::consts::SQRT_2.to_radians();
    let alpha = match r.float_input(p, "sigma", 0.0) {
        FloatInput::Value(0.0) => return Some(BsdfKind::Diffuse { reflectance }),
        FloatInput::Value(sigma) => FloatInput::Value(sigma.clamp(0.0, 90.0) * scale),
        FloatInput::Texture(id) => {
            let (value, factor) = (ColorInput::Texture(id), ColorInput::Color(Color::Gray(scale)));
            let kind = TextureKind::Scale { value, factor };
            FloatInput::Texture(r.scene.textures.push(Texture { name: None, origin: p.origin(), kind }))
        }
    };
    Some(BsdfKind::RoughDiffuse { reflectance, alpha, fast: true })
}

pub(super) fn translucent(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let [kd, ks] = ["Kd", "Ks"].map(|name| factor(r, p, name, 0.25));
    let [reflect, transmit] = ["reflect", "transmit"].map(|name| factor(r, p, name, 0.5));
    let alpha = r.float_input(p, "roughness", 0.1);
    Some(BsdfKind::LobeSum(Box::new(LobeSum {
        diffuse_reflectance: product(r, p, &reflect, &kd),
        diffuse_transmittance: product(r, p, &transmit, &kd),
        glossy_reflectance: product(r, p, &reflect, &ks),
        glossy_transmittance: product(r, p, &transmit, &ks),
        specular_reflectance: BLACK,
        specular_transmittance: BLACK,
        eta: GLASS,
        microfacet: facets(p, [alpha.clone(), alpha]),
    })))
}

pub(super) fn fourier(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let path = r.asset(p, "bsdffile", "tabulated BSDF")?;
    Some(BsdfKind::Fourier(BsdfFile { path }))
}

pub(super) fn substrate(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let alphas = ["uroughness", "vroughness"].map(|name| r.float_input(p, name, 0.1));
    Some(BsdfKind::FresnelBlend {
        diffuse_reflectance: factor(r, p, "Kd", 0.5),
        specular_reflectance: factor(r, p, "Ks", 0.5),
        microfacet: facets(p, alphas),
    })
}
