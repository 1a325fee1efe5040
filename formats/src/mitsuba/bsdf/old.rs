//! Models of 0.6 that Mitsuba 3 no longer has.

use super::basic::{microfacet, named};
use crate::ir::{BsdfKind, Color, ColorInput, ColorSlot, Microfacet, WardVariant};
use crate::mitsuba::object::Class;
use crate::mitsuba::props::Props;
use crate::mitsuba::reader::Reader;

pub(super) fn phong<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    Some(BsdfKind::Phong {
        exponent: reader.float_input(props, "exponent", 30.0),
        diffuse_reflectance: reader.color_input(props, "diffuse_reflectance", ColorSlot::Reflectance, 0.5),
        specular_reflectance: reader.color_input(props, "specular_reflectance", ColorSlot::Reflectance, 0.2),
    })
}

pub(super) fn ward<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let variants =
        [("ward", WardVariant::Ward), ("ward-duer", WardVariant::Duer), ("balanced", WardVariant::Balanced)];
    Some(BsdfKind::Ward {
        variant: props.choice("variant", WardVariant::Balanced, &variants),
        alpha_u: reader.float_input(props, "alpha_u", 0.1),
        alpha_v: reader.float_input(props, "alpha_v", 0.1),
        diffuse_reflectance: reader.color_input(props, "diffuse_reflectance", ColorSlot::Reflectance, 0.5),
        specular_reflectance: reader.color_input(props, "specular_reflectance", ColorSlot::Reflectance, 0.2),
    })
}

pub(super) fn coating<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    coat(reader, props, None)
}

pub(super) fn rough_coating<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let microfacet = microfacet(reader, props);
    coat(reader, props, Some(microfacet))
}

fn coat<'a>(
    reader: &mut Reader<'a>,
    props: &mut Props<'a>,
    microfacet: Option<Microfacet>,
) -> Option<BsdfKind> {
    let int_ior = props.optional_ior("int_ior").unwrap_or_else(|| named("bk7"));
    let ext_ior = props.optional_ior("ext_ior").unwrap_or_else(|| named("air"));
    let thickness = props.float("thickness", 1.0);
    let sigma_a = reader.color_input(props, "sigma_a", ColorSlot::Unbounded, 0.0);
    let specular_reflectance = reader.factor(props, "specular_reflectance");
    let Some(nested) = props.only_child(Class::Bsdf) else {
        props.needs("a nested bsdf");
        return None;
    };
    let nested = reader.bsdf(nested.index);
    Some(BsdfKind::Coating { int_ior, ext_ior, thickness, sigma_a, specular_reflectance, microfacet, nested })
}

pub(super) fn diffuse_transmitter<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let transmittance = reader.color_input(props, "transmittance", ColorSlot::Reflectance, 0.5);
    let reflectance = ColorInput::Color(Color::Gray(0.0));
    Some(BsdfKind::DiffuseTransmission { reflectance, transmittance })
}

pub(super) fn rough_diffuse<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    props.exclusive("reflectance", "diffuse_reflectance");
    let name = if props.has("diffuse_reflectance") { "diffuse_reflectance" } else { "reflectance" };
    Some(BsdfKind::RoughDiffuse {
        reflectance: reader.color_input(props, name, ColorSlot::Reflectance, 0.5),
        alpha: reader.float_input(props, "alpha", 0.2),
        fast: props.boolean("use_fast_approx", false),
    })
}
