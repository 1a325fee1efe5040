//! Materials that pbrt has.

use super::Writer;
use super::text::Params;
use crate::ir::{
    Bsdf, BsdfKind, Coat, Color, ColorInput, ColorSlot, Dielectric, FloatInput, Id, Ior, Microfacet,
    MicrofacetDistribution, Origin, RoughnessRemap, Shadowing,
};
use crate::spectrum::ior;
use crate::write::WriteError;

use ColorSlot::{Reflectance, Unbounded};

/// The type of a material and its parameters.
pub type Said = (&'static str, Params);

/// Prefixes of roughness: `dielectric`, and the two layers of `coatedconductor`.
const PLAIN: [&str; 3] = ["roughness", "uroughness", "vroughness"];
const INTERFACE: [&str; 3] = ["interface.roughness", "interface.uroughness", "interface.vroughness"];
const METAL: [&str; 3] = ["conductor.roughness", "conductor.uroughness", "conductor.vroughness"];

impl Writer<'_, '_> {
    /// What lies under masks around a material, and their opacity: pbrt's shapes have it.
    pub fn unmasked(&self, id: Id<Bsdf>) -> (Id<Bsdf>, Option<FloatInput>) {
        match &self.scene.bsdfs[id].kind {
            BsdfKind::Mask { opacity, nested } => (*nested, Some(opacity.clone())),
            // pbrt mixes materials only, and nothing is none.
            BsdfKind::Blend { weight, first, second } => {
                match (self.nothing(*first), self.nothing(*second)) {
                    (true, false) => (*second, Some(weight.clone())),
                    (false, true) => match weight {
                        FloatInput::Value(weight) => (*first, Some(FloatInput::Value(1.0 - weight))),
                        FloatInput::Texture(_) => (id, None),
                    },
                    _ => (id, None),
                }
            }
            BsdfKind::TwoSided { front, back: None } => match self.unmasked(*front) {
                (_, None) => (id, None),
                masked => masked,
            },
            _ => (id, None),
        }
    }

    /// Whether light passes as if nothing were there.
    pub fn nothing(&self, mut id: Id<Bsdf>) -> bool {
        loop {
            id = match self.scene.bsdfs[id].kind {
                BsdfKind::Null => return true,
                BsdfKind::Mask { nested, .. }
                | BsdfKind::BumpMap { nested, .. }
                | BsdfKind::NormalMap { nested, .. } => nested,
                BsdfKind::TwoSided { front, .. } => front,
                _ => return false,
            };
        }
    }

    /// The name of a material that is defined by then.
    pub fn material(&mut self, id: Id<Bsdf>) -> Result<String, WriteError> {
        // Nested mixes are defined first, by hand: they may be too deep for recursion.
        let mut path = vec![id];
        while let Some(&top) = path.last() {
            let parts = if self.materials.contains_key(&top) { [None; 2] } else { self.mixed(top) };
            match parts.into_iter().flatten().find(|part| !self.materials.contains_key(part)) {
                Some(part) => path.push(part),
                None => {
                    self.define_material(top)?;
                    path.pop();
                }
            }
        }
        self.define_material(id)
    }

    /// The parts of a mix.
    fn mixed(&self, id: Id<Bsdf>) -> [Option<Id<Bsdf>>; 2] {
        match self.scene.bsdfs[id].kind {
            BsdfKind::Blend { first, second, .. } => [Some(first), Some(second)],
            BsdfKind::TwoSided { front, .. } => match self.scene.bsdfs[front].kind {
                BsdfKind::Blend { first, second, .. } => [Some(first), Some(second)],
                _ => [None; 2],
            },
            _ => [None; 2],
        }
    }

    /// As [`Self::material`], when the parts of a mix are defined.
    fn define_material(&mut self, id: Id<Bsdf>) -> Result<String, WriteError> {
        if let Some(name) = self.materials.get(&id) {
            return Ok(name.clone());
        }
        let scene = self.scene;
        let Bsdf { origin, kind, name } = &scene.bsdfs[id];
        let (nested, one_sided) = match kind {
            BsdfKind::TwoSided { front, back } => {
                if back.is_some_and(|back| back != *front) {
                    self.out.lose(
                        *origin,
                        "a different material on the back",
                        "the front material on both sides",
                    );
                }
                (*front, false)
            }
            _ => (id, true),
        };
        // A mix has the sides of its parts, and lobes that add up are on both.
        let mix = matches!(scene.bsdfs[nested].kind, BsdfKind::Blend { .. } | BsdfKind::LobeSum(_));
        if one_sided && !mix && self.query.bsdf(&scene.bsdfs, nested).opaque() {
            self.out.lose(*origin, "a surface that is black on its back", "the same material on both sides");
        }
        let Bsdf { kind, .. } = &scene.bsdfs[nested];
        let (plugin, p) = self.said(kind, *origin)?;
        let name = self.free(name, "material");
        if plugin == "interface" {
            self.interfaces.insert(name.clone());
        }
        let mut text = String::new();
        self.place(&mut text, "", *origin);
        p.of_type(plugin).write(&mut text, "", "MakeNamedMaterial", &[&name]);
        self.definitions.push_str(&text);
        self.materials.insert(id, name.clone());
        Ok(name)
    }

    /// Diffuse gray.
    pub fn plain_material(&mut self, gray: f64) -> String {
        let name = format!("gray-{gray}");
        if self.taken.take(&name) {
            let p = Params::default().rgb("reflectance", [gray; 3]).of_type("diffuse");
            p.write(&mut self.definitions, "", "MakeNamedMaterial", &[&name]);
        }
        name
    }

    fn said(&mut self, kind: &BsdfKind, origin: Origin) -> Result<Said, WriteError> {
        let none = Params::default();
        Ok(match kind {
            BsdfKind::Diffuse { reflectance } => {
                ("diffuse", self.color_input(none, "reflectance", reflectance, Reflectance, origin)?)
            }
            BsdfKind::Dielectric(d) => ("dielectric", self.interface(none, d, origin)),
            BsdfKind::ThinDielectric(d) => ("thindielectric", self.interface(none, d, origin)),
            BsdfKind::RoughDielectric { interface, microfacet } => {
                let p = self.interface(none, interface, origin);
                ("dielectric", self.roughness(p, microfacet, PLAIN, origin)?)
            }
            BsdfKind::Conductor(c) => ("conductor", self.metal(none, c, ["eta", "k"], origin)?),
            BsdfKind::RoughConductor { conductor, microfacet } => {
                let p = self.metal(none, conductor, ["eta", "k"], origin)?;
                ("conductor", self.roughness(p, microfacet, PLAIN, origin)?)
            }
            BsdfKind::CoatedDiffuse { reflectance, coat } => {
                let p = self.color_input(none, "reflectance", reflectance, Reflectance, origin)?;
                let p = self.coat(p, coat, "eta", origin)?;
                ("coateddiffuse", self.roughness(p, &coat.microfacet, PLAIN, origin)?)
            }
            BsdfKind::CoatedConductor { conductor, microfacet, coat } => {
                let p = self.metal(none, conductor, ["conductor.eta", "conductor.k"], origin)?;
                let p = self.coat(p, coat, "interface.eta", origin)?;
                let p = self.roughness(p, &coat.microfacet, INTERFACE, origin)?;
                // One flag serves both.
                let same = Microfacet { remap: coat.microfacet.remap, ..microfacet.clone() };
                ("coatedconductor", self.alphas(p, &same, METAL)?)
            }
            BsdfKind::DiffuseTransmission { reflectance, transmittance } => {
                let p = self.color_input(none, "reflectance", reflectance, Reflectance, origin)?;
                let p = self.color_input(p, "transmittance", transmittance, Reflectance, origin)?;
                ("diffusetransmission", p)
            }
            BsdfKind::Null => ("interface", none),
            BsdfKind::Blend { first, second, .. } if self.nothing(*first) != self.nothing(*second) => {
                let seen = if self.nothing(*first) { *second } else { *first };
                self.out.lose(origin, "a blend with nothing inside another material", "the rest of it");
                return self.said_of(seen);
            }
            BsdfKind::Blend { first, second, .. } if self.nothing(*first) && self.nothing(*second) => {
                ("interface", none)
            }
            BsdfKind::Blend { weight, first, second } => {
                let (first, second) = (self.material(*first)?, self.material(*second)?);
                let p = none.strings("materials", &[&first, &second]);
                ("mix", self.float_input(p, "amount", weight)?)
            }
            other => return self.modelled(other, origin),
        })
    }

    /// [`Writer::said`] of a nested material.
    pub fn said_of(&mut self, id: Id<Bsdf>) -> Result<Said, WriteError> {
        let scene = self.scene;
        let Bsdf { origin, kind, .. } = &scene.bsdfs[id];
        match kind {
            BsdfKind::TwoSided { front, .. } => self.said_of(*front),
            kind => self.said(kind, *origin),
        }
    }

    fn interface(&mut self, p: Params, d: &Dielectric, origin: Origin) -> Params {
        for (what, input) in
            [("reflectance", &d.specular_reflectance), ("transmittance", &d.specular_transmittance)]
        {
            self.lose_factor(input, &format!("the specular {what} of glass"), origin);
        }
        for index in [&d.int_ior, &d.ext_ior] {
            if let Ior::Value(v) = index
                && *v <= 0.0
            {
                self.out.lose(origin, format!("the index of refraction {v}"), "1, the index of empty space");
            }
        }
        p.float("eta", index(&d.int_ior) / index(&d.ext_ior))
    }

    pub fn lose_factor(&mut self, input: &ColorInput, what: &str, origin: Origin) {
        if !self.is_one(input, origin) {
            self.out.lose(origin, what, "1: physical glass and metal");
        }
    }

    pub fn is_one(&mut self, factor: &ColorInput, origin: Origin) -> bool {
        match factor {
            ColorInput::Color(color) => self.out.rgb(color, Unbounded, origin) == [1.0; 3],
            ColorInput::Texture(_) => false,
        }
    }

    pub fn roughness(
        &mut self,
        p: Params,
        m: &Microfacet,
        names: [&str; 3],
        origin: Origin,
    ) -> Result<Params, WriteError> {
        let smooth = m.is_smooth() && m.remap != RoughnessRemap::Polynomial;
        if m.distribution != MicrofacetDistribution::Ggx && !smooth {
            self.out.lose(origin, format!("the {:?} distribution of microfacets", m.distribution), "GGX");
        }
        if m.shadowing == Shadowing::Separable && !smooth {
            self.out.lose(
                origin,
                "separable shadowing of microfacets",
                "pbrt's height-correlated shadowing, brighter by up to 8 % at grazing angles",
            );
        }
        let textured = [&m.alpha_u, &m.alpha_v].iter().any(|alpha| matches!(alpha, FloatInput::Texture(_)));
        if m.remap == RoughnessRemap::Polynomial && textured {
            self.out.lose(origin, "a roughness that alpha is a polynomial of, by a texture", "alpha itself");
        }
        let p = self.alphas(p, m, names)?;
        Ok(p.boolean_unless("remaproughness", m.remap == RoughnessRemap::Sqrt || smooth, true))
    }

    fn alphas(&mut self, p: Params, m: &Microfacet, [both, u, v]: [&str; 3]) -> Result<Params, WriteError> {
        // pbrt-v4 has no such map; `remaproughness` is off then.
        let alpha = |input: &FloatInput| match (m.remap, input) {
            (RoughnessRemap::Polynomial, FloatInput::Value(v)) => FloatInput::Value(m.remap.alpha(*v)),
            _ => input.clone(),
        };
        let m = &Microfacet { alpha_u: alpha(&m.alpha_u), alpha_v: alpha(&m.alpha_v), ..m.clone() };
        if m.alpha_u == m.alpha_v {
            return match &m.alpha_u {
                FloatInput::Value(0.0) => Ok(p),
                alpha => self.float_input(p, both, alpha),
            };
        }
        let p = self.float_input(p, u, &m.alpha_u)?;
        self.float_input(p, v, &m.alpha_v)
    }

    fn coat(&mut self, p: Params, c: &Coat, eta: &str, origin: Origin) -> Result<Params, WriteError> {
        let mut p = p.float(eta, index(&c.eta));
        if c.thickness != FloatInput::Value(0.01) {
            p = self.float_input(p, "thickness", &c.thickness)?;
        }
        if !matches!(c.albedo, ColorInput::Color(Color::Gray(0.0))) {
            p = self.color_input(p, "albedo", &c.albedo, Reflectance, origin)?;
            p = self.float_input(p, "g", &c.g)?;
        }
        if c.max_depth != 10 {
            p = p.integer("maxdepth", c.max_depth.into());
        }
        Ok(if c.samples == 1 { p } else { p.integer("nsamples", c.samples.into()) })
    }

    /// A coat of index `eta` over `reflectance`.
    pub fn coated(
        &mut self,
        reflectance: &ColorInput,
        eta: f64,
        microfacet: Option<&Microfacet>,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let p = self.color_input(Params::default(), "reflectance", reflectance, Reflectance, origin)?;
        self.coat_over(p, eta, microfacet, origin)
    }

    /// `coateddiffuse` over the reflectance that is said in `base`: a clear coat, and bounces below it to the end.
    pub fn coat_over(
        &mut self,
        base: Params,
        eta: f64,
        microfacet: Option<&Microfacet>,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let p = base.float("eta", eta).float("thickness", 1e-6).integer("maxdepth", 100);
        let p = match microfacet {
            Some(m) => self.roughness(p, m, PLAIN, origin)?,
            None => p,
        };
        Ok(("coateddiffuse", p))
    }
}

/// The number behind an index; pbrt reads 0 as 1, and no index is negative.
pub fn index(index: &Ior) -> f64 {
    match index {
        Ior::Value(v) if *v <= 0.0 => 1.0,
        Ior::Value(v) => *v,
        Ior::Named(name) => ior(name).unwrap_or(1.0),
    }
}
