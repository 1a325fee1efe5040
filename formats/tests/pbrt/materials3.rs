//! Materials that pbrt-v4 no longer has.

use caustica_formats::ReadOptions;
use caustica_formats::ir::{
    Bsdf, BsdfKind, Color, ColorInput, FloatInput, PrincipledIndex, RoughnessRemap, Scene, TextureKind,
};

use crate::try_read;

fn kind(scene: &Scene) -> &BsdfKind {
    &scene.bsdfs[scene.shapes[0].bsdf.unwrap()].kind
}

/// What is inside of a material that is alike on both sides.
fn inside(scene: &Scene) -> &BsdfKind {
    let BsdfKind::TwoSided { front, back: None } = kind(scene) else { panic!("{:?}", kind(scene)) };
    &scene.bsdfs[*front].kind
}

fn of(material: &str) -> Scene {
    let text = format!("WorldBegin LightSource \"infinite\" Material {material} Shape \"sphere\"");
    try_read(&text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}")).scene
}

fn gray(value: f64) -> ColorInput {
    ColorInput::Color(Color::Gray(value))
}

#[test]
fn uber_is_a_sum_of_lobes() {
    let scene = of("\"uber\" \"float vroughness\" .3 \"float index\" 1.2 \"float eta\" 1.4");
    let BsdfKind::LobeSum(l) = kind(&scene) else { panic!() };
    assert_eq!([&l.diffuse_reflectance, &l.glossy_reflectance], [&gray(0.25); 2]);
    assert_eq!([&l.specular_reflectance, &l.specular_transmittance], [&gray(0.0); 2]);
    assert_eq!(l.eta, FloatInput::Value(1.4));
    assert_eq!(
        [&l.microfacet.alpha_u, &l.microfacet.alpha_v],
        [&FloatInput::Value(0.1), &FloatInput::Value(0.3)]
    );
    assert_eq!(l.microfacet.remap, RoughnessRemap::Polynomial);
    // TrowbridgeReitzDistribution::RoughnessToAlpha of pbrt-v3, by hand: x = ln 0.1 = −2.302585.
    assert!((l.microfacet.remap.alpha(0.1) - 0.461_760).abs() < 1e-5, "{}", l.microfacet.remap.alpha(0.1));
}

#[test]
fn opacity_is_a_mask_around_it() {
    let scene = of("\"uber\" \"rgb opacity\" [.4 .4 .4]");
    let BsdfKind::Mask { opacity: FloatInput::Value(opacity), nested } = kind(&scene) else { panic!() };
    assert!((opacity - 0.4).abs() < 1e-6);
    assert!(matches!(&scene.bsdfs[*nested], Bsdf { kind: BsdfKind::LobeSum(_), .. }));
    let scene = of("\"uber\" \"rgb opacity\" [1 1 1]");
    assert!(matches!(kind(&scene), BsdfKind::LobeSum(_)));
}

#[test]
fn translucent_multiplies_its_colours() {
    let scene = of("\"translucent\" \"rgb Kd\" [.5 .5 .1] \"rgb transmit\" [.2 .4 1]");
    let BsdfKind::LobeSum(l) = kind(&scene) else { panic!() };
    let ColorInput::Color(Color::Rgb(t)) = l.diffuse_transmittance else { panic!() };
    assert!([0.1, 0.2, 0.1].iter().zip(t).all(|(a, b)| (a - b).abs() < 1e-9), "{t:?}");
    let ColorInput::Color(Color::Rgb(r)) = l.diffuse_reflectance else { panic!() };
    assert!([0.25, 0.25, 0.05].iter().zip(r).all(|(a, b)| (a - b).abs() < 1e-9), "{r:?}");
    assert_eq!(l.glossy_reflectance, gray(0.125));
    assert_eq!(l.eta, FloatInput::Value(1.5));
}

#[test]
fn substrate_plastic_and_matte() {
    let scene = of("\"substrate\" \"float vroughness\" .2 \"bool remaproughness\" false");
    let BsdfKind::FresnelBlend { diffuse_reflectance, specular_reflectance, microfacet } = inside(&scene)
    else {
        panic!()
    };
    assert_eq!([diffuse_reflectance, specular_reflectance], [&gray(0.5); 2]);
    assert_eq!(
        [&microfacet.alpha_u, &microfacet.alpha_v],
        [&FloatInput::Value(0.1), &FloatInput::Value(0.2)]
    );
    assert_eq!(microfacet.remap, RoughnessRemap::None);
    let scene = of("\"plastic\"");
    let BsdfKind::LobeSum(l) = kind(&scene) else { panic!() };
    assert_eq!(l.eta, FloatInput::Value(1.0 / 1.5));
    let scene = of("\"matte\" \"float sigma\" 90");
    let BsdfKind::RoughDiffuse { alpha: FloatInput::Value(alpha), fast: true, .. } = inside(&scene) else {
        panic!()
    };
    assert!((alpha - 2f64.sqrt() * std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let scene = of("\"matte\"");
    assert!(matches!(inside(&scene), BsdfKind::Diffuse { .. }));
}

#[test]
fn disney_is_the_principled_model() {
    let scene = of(
        "\"disney\" \"float roughness\" .3 \"float sheen\" .4 \"float speculartint\" .5 \"float flatness\" .7",
    );
    let BsdfKind::Principled(p) = inside(&scene) else { panic!() };
    assert_eq!(p.index, PrincipledIndex::Eta(1.5));
    assert_eq!([&p.roughness, &p.sheen, &p.sheen_tint], [0.3, 0.4, 0.5].map(FloatInput::Value).each_ref());
    assert_eq!([&p.metallic, &p.spec_tint, &p.flatness], [&FloatInput::Value(0.0); 3]);
    assert_eq!(p.clearcoat_gloss, FloatInput::Value(1.0));
}

/// Halfway to metal it is both, the metal darkened towards what a dielectric reflects.
#[test]
fn half_a_metal_is_a_blend() {
    let scene = of("\"disney\" \"float metallic\" .25 \"rgb color\" [.8 .5 .2]");
    let BsdfKind::Blend { weight, second, .. } = kind(&scene) else { panic!() };
    assert_eq!(*weight, FloatInput::Value(0.25));
    let BsdfKind::TwoSided { front, .. } = &scene.bsdfs[*second].kind else { panic!() };
    let BsdfKind::Principled(metal) = &scene.bsdfs[*front].kind else { panic!() };
    let ColorInput::Texture(id) = metal.base_color else { panic!() };
    let TextureKind::Mix { first: ColorInput::Color(Color::Gray(dark)), .. } = scene.textures[id].kind else {
        panic!()
    };
    assert!((dark - 0.04).abs() < 1e-12);
}
