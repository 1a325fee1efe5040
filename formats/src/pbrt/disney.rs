//! pbrt-v3's `disney`, as the principled model and lobes that add up say it.

use super::color::{Use, scaled};
use super::params::Params;
use super::reader::Reader;
use super::version3::{BLACK, factor, product};
use crate::ir::{
    Bsdf, BsdfKind, Color, ColorInput, FloatInput, Id, LobeSum, Microfacet, MixAmount, Principled,
    PrincipledIndex, RoughnessRemap, Shadowing, Texture, TextureKind,
};
use crate::spectrum::luminance;

/// How it is approximated.
pub(super) const INSTEAD: &str = "the principled model: exact but for clear coats, 0.7 % of the light, and thin sheets, \
                                  8 % at most; nothing wanders below the surface";

const NONE: FloatInput = FloatInput::Value(0.0);
const ONE: FloatInput = FloatInput::Value(1.0);

/// What pbrt-v3 reads.
struct Disney {
    color: ColorInput,
    metallic: FloatInput,
    eta: FloatInput,
    roughness: FloatInput,
    specular_tint: FloatInput,
    anisotropic: FloatInput,
    sheen: FloatInput,
    sheen_tint: FloatInput,
    clearcoat: FloatInput,
    clearcoat_gloss: FloatInput,
    spec_trans: FloatInput,
    flatness: FloatInput,
    diff_trans: FloatInput,
}

pub(super) fn disney(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let color = factor(r, p, "color", 0.5);
    let mut float = |name, default| r.float_input(p, name, default);
    let disney = Disney {
        color,
        metallic: float("metallic", 0.0),
        eta: float("eta", 1.5),
        roughness: float("roughness", 0.5),
        specular_tint: float("speculartint", 0.0),
        anisotropic: float("anisotropic", 0.0),
        sheen: float("sheen", 0.0),
        sheen_tint: float("sheentint", 0.5),
        clearcoat: float("clearcoat", 0.0),
        clearcoat_gloss: float("clearcoatgloss", 1.0),
        spec_trans: float("spectrans", 0.0),
        flatness: float("flatness", 0.0),
        diff_trans: float("difftrans", 1.0),
    };
    let wanders = r.optional_color_input(p, "scatterdistance", Use::Unbounded);
    let thin = p.boolean("thin", false);
    if !thin && wanders.is_some_and(|distance| !distance.is_black()) {
        let text = "light does not wander below the surface yet: it is scattered where it arrives";
        p.warn("scatterdistance", text);
    }
    if let FloatInput::Value(v) = disney.eta
        && v <= 0.0
    {
        p.complain("eta", format!("an index of refraction must be positive, not {v}"));
    }
    Some(if thin { sheet(r, p, &disney) } else { solid(r, p, &disney) })
}

/// Reflection is (1 − m)·dielectric + m·Schlick((1 − m)·R0 + m·colour): a blend of the two, each of which the principled
/// model has.
fn solid(r: &mut Reader<'_>, p: &mut Params, d: &Disney) -> BsdfKind {
    if d.clearcoat != NONE {
        p.warn(
            "clearcoat",
            "the clear coat falls off less towards the normal: brighter by 0.7 % of the light at most",
        );
    }
    if matches!(d.spec_trans, FloatInput::Value(t) if t > 0.0 && t < 1.0) || is_texture(&d.spec_trans) {
        p.warn("spectrans", "seen from inside, the material reflects nothing diffusely");
    }
    if d.spec_trans != NONE && d.metallic != NONE {
        p.warn("metallic", "the metallic share of the material transmits nothing");
    }
    let index = index(p, &d.eta);
    if d.metallic == NONE {
        return principled(d, NONE, d.color.clone(), index);
    }
    let metal = {
        let r0 = ((index - 1.0) / (index + 1.0)).powi(2);
        let dark = dielectric_color(p, d, r0);
        mixed(r, p, dark, &d.color, &d.metallic)
    };
    let metal = principled(d, ONE, metal, index);
    if d.metallic == ONE {
        return metal;
    }
    let plain = principled(d, NONE, d.color.clone(), index);
    BsdfKind::Blend { weight: d.metallic.clone(), first: part(r, p, plain), second: part(r, p, metal) }
}

fn principled(d: &Disney, metallic: FloatInput, base_color: ColorInput, index: f64) -> BsdfKind {
    let spec_trans = if metallic == NONE { d.spec_trans.clone() } else { NONE };
    BsdfKind::Principled(Box::new(Principled {
        base_color,
        roughness: d.roughness.clone(),
        anisotropic: d.anisotropic.clone(),
        metallic,
        // The sheen belongs to what is not transmitted.
        sheen: match (&d.sheen, &spec_trans) {
            (FloatInput::Value(sheen), FloatInput::Value(t)) => FloatInput::Value(sheen * (1.0 - t)),
            (sheen, _) => sheen.clone(),
        },
        sheen_tint: d.sheen_tint.clone(),
        spec_trans,
        index: PrincipledIndex::Eta(index),
        // Only metals are tinted, and flatness is of thin sheets.
        spec_tint: NONE,
        flatness: NONE,
        clearcoat: d.clearcoat.clone(),
        clearcoat_gloss: d.clearcoat_gloss.clone(),
    }))
}

/// A part of a blend, on both sides where it is opaque.
fn part(r: &mut Reader<'_>, p: &Params, kind: BsdfKind) -> Id<Bsdf> {
    let transmits = matches!(&kind, BsdfKind::Principled(p) if p.spec_trans != NONE);
    let mut push = |kind| r.scene.bsdfs.push(Bsdf { name: None, origin: p.origin(), kind });
    let front = push(kind);
    if transmits { front } else { push(BsdfKind::TwoSided { front, back: None }) }
}

/// Reflectance at normal incidence of what is not metal, tinted as asked.
fn dielectric_color(p: &mut Params, d: &Disney, r0: f64) -> ColorInput {
    match (&d.specular_tint, &d.color) {
        (FloatInput::Value(0.0), _) | (FloatInput::Value(_), ColorInput::Color(Color::Gray(_))) => {}
        (FloatInput::Value(tint), ColorInput::Color(Color::Rgb(rgb))) => {
            let y = luminance(*rgb);
            if y > 0.0 {
                return ColorInput::Color(Color::Rgb(rgb.map(|c| r0 * (1.0 + tint * (c / y - 1.0)))));
            }
        }
        _ => p.warn("speculartint", "a tint by a texture is left out"),
    }
    ColorInput::Color(Color::Gray(r0))
}

/// (1 − amount)·first + amount·second.
fn mixed(
    r: &mut Reader<'_>,
    p: &Params,
    first: ColorInput,
    second: &ColorInput,
    amount: &FloatInput,
) -> ColorInput {
    if *amount == ONE {
        return second.clone();
    }
    let amount = MixAmount::Input(amount.clone());
    let kind = TextureKind::Mix { first, second: second.clone(), amount };
    ColorInput::Texture(r.scene.textures.push(Texture { name: None, origin: p.origin(), kind }))
}

fn is_texture(input: &FloatInput) -> bool {
    matches!(input, FloatInput::Texture(_))
}

/// The index, which `principled` has everywhere the same and not 1.
fn index(p: &mut Params, eta: &FloatInput) -> f64 {
    match eta {
        FloatInput::Value(1.0) => 1.001,
        FloatInput::Value(v) => *v,
        FloatInput::Texture(_) => {
            p.warn("eta", "an index by a texture is not rendered: 1.5 is used");
            1.5
        }
    }
}

/// Lambertian lobes on both sides and an interface, without retro-reflection, sheen, coat and metal.
fn sheet(r: &mut Reader<'_>, p: &mut Params, d: &Disney) -> BsdfKind {
    p.warn(
        "thin",
        "a thin sheet of `disney` is Lambertian below its gloss: darker by 3 % of the light, by 8 % at roughness 1",
    );
    let left_out = [
        ("metallic", &d.metallic),
        ("sheen", &d.sheen),
        ("clearcoat", &d.clearcoat),
        ("flatness", &d.flatness),
    ];
    for (name, input) in left_out {
        if *input != NONE {
            p.warn(name, format!("`{name}` of a thin sheet is left out"));
        }
    }
    let [trans, half] =
        [("spectrans", &d.spec_trans), ("difftrans", &d.diff_trans)].map(|(name, input)| match input {
            FloatInput::Value(v) => v.clamp(0.0, 2.0),
            FloatInput::Texture(_) => {
                p.warn(name, format!("`{name}` of a thin sheet by a texture is left out"));
                if name == "difftrans" { 1.0 } else { 0.0 }
            }
        });
    let (trans, half) = (trans.min(1.0), 0.5 * half);
    let color = &d.color;
    let gray = |factor: f64| ColorInput::Color(Color::Gray(factor));
    let reflected = product(r, p, &gray((1.0 - trans) * (1.0 - half)), color);
    let transmitted = product(r, p, &gray(half), color);
    if trans > 0.0 {
        p.warn("spectrans", "what a thin sheet transmits is as rough here as what it reflects");
    }
    let through = match (trans, color) {
        (0.0, _) => BLACK,
        (_, ColorInput::Color(Color::Rgb(rgb))) => {
            ColorInput::Color(scaled(Color::Rgb(rgb.map(f64::sqrt)), trans))
        }
        (_, ColorInput::Color(Color::Gray(v))) => ColorInput::Color(Color::Gray(v.sqrt() * trans)),
        _ => {
            p.warn("color", "light that goes through twice is coloured twice");
            product(r, p, &gray(trans), color)
        }
    };
    BsdfKind::LobeSum(Box::new(LobeSum {
        diffuse_reflectance: reflected,
        diffuse_transmittance: transmitted,
        glossy_reflectance: gray(1.0),
        glossy_transmittance: through,
        specular_reflectance: BLACK,
        specular_transmittance: BLACK,
        eta: d.eta.clone(),
        microfacet: facets(r, p, d),
    }))
}

/// α = roughness², stretched by the anisotropy.
fn facets(r: &mut Reader<'_>, p: &mut Params, d: &Disney) -> Microfacet {
    let aspect = match d.anisotropic {
        FloatInput::Value(v) => (1.0 - 0.9 * v.clamp(0.0, 1.0)).sqrt(),
        FloatInput::Texture(_) => {
            p.warn("anisotropic", "`anisotropic` of a thin sheet by a texture is left out");
            1.0
        }
    };
    let mut alpha = |stretch: f64| match d.roughness {
        FloatInput::Value(v) => FloatInput::Value(v * v * stretch),
        FloatInput::Texture(id) => {
            let mut push = |value, factor| {
                let kind = TextureKind::Scale { value, factor };
                r.scene.textures.push(Texture { name: None, origin: p.origin(), kind })
            };
            let square = push(ColorInput::Texture(id), ColorInput::Texture(id));
            FloatInput::Texture(match stretch {
                1.0 => square,
                _ => push(ColorInput::Texture(square), ColorInput::Color(Color::Gray(stretch))),
            })
        }
    };
    let alpha = [alpha(1.0 / aspect), alpha(aspect)];
    Microfacet { shadowing: Shadowing::Separable, ..Microfacet::pbrt(alpha, RoughnessRemap::None) }
}
