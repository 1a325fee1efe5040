//! Disney's model as Mitsuba 3 has it.

use crate::ir::{BsdfKind, ColorSlot, FloatInput, Principled, PrincipledIndex, PrincipledThin};
use crate::mitsuba::props::Props;
use crate::mitsuba::reader::Reader;

/// Parameters of Mitsuba's importance sampling: they do not change the expected image.
const SAMPLING: [&str; 4] = [
    "diffuse_reflectance_sampling_rate",
    "main_specular_sampling_rate",
    "clearcoat_sampling_rate",
    "diffuse_transmittance_sampling_rate",
];

pub(super) fn principled<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    props.ignore(&SAMPLING);
    props.exclusive("eta", "specular");
    let (eta, specular) = (props.optional_float("eta"), props.optional_float("specular"));
    let index = match eta {
        // An index of 1 would neither reflect nor refract; Mitsuba moves it slightly, as it does a specular of 0.
        Some(eta) => PrincipledIndex::Eta(if eta == 1.0 { 1.001 } else { eta }),
        None => PrincipledIndex::Specular(specular.map_or(0.5, |s| if s == 0.0 { 1e-3 } else { s })),
    };
    if eta.is_some_and(|eta| eta <= 0.0) {
        props.complain("eta", "an index of refraction must be positive");
    }
    if specular.is_some_and(|s| !(0.0..=12.5).contains(&s)) {
        props.complain("specular", "parameter `specular` must lie between 0 and 1");
    }
    Some(BsdfKind::Principled(Box::new(Principled {
        base_color: reader.color_input(props, "base_color", ColorSlot::Reflectance, 0.5),
        roughness: reader.float_input(props, "roughness", 0.5),
        anisotropic: reader.float_input(props, "anisotropic", 0.0),
        metallic: reader.float_input(props, "metallic", 0.0),
        spec_trans: reader.float_input(props, "spec_trans", 0.0),
        index,
        spec_tint: reader.float_input(props, "spec_tint", 0.0),
        sheen: reader.float_input(props, "sheen", 0.0),
        sheen_tint: reader.float_input(props, "sheen_tint", 0.0),
        flatness: reader.float_input(props, "flatness", 0.0),
        clearcoat: reader.float_input(props, "clearcoat", 0.0),
        clearcoat_gloss: reader.float_input(props, "clearcoat_gloss", 0.0),
    })))
}

/// The models of the teaching renderer lajolla, which reads Mitsuba's language: Disney's model and its lobes.
pub(super) fn disney<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let plugin = props.object.plugin.as_str();
    let all = plugin == "disneybsdf";
    let constant = |value: f64| FloatInput::Value(value);
    let weight = |name: &str| constant(if plugin == name { 1.0 } else { 0.0 });
    let mut number = |taken: bool, name: &'static str, default: FloatInput| {
        let given = if taken { reader.optional_float_input(props, name) } else { None };
        given.unwrap_or(default)
    };
    let rough = number(true, "roughness", constant(0.5));
    let anisotropic = number(plugin != "disneydiffuse", "anisotropic", constant(0.0));
    let flatness = number(all || plugin == "disneydiffuse", "subsurface", constant(0.0));
    let metallic = number(all, "metallic", weight("disneymetal"));
    let spec_trans = number(all, "specular_transmission", weight("disneyglass"));
    let spec_tint = number(all, "specular_tint", constant(0.0));
    let sheen = number(all, "sheen", constant(0.0));
    let sheen_tint = number(all, "sheen_tint", constant(0.5));
    let clearcoat = number(all, "clearcoat", constant(0.0));
    let clearcoat_gloss = number(all, "clearcoat_gloss", constant(1.0));
    let index = match plugin {
        // The least that `principled` can have.
        "disneydiffuse" => PrincipledIndex::Specular(1e-3),
        "disneymetal" => PrincipledIndex::Specular(0.5),
        _ => PrincipledIndex::Eta(props.positive("eta", 1.5)),
    };
    if all {
        // `principled` takes one of the two.
        props.ignore_with_warning(&["specular"], "`eta` says how much is reflected");
    }
    Some(BsdfKind::Principled(Box::new(Principled {
        base_color: reader.color_input(props, "base_color", ColorSlot::Reflectance, 0.5),
        roughness: rough,
        anisotropic,
        metallic,
        spec_trans,
        index,
        spec_tint,
        sheen,
        sheen_tint,
        flatness,
        clearcoat,
        clearcoat_gloss,
    })))
}

pub(super) fn thin<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    props.ignore(&SAMPLING);
    props.ignore(&["spec_reflect_sampling_rate", "spec_trans_sampling_rate"]);
    Some(BsdfKind::PrincipledThin(Box::new(PrincipledThin {
        base_color: reader.color_input(props, "base_color", ColorSlot::Reflectance, 0.5),
        roughness: reader.float_input(props, "roughness", 0.5),
        anisotropic: reader.float_input(props, "anisotropic", 0.0),
        spec_trans: reader.float_input(props, "spec_trans", 0.0),
        eta: reader.float_input(props, "eta", 1.5),
        spec_tint: reader.float_input(props, "spec_tint", 0.0),
        sheen: reader.float_input(props, "sheen", 0.0),
        sheen_tint: reader.float_input(props, "sheen_tint", 0.0),
        flatness: reader.float_input(props, "flatness", 0.0),
        diff_trans: reader.float_input(props, "diff_trans", 0.0),
    })))
}
