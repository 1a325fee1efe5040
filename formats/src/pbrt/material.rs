//! Materials. Opaque ones are two-sided in pbrt, so they are wrapped in `TwoSided`.

use super::color::Use;
use super::depths::MAX_DEPTH;
use super::directive::{Directive, Param};
use super::disney;
use super::params::Params;
use super::reader::{Named, Reader, text};
use super::texture::upside_down;
use super::version3;
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{
    Bitmap, Bsdf, BsdfKind, Coat, Color, ColorInput, Conductor, ConductorMaterial, Dielectric, FloatInput,
    Id, Ior, Mapping, Microfacet, MicrofacetDistribution, Origin, Passage, PerturbedShading, RoughnessRemap,
    Shadowing, Texture, TextureKind, Transform,
};
use crate::plugin::{Plugin, approximated, read, unsupported};

type ReadMaterial = fn(&mut Reader<'_>, &mut Params) -> Option<BsdfKind>;

/// How the coated materials are approximated.
const CLOSED_FORM: &str = "closed form of the random walk: its albedo to 0.6 %";
const CLOSED_FORM_OVER_METAL: &str =
    "closed form of the random walk: its albedo to 2 %, below a rough interface to 8 %";

pub(super) const MATERIALS: &[Plugin<ReadMaterial>] = &[
    read("diffuse", diffuse),
    approximated("coateddiffuse", coated_diffuse, CLOSED_FORM),
    read("conductor", conductor),
    approximated("coatedconductor", coated_conductor, CLOSED_FORM_OVER_METAL),
    read("dielectric", dielectric),
    read("thindielectric", thin_dielectric),
    read("diffusetransmission", diffuse_transmission),
    read("mix", mix),
    read("interface", |_, _| Some(BsdfKind::Null)),
    read("none", |_, _| Some(BsdfKind::Null)),
    read("", |_, _| Some(BsdfKind::Null)),
    unsupported("subsurface"),
    unsupported("hair"),
    unsupported("measured"),
    // pbrt-v3.
    read("matte", version3::matte),
    read("plastic", version3::plastic),
    read("uber", version3::uber),
    read("translucent", version3::translucent),
    read("substrate", version3::substrate),
    approximated("disney", disney::disney, disney::INSTEAD),
    read("fourier", version3::fourier),
];

const WHITE: ColorInput = ColorInput::Color(Color::Gray(1.0));
const GRAY: ColorInput = ColorInput::Color(Color::Gray(0.5));

/// pbrt does not correct normals that a map turns away.
const SHADING: PerturbedShading = PerturbedShading { flip_invalid_normals: false, shadowing: false };

impl Reader<'_> {
    /// Reads a material; with a slot, into it.
    pub fn material(&mut self, mut p: Params, slot: Option<(Id<Bsdf>, &str)>) -> Id<Bsdf> {
        let reader = self.plugin(MATERIALS, &mut p, "diffuse gray 0.5 is used");
        if matches!(p.kind.as_str(), "" | "none") {
            let text = format!("material `{}` is an old name of `interface`", p.kind);
            p.problems.push(Diagnostic::warning(text, Some(p.span)));
        }
        let origin = p.origin();
        let kind = match reader {
            Some(reader) => reader(self, &mut p),
            None => None,
        };
        let mut kind = kind.unwrap_or(BsdfKind::Diffuse { reflectance: GRAY });
        let below = self.depths.below(&kind);
        if below > MAX_DEPTH {
            self.error(format!("materials refer to each other more than {MAX_DEPTH} deep"), p.span);
            kind = BsdfKind::Diffuse { reflectance: GRAY };
        }
        // The parts of a mix have their own sides; lobes that add up are on both.
        let opaque = !matches!(kind, BsdfKind::Blend { .. } | BsdfKind::LobeSum(_))
            && matches!(kind.passage(), Passage::Closed);
        let kind = self.perturbed(&mut p, kind);
        let kind = match if p.kind == "uber" { self.opacity(&mut p) } else { None } {
            Some(opacity) => {
                let nested = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
                BsdfKind::Mask { opacity, nested }
            }
            None => kind,
        };
        self.done(p);
        let kind = if opaque {
            let front = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
            BsdfKind::TwoSided { front, back: None }
        } else {
            kind
        };
        let id = match slot {
            Some((id, name)) => {
                self.scene.bsdfs[id] = Bsdf { name: Some(name.to_owned()), origin, kind };
                id
            }
            None => self.scene.bsdfs.push(Bsdf { name: None, origin, kind }),
        };
        self.depths.set(id, below + 1);
        id
    }

    /// Inside normal and bump maps, where the material has them.
    fn perturbed(&mut self, p: &mut Params, kind: BsdfKind) -> BsdfKind {
        let origin = p.origin();
        let normals = if p.has("normalmap") { self.asset(p, "normalmap", "normal map") } else { None };
        let kind = match normals {
            None => kind,
            Some(path) => {
                let bitmap = Bitmap::raw(path, upside_down(Mapping::Uv(Transform::IDENTITY)));
                let texture = Texture { name: None, origin, kind: TextureKind::Bitmap(bitmap) };
                let normals = ColorInput::Texture(self.scene.textures.push(texture));
                let nested = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
                BsdfKind::NormalMap { normals, shading: SHADING, nested }
            }
        };
        if matches!(p.kind.as_str(), "hair" | "mix" | "interface" | "none" | "") {
            return kind;
        }
        // A constant displacement moves the surface nowhere that can be seen.
        match self.optional_float_input(p, "displacement") {
            Some(height @ FloatInput::Texture(_)) => {
                let nested = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
                BsdfKind::BumpMap { height, scale: 1.0, shading: SHADING, nested }
            }
            _ => kind,
        }
    }

    pub fn named_material(&mut self, d: &Directive, params: Vec<Param>) {
        let (name, span) = (text(d, 0).to_owned(), d.arguments[0].span);
        let Some(p) = self.named_entity("material", d, params) else { return };
        let id = self.slot(&name, span);
        self.material(p, Some((id, &name)));
        // Only now: a mix may not contain itself.
        if let Some(named) = self.materials.get_mut(&name) {
            let earlier = named.defined.replace(span);
            self.redefined("material", &name, span, earlier);
        }
    }

    /// The material called `name`, which may be defined later.
    pub fn material_by_name(&mut self, name: &str, span: Span) -> Id<Bsdf> {
        let id = self.slot(name, span);
        if let Some(named) = self.materials.get_mut(name) {
            named.used.get_or_insert(span);
        }
        id
    }

    fn slot(&mut self, name: &str, span: Span) -> Id<Bsdf> {
        if let Some(named) = self.materials.get(name) {
            return named.id;
        }
        let kind = BsdfKind::Diffuse { reflectance: GRAY };
        let id =
            self.scene.bsdfs.push(Bsdf { name: Some(name.to_owned()), origin: Origin(Some(span)), kind });
        self.materials.insert(name.to_owned(), Named { id, defined: None, used: None });
        id
    }

    /// The current material, or pbrt's default.
    pub fn current_material(&mut self, origin: Origin) -> Id<Bsdf> {
        if let Some(id) = self.state.material {
            return id;
        }
        if let Some(id) = self.default_material {
            return id;
        }
        let kind = BsdfKind::Diffuse { reflectance: GRAY };
        let front = self.scene.bsdfs.push(Bsdf { name: None, origin, kind });
        let id = self.scene.bsdfs.push(Bsdf {
            name: None,
            origin,
            kind: BsdfKind::TwoSided { front, back: None },
        });
        self.default_material = Some(id);
        id
    }

    /// Reports names that were used and never defined.
    pub fn check_materials(&mut self) {
        let missing: Vec<(String, Span)> = self
            .materials
            .iter()
            .filter_map(|(name, named)| {
                named.used.filter(|_| named.defined.is_none()).map(|span| (name.clone(), span))
            })
            .collect();
        for (name, span) in missing {
            let defined = self.materials.iter().filter(|(_, named)| named.defined.is_some());
            let problem = Diagnostic::error(format!("no material named `{name}`"), Some(span));
            self.problems.push(problem.suggest_or(&name, defined.map(|(name, _)| name.as_str()), || {
                "MakeNamedMaterial defines one".to_owned()
            }));
        }
    }

    /// `roughness`, or `uroughness` and `vroughness`, under a prefix.
    fn microfacet(&mut self, p: &mut Params, names: [&'static str; 3]) -> Microfacet {
        let roughness = self.float_input(p, names[0], 0.0);
        let alpha_u = self.optional_float_input(p, names[1]).unwrap_or_else(|| roughness.clone());
        let alpha_v = self.optional_float_input(p, names[2]).unwrap_or(roughness);
        let remap =
            if p.boolean("remaproughness", true) { RoughnessRemap::Sqrt } else { RoughnessRemap::None };
        Microfacet {
            distribution: MicrofacetDistribution::Ggx,
            alpha_u,
            alpha_v,
            sample_visible: true,
            shadowing: Shadowing::HeightCorrelated,
            remap,
        }
    }

    fn coat(&mut self, p: &mut Params, microfacet: Microfacet, eta: &'static str) -> Coat {
        Coat {
            eta: self.index(p, eta),
            microfacet,
            thickness: self.float_input(p, "thickness", 0.01),
            albedo: self.color_input(p, "albedo", Use::Albedo, 0.0),
            g: self.float_input(p, "g", 0.0),
            max_depth: p.count("maxdepth", 10, 1),
            samples: p.count("nsamples", 1, 1),
        }
    }

    fn metal(&mut self, p: &mut Params, eta: &'static str, k: &'static str) -> Conductor {
        let reflectance = self.optional_color_input(p, "reflectance", Use::Albedo);
        if reflectance.is_some()
            && let Some(other) = [eta, k].into_iter().find(|name| p.has(name))
        {
            p.complain(
                other,
                format!("a conductor takes either `reflectance` or `{eta}` and `{k}`, not both"),
            );
        }
        let copper = |part: &str| ColorInput::Color(Color::Library(format!("metal-Cu-{part}")));
        let eta = self.optional_color_input(p, eta, Use::Unbounded).unwrap_or_else(|| copper("eta"));
        let k = self.optional_color_input(p, k, Use::Unbounded).unwrap_or_else(|| copper("k"));
        let material = match reflectance {
            Some(reflectance) => ConductorMaterial::Reflectance(reflectance),
            None => ConductorMaterial::EtaK { eta, k, ext_eta: None },
        };
        Conductor { material, specular_reflectance: WHITE }
    }
}

const ROUGHNESS: [&str; 3] = ["roughness", "uroughness", "vroughness"];
const INTERFACE: [&str; 3] = ["interface.roughness", "interface.uroughness", "interface.vroughness"];
const CONDUCTOR: [&str; 3] = ["conductor.roughness", "conductor.uroughness", "conductor.vroughness"];

fn diffuse(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    Some(BsdfKind::Diffuse { reflectance: r.color_input(p, "reflectance", Use::Albedo, 0.5) })
}

fn coated_diffuse(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let reflectance = r.color_input(p, "reflectance", Use::Albedo, 0.5);
    let microfacet = r.microfacet(p, ROUGHNESS);
    Some(BsdfKind::CoatedDiffuse { reflectance, coat: r.coat(p, microfacet, "eta") })
}

fn conductor(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let conductor = r.metal(p, "eta", "k");
    let microfacet = r.microfacet(p, ROUGHNESS);
    Some(if microfacet.is_smooth() {
        BsdfKind::Conductor(conductor)
    } else {
        BsdfKind::RoughConductor { conductor, microfacet }
    })
}

fn coated_conductor(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let conductor = r.metal(p, "conductor.eta", "conductor.k");
    let interface = r.microfacet(p, INTERFACE);
    let microfacet = r.microfacet(p, CONDUCTOR);
    // Taken by the first of the two.
    let microfacet = Microfacet { remap: interface.remap, ..microfacet };
    Some(BsdfKind::CoatedConductor { conductor, microfacet, coat: r.coat(p, interface, "interface.eta") })
}

fn interface(int_ior: Ior) -> Dielectric {
    Dielectric {
        int_ior,
        ext_ior: Ior::Value(1.0),
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    }
}

fn dielectric(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let interface = interface(r.index(p, "eta"));
    let microfacet = r.microfacet(p, ROUGHNESS);
    Some(if microfacet.is_smooth() {
        BsdfKind::Dielectric(interface)
    } else {
        BsdfKind::RoughDielectric { interface, microfacet }
    })
}

fn thin_dielectric(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    Some(BsdfKind::ThinDielectric(interface(r.index(p, "eta"))))
}

fn diffuse_transmission(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let scale = p.float("scale", 1.0);
    let mut side = |name| {
        let input = r.color_input(p, name, Use::Albedo, 0.25);
        if scale == 1.0 {
            return input;
        }
        match input {
            ColorInput::Color(color) => ColorInput::Color(super::color::scaled(color, scale)),
            value @ ColorInput::Texture(_) => {
                let factor = ColorInput::Color(Color::Gray(scale));
                let kind = TextureKind::Scale { value, factor };
                ColorInput::Texture(r.scene.textures.push(Texture { name: None, origin: p.origin(), kind }))
            }
        }
    };
    Some(BsdfKind::DiffuseTransmission {
        reflectance: side("reflectance"),
        transmittance: side("transmittance"),
    })
}

fn mix(r: &mut Reader<'_>, p: &mut Params) -> Option<BsdfKind> {
    let weight = r.float_input(p, "amount", 0.5);
    let Some((names, span)) = p.string_list("materials") else {
        if !p.has("materials") {
            p.problems.push(Diagnostic::error("mix needs the parameter \"string materials\"", Some(p.span)));
        }
        return None;
    };
    let [first, second] = &names[..] else {
        p.complain("materials", format!("`materials` expects 2 names, got {}", names.len()));
        return None;
    };
    let first = r.mixed(p, first, span)?;
    let second = r.mixed(p, second, span)?;
    Some(BsdfKind::Blend { weight, first, second })
}

impl Reader<'_> {
    /// A part of a mix; it must be defined before.
    fn mixed(&mut self, p: &mut Params, name: &str, span: Span) -> Option<Id<Bsdf>> {
        if let Some(named) = self.materials.get(name).filter(|named| named.defined.is_some()) {
            return Some(named.id);
        }
        let known = self.materials.iter().filter(|(_, named)| named.defined.is_some());
        let problem = Diagnostic::error(format!("no material called `{name}` is defined above"), Some(span));
        p.problems.push(problem.suggest(name, known.map(|(name, _)| name.as_str())));
        None
    }
}
