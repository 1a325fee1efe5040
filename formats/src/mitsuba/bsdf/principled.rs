//! Disney's model as Mitsuba 3 has it.

use crate::ir::{BsdfKind, ColorSlot, Principled, PrincipledIndex, PrincipledThin};
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
