//! Models that all versions have.

use crate::diagnostic::Diagnostic;
use crate::ir::{
    BsdfKind, Color, ColorInput, ColorSlot, Conductor, ConductorMaterial, Dielectric, Ior, Microfacet,
    MicrofacetDistribution, Plastic, RoughnessRemap, Shadowing,
};
use crate::mitsuba::props::Props;
use crate::mitsuba::reader::Reader;
use crate::mitsuba::version::Dialect;
use crate::spectrum::conductor_names;

pub(super) fn diffuse<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let reflectance = reader.color_input(props, "reflectance", ColorSlot::Reflectance, 0.5);
    // The name in 0.6; a 3.x file may not use it.
    if reader.dialect == Dialect::Old && props.has("diffuse_reflectance") {
        props.exclusive("reflectance", "diffuse_reflectance");
        let reflectance = reader.color_input(props, "diffuse_reflectance", ColorSlot::Reflectance, 0.5);
        return Some(BsdfKind::Diffuse { reflectance });
    }
    Some(BsdfKind::Diffuse { reflectance })
}

pub(super) fn named(name: &str) -> Ior {
    Ior::Named(name.to_owned())
}

pub(super) fn dielectric<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Dielectric {
    Dielectric {
        int_ior: props.optional_ior("int_ior").unwrap_or_else(|| named("bk7")),
        ext_ior: props.optional_ior("ext_ior").unwrap_or_else(|| named("air")),
        specular_reflectance: reader.factor(props, "specular_reflectance"),
        specular_transmittance: reader.factor(props, "specular_transmittance"),
    }
}

pub(super) fn rough_dielectric<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let interface = dielectric(reader, props);
    Some(BsdfKind::RoughDielectric { interface, microfacet: microfacet(reader, props) })
}

pub(super) fn microfacet<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Microfacet {
    let mut names =
        vec![("beckmann", MicrofacetDistribution::Beckmann), ("ggx", MicrofacetDistribution::Ggx)];
    if reader.dialect == Dialect::Old {
        names.extend([("phong", MicrofacetDistribution::Phong), ("as", MicrofacetDistribution::Phong)]);
    }
    let distribution = props.choice("distribution", MicrofacetDistribution::Beckmann, &names);
    for name in ["alpha_u", "alpha_v"] {
        props.exclusive("alpha", name);
    }
    if props.has("alpha_u") != props.has("alpha_v") {
        let given = if props.has("alpha_u") { "alpha_u" } else { "alpha_v" };
        props.complain(given, "`alpha_u` and `alpha_v` must be given together");
    }
    let alpha = reader.float_input(props, "alpha", 0.1);
    Microfacet {
        distribution,
        alpha_u: reader.optional_float_input(props, "alpha_u").unwrap_or_else(|| alpha.clone()),
        alpha_v: reader.optional_float_input(props, "alpha_v").unwrap_or(alpha),
        sample_visible: props.boolean("sample_visible", true),
        shadowing: Shadowing::Separable,
        remap: RoughnessRemap::None,
    }
}

pub(super) fn conductor<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Conductor {
    let specular_reflectance = reader.factor(props, "specular_reflectance");
    let mut index =
        |name| props.has(name).then(|| reader.color_input(props, name, ColorSlot::Unbounded, 1.0));
    let (eta, k) = (index("eta"), index("k"));
    props.ignore(&["eta", "k"]);
    let old = reader.dialect == Dialect::Old;
    let ext_eta =
        if old { Some(props.optional_ior("ext_eta").unwrap_or_else(|| named("air"))) } else { None };
    let name = props.optional_string("material");
    let material = match (eta, k) {
        (None, None) => match name {
            None if old => ConductorMaterial::Named { name: "Cu".to_owned(), ext_eta },
            None => ConductorMaterial::Mirror,
            Some((name, _)) if name.trim().eq_ignore_ascii_case("none") => ConductorMaterial::Mirror,
            Some((name, span)) => {
                if conductor_names().all(|known| known != name) {
                    let known: Vec<String> = conductor_names().collect();
                    let text = format!("no metal named `{name}`");
                    let problem = Diagnostic::error(text, Some(span));
                    props.problems.push(problem.suggest_or(name, known.iter().map(String::as_str), || {
                        "the usual ones: Ag, Al, Au, Cr, Cu, W; `none` is a mirror".to_owned()
                    }));
                }
                ConductorMaterial::Named { name: name.to_owned(), ext_eta }
            }
        },
        (eta, k) => {
            if name.is_some_and(|(name, _)| !name.eq_ignore_ascii_case("none")) {
                props.complain("material", "a conductor takes either `material` or `eta` and `k`, not both");
            }
            let missing = if eta.is_none() { Some(("eta", 0)) } else { k.is_none().then_some(("k", 1)) };
            if let Some((name, value)) = missing.filter(|(name, _)| !props.has(name)) {
                let text = format!("the conductor's `{name}` is not given; {value} is used");
                props.problems.push(Diagnostic::warning(text, Some(props.object.span)));
            }
            let or =
                |input: Option<ColorInput>, value| input.unwrap_or(ColorInput::Color(Color::Gray(value)));
            ConductorMaterial::EtaK { eta: or(eta, 0.0), k: or(k, 1.0), ext_eta }
        }
    };
    Conductor { material, specular_reflectance }
}

pub(super) fn rough_conductor<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let conductor = conductor(reader, props);
    Some(BsdfKind::RoughConductor { conductor, microfacet: microfacet(reader, props) })
}

pub(super) fn plastic<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Plastic {
    Plastic {
        int_ior: props.optional_ior("int_ior").unwrap_or_else(|| named("polypropylene")),
        ext_ior: props.optional_ior("ext_ior").unwrap_or_else(|| named("air")),
        diffuse_reflectance: reader.color_input(props, "diffuse_reflectance", ColorSlot::Reflectance, 0.5),
        specular_reflectance: reader.factor(props, "specular_reflectance"),
        nonlinear: props.boolean("nonlinear", false),
    }
}

pub(super) fn rough_plastic<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let plastic = plastic(reader, props);
    Some(BsdfKind::RoughPlastic { plastic, microfacet: microfacet(reader, props) })
}
