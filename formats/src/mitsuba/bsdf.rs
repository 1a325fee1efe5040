//! Surface scattering models.

use super::object::{Class, ObjectIndex};
use super::plugin::{Plugin, read, unsupported};
use super::props::{Nested, Props};
use super::reader::Reader;
use super::version::Dialect;
use crate::diagnostic::{Diagnostic, nearest};
use crate::ir::{
    Bsdf, BsdfKind, Color, ColorInput, ColorSlot, Conductor, ConductorMaterial, Dielectric, Id, Ior,
    Microfacet, MicrofacetDistribution, Plastic, RoughnessRemap, Shadowing,
};
use crate::spectrum::conductor_names;

type ReadBsdf = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<BsdfKind>;

const BSDFS: &[Plugin<ReadBsdf>] = &[
    read("diffuse", diffuse),
    read("dielectric", |r, p| Some(BsdfKind::Dielectric(dielectric(r, p)))),
    read("thindielectric", |r, p| Some(BsdfKind::ThinDielectric(dielectric(r, p)))),
    read("roughdielectric", rough_dielectric),
    read("conductor", |r, p| Some(BsdfKind::Conductor(conductor(r, p)))),
    read("roughconductor", rough_conductor),
    read("plastic", |r, p| Some(BsdfKind::Plastic(plastic(r, p)))),
    read("roughplastic", rough_plastic),
    read("twosided", two_sided),
    read("mask", mask),
    read("null", |_, _| Some(BsdfKind::Null)),
    unsupported("bumpmap"),
    unsupported("normalmap"),
    unsupported("blendbsdf"),
    unsupported("principled"),
    unsupported("principledthin"),
    unsupported("hair"),
    unsupported("measured"),
    unsupported("measured_polarized"),
    unsupported("polarizer"),
    unsupported("retarder"),
    unsupported("circular"),
    unsupported("mueller"),
    unsupported("pplastic"),
    unsupported("phong"),
    unsupported("ward"),
    unsupported("coating"),
    unsupported("roughcoating"),
    unsupported("difftrans"),
    unsupported("roughdiffuse"),
    unsupported("mixturebsdf"),
    unsupported("hk"),
    unsupported("irawan"),
    unsupported("rtrans"),
];

const HALF: ColorInput = ColorInput::Color(Color::Gray(0.5));

impl<'a> Reader<'a> {
    /// The BSDF at `index`. A diffuse gray or a nested one stands for what could not be read.
    pub fn bsdf(&mut self, index: ObjectIndex) -> Id<Bsdf> {
        if let Some(id) = self.bsdfs.get(&index) {
            return *id;
        }
        let nested = {
            let mut props = self.props(index);
            props.child(Class::Bsdf)
        };
        let instead = match nested {
            Some(_) => "its nested bsdf is used",
            None => "diffuse gray 0.5 is used",
        };
        let reader = self.plugin(BSDFS, index, instead);
        let mut props = self.props(index);
        let kind = match (reader, nested) {
            (Some(reader), _) => reader(self, &mut props),
            (None, Some(nested)) => {
                let id = self.bsdf(nested.index);
                self.bsdfs.insert(index, id);
                return id;
            }
            (None, None) => {
                props.ignore_rest();
                None
            }
        };
        let kind = kind.unwrap_or(BsdfKind::Diffuse { reflectance: HALF });
        let (name, origin) = (props.name(), props.origin());
        self.finish(props);
        let id = self.scene.bsdfs.push(Bsdf { name, origin, kind });
        self.bsdfs.insert(index, id);
        id
    }

    fn factor(&mut self, props: &mut Props<'a>, name: &'static str) -> ColorInput {
        self.color_input(props, name, ColorSlot::Reflectance, 1.0)
    }
}

fn diffuse<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let reflectance = reader.color_input(props, "reflectance", ColorSlot::Reflectance, 0.5);
    // The name in 0.6; a 3.x file may not use it.
    if reader.dialect == Dialect::Old && props.has("diffuse_reflectance") {
        props.exclusive("reflectance", "diffuse_reflectance");
        let reflectance = reader.color_input(props, "diffuse_reflectance", ColorSlot::Reflectance, 0.5);
        return Some(BsdfKind::Diffuse { reflectance });
    }
    Some(BsdfKind::Diffuse { reflectance })
}

fn named(name: &str) -> Ior {
    Ior::Named(name.to_owned())
}

fn dielectric<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Dielectric {
    Dielectric {
        int_ior: props.optional_ior("int_ior").unwrap_or_else(|| named("bk7")),
        ext_ior: props.optional_ior("ext_ior").unwrap_or_else(|| named("air")),
        specular_reflectance: reader.factor(props, "specular_reflectance"),
        specular_transmittance: reader.factor(props, "specular_transmittance"),
    }
}

fn rough_dielectric<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let interface = dielectric(reader, props);
    Some(BsdfKind::RoughDielectric { interface, microfacet: microfacet(reader, props) })
}

fn microfacet<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Microfacet {
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

fn conductor<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Conductor {
    let specular_reflectance = reader.factor(props, "specular_reflectance");
    let eta = reader.optional_color(props, "eta", ColorSlot::Unbounded);
    let k = reader.optional_color(props, "k", ColorSlot::Unbounded);
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
                    let text = format!("no metal is called `{name}`");
                    let problem = Diagnostic::error(text, Some(span));
                    props.problems.push(match nearest(name, known.iter().map(String::as_str)) {
                        Some(known) => problem.help(format!("did you mean `{known}`?")),
                        None => problem.help("the usual ones: Ag, Al, Au, Cr, Cu, W; `none` is a mirror"),
                    });
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
            let (eta, k) = (eta.unwrap_or(Color::Gray(0.0)), k.unwrap_or(Color::Gray(1.0)));
            ConductorMaterial::EtaK { eta: ColorInput::Color(eta), k: ColorInput::Color(k), ext_eta }
        }
    };
    Conductor { material, specular_reflectance }
}

fn rough_conductor<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let conductor = conductor(reader, props);
    Some(BsdfKind::RoughConductor { conductor, microfacet: microfacet(reader, props) })
}

fn plastic<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Plastic {
    Plastic {
        int_ior: props.optional_ior("int_ior").unwrap_or_else(|| named("polypropylene")),
        ext_ior: props.optional_ior("ext_ior").unwrap_or_else(|| named("air")),
        diffuse_reflectance: reader.color_input(props, "diffuse_reflectance", ColorSlot::Reflectance, 0.5),
        specular_reflectance: reader.factor(props, "specular_reflectance"),
        nonlinear: props.boolean("nonlinear", false),
    }
}

fn rough_plastic<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let plastic = plastic(reader, props);
    Some(BsdfKind::RoughPlastic { plastic, microfacet: microfacet(reader, props) })
}

fn two_sided<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let allowed = props.boolean("allow_transmission", false);
    let Some(front) = props.child(Class::Bsdf) else {
        props.needs("a nested bsdf");
        return None;
    };
    let back = props.child(Class::Bsdf);
    let mut side = |nested: Nested| {
        let id = reader.bsdf(nested.index);
        if !allowed && transmits(&reader.scene.bsdfs[id].kind) {
            let text = "twosided takes only materials that let no light through";
            reader.problems.push(Diagnostic::error(text, Some(nested.span)));
        }
        id
    };
    Some(BsdfKind::TwoSided { front: side(front), back: back.map(side) })
}

fn transmits(kind: &BsdfKind) -> bool {
    matches!(
        kind,
        BsdfKind::Dielectric(_)
            | BsdfKind::ThinDielectric(_)
            | BsdfKind::RoughDielectric { .. }
            | BsdfKind::Mask { .. }
            | BsdfKind::Null
    )
}

fn mask<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<BsdfKind> {
    let opacity = reader.float_input(props, "opacity", 0.5);
    let Some(nested) = props.only_child(Class::Bsdf) else {
        props.needs("a nested bsdf");
        return None;
    };
    Some(BsdfKind::Mask { opacity, nested: reader.bsdf(nested.index) })
}
