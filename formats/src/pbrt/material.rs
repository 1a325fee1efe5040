//! Materials. Opaque ones are two-sided in pbrt, so they are wrapped in `TwoSided`.

use std::rc::Rc;

use super::color::Use;
use super::depths::MAX_DEPTH;
use super::directive::{Directive, Param};
use super::disney;
use super::mix;
use super::older;
use super::params::Params;
use super::policy::Fault;
use super::reader::{Reader, text};
use super::state::Named;
use super::texture::upside_down;
use super::version3;
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{
    Bitmap, Bsdf, BsdfKind, Coat, Color, ColorInput, Conductor, ConductorMaterial, Dielectric, FloatInput,
    Id, Ior, Mapping, Microfacet, Origin, PerturbedShading, RoughnessRemap, Texture, TextureKind, Transform,
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
    read("mix", mix::mix),
    read("interface", |_, _| Some(BsdfKind::Null)),
    read("none", |_, _| Some(BsdfKind::Null)),
    read("", |_, _| Some(BsdfKind::Null)),
    unsupported("subsurface"),
    unsupported("hair"),
    unsupported("measured"),
    // pbrt-v3.
    read("metal", older::metal),
    read("glass", older::glass),
    read("mirror", older::mirror),
    read("matte", version3::matte),
    read("plastic", version3::plastic),
    read("uber", version3::uber),
    read("translucent", version3::translucent),
    read("substrate", version3::substrate),
    approximated("disney", disney::disney, disney::INSTEAD),
    read("fourier", version3::fourier),
    // pbrt-v2 and v1.
    approximated("shinymetal", older::shiny_metal, older::ONE_LOBE),
    approximated("brushedmetal", older::brushed_metal, older::ONE_LOBE),
    approximated("bluepaint", older::measured, older::DIFFUSE_PART),
    approximated("clay", older::measured, older::DIFFUSE_PART),
    approximated("felt", older::measured, older::DIFFUSE_PART),
    approximated("primer", older::measured, older::DIFFUSE_PART),
    approximated("skin", older::measured, older::DIFFUSE_PART),
];

const WHITE: ColorInput = ColorInput::Color(Color::Gray(1.0));
const GRAY: ColorInput = ColorInput::Color(Color::Gray(0.5));

/// pbrt does not correct normals that a map turns away.
const SHADING: PerturbedShading = PerturbedShading { flip_invalid_normals: false, shadowing: false };

impl Reader<'_> {
    /// Reads a material; with a slot, into it.
    pub fn material(&mut self, mut p: Params, slot: Option<(Id<Bsdf>, &str)>) -> Id<Bsdf> {
        let reader = self.plugin(MATERIALS, &mut p, "diffuse gray 0.5 is used");
        if matches!(p.kind.as_str(), "" | "none") && !self.policy.is_three() {
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
        let opaque = !matches!(kind, BsdfKind::Blend { .. } | BsdfKind::LobeSum(_)) && !kind.transmits();
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
        let name = if self.policy.is_three() { "bumpmap" } else { "displacement" };
        match self.optional_float_input(p, name) {
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
        let earlier = self.names.materials.get(&name).and_then(|named| named.defined);
        // What an earlier definition gave to shapes stays theirs.
        let id = if earlier.is_some() { self.empty_slot(&name, span) } else { self.slot(&name, span) };
        if self.policy.is_three() {
            Rc::make_mut(&mut self.names).material_params.insert(name.clone(), Rc::new(p.clone()));
        }
        self.material(p, Some((id, &name)));
        // Only now: a mix may not contain itself.
        if let Some(named) = Rc::make_mut(&mut self.names).materials.get_mut(&name) {
            (named.id, named.defined) = (id, Some(span));
        }
        self.redefined("material", &name, span, earlier);
    }

    /// The material called `name`; in pbrt-v4 it may be defined later, in pbrt-v3 nothing happens then.
    pub fn material_by_name(&mut self, name: &str, span: Span) -> Option<Id<Bsdf>> {
        if self.policy.is_three()
            && self.names.materials.get(name).is_none_or(|named| named.defined.is_none())
        {
            if !self.incomplete {
                let problem = self.no_material(name, span);
                self.problems.push(self.policy.judge(Fault::Mistake, problem, "the material stays as it is"));
            }
            return None;
        }
        let id = self.slot(name, span);
        if let Some(named) = Rc::make_mut(&mut self.names).materials.get_mut(name) {
            named.used.get_or_insert(span);
        }
        Some(id)
    }

    fn slot(&mut self, name: &str, span: Span) -> Id<Bsdf> {
        if let Some(named) = self.names.materials.get(name) {
            return named.id;
        }
        let id = self.empty_slot(name, span);
        let named = Named { id, defined: None, used: None };
        Rc::make_mut(&mut self.names).materials.insert(name.to_owned(), named);
        id
    }

    fn empty_slot(&mut self, name: &str, span: Span) -> Id<Bsdf> {
        let kind = BsdfKind::Diffuse { reflectance: GRAY };
        self.scene.bsdfs.push(Bsdf { name: Some(name.to_owned()), origin: Origin(Some(span)), kind })
    }

    /// The current material, or pbrt's default.
    pub fn current_material(&mut self, origin: Origin) -> Id<Bsdf> {
        self.state.material.unwrap_or_else(|| self.default_material(origin))
    }

    /// The current material of pbrt-v3 with parameters that a shape gives it.
    pub fn changed_material(&mut self, changes: Vec<Param>, origin: Origin) -> Id<Bsdf> {
        let mut p = match (&self.state.material_params, origin.0) {
            (Some(params), _) => Params::clone(params),
            (None, Some(span)) => Params::new("material", "matte", span, Vec::new(), self.common()),
            (None, None) => return self.current_material(origin),
        };
        p.change(changes);
        self.material(p, None)
    }

    pub fn default_material(&mut self, origin: Origin) -> Id<Bsdf> {
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
        let used = self.names.materials.iter().filter(|(_, named)| named.defined.is_none());
        let missing: Vec<(String, Span)> =
            used.filter_map(|(name, named)| named.used.map(|span| (name.clone(), span))).collect();
        for (name, span) in missing.into_iter().filter(|_| !self.incomplete) {
            let problem = self.no_material(&name, span);
            self.problems.push(self.policy.judge(Fault::Mistake, problem, "diffuse gray 0.5 is used"));
        }
    }

    fn no_material(&self, name: &str, span: Span) -> Diagnostic {
        let defined = self.names.materials.iter().filter(|(_, named)| named.defined.is_some());
        let problem = Diagnostic::error(format!("no material named `{name}`"), Some(span));
        problem.suggest_or(name, defined.map(|(name, _)| name.as_str()), || {
            "MakeNamedMaterial defines one".to_owned()
        })
    }

    /// `roughness`, or `uroughness` and `vroughness`, under a prefix.
    fn microfacet(&mut self, p: &mut Params, names: [&'static str; 3]) -> Microfacet {
        let roughness = self.float_input(p, names[0], 0.0);
        let alpha_u = self.optional_float_input(p, names[1]).unwrap_or_else(|| roughness.clone());
        let alpha_v = self.optional_float_input(p, names[2]).unwrap_or(roughness);
        let remap =
            if p.boolean("remaproughness", true) { RoughnessRemap::Sqrt } else { RoughnessRemap::None };
        Microfacet::pbrt([alpha_u, alpha_v], remap)
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

    pub fn metal(&mut self, p: &mut Params, eta: &'static str, k: &'static str) -> Conductor {
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
