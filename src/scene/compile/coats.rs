//! Dielectric layers over other materials.

use std::sync::Arc;

use caustica_formats::ir::{self, ColorInput, ColorSlot, FloatInput};

use super::Compiler;
use crate::bsdf::microfacet::Remap;
use crate::bsdf::{
    CoatingModel, ConductorModel, DiffuseBase, DiffuseModel, Interreflection, Metal, Node, PlasticModel,
    RoughConductorModel, Roughness, RoundTrips, Walk,
};
use crate::math::Color;
use crate::texture::Param;

const BLACK: Param = Param::Constant(Color::ZERO);
const WHITE: Param = Param::Constant(Color::ONE);

/// Each coat takes twice the time of what lies below it.
const MAX_COATS: u32 = 4;

impl Compiler<'_> {
    pub(super) fn coat(
        &mut self,
        int_ior: &ir::Ior,
        ext_ior: &ir::Ior,
        thickness: f64,
        sigma_a: &ColorInput,
        specular: &ColorInput,
        microfacet: Option<&ir::Microfacet>,
        nested: ir::Id<ir::Bsdf>,
        origin: ir::Origin,
    ) -> Node {
        let eta = self.ior(int_ior, origin) / self.ior(ext_ior, origin);
        let absorption = match self.param(sigma_a, ColorSlot::Unbounded, origin) {
            Param::Constant(sigma) => Param::Constant(sigma * thickness as f32),
            Param::Texture(_) => {
                self.unsupported("a textured absorption of a coat", "a clear coat", origin);
                BLACK
            }
        };
        let specular = self.reflectance(specular, origin);
        if self.materials.coats == MAX_COATS {
            self.refuse(format!("a material under more than {MAX_COATS} coats"), origin);
            return DiffuseModel { reflectance: BLACK }.into();
        }
        self.materials.coats += 1;
        let nested = self.node(nested);
        self.materials.coats -= 1;
        let rough = microfacet.and_then(|m| self.interface_roughness(m, eta));
        let coat = Coat { eta, absorption, specular, rough, interreflection: Interreflection::None };
        self.coating(coat, nested, origin)
    }

    fn coating(&mut self, coat: Coat, nested: Node, origin: ir::Origin) -> Node {
        if nested.nature().transmits {
            self.unsupported("a coat over a material that lets light through", "the material alone", origin);
            return nested;
        }
        let Coat { eta, absorption, specular, rough, interreflection } = coat;
        let rough = rough.map(|r| (r, self.transmittance(&r, eta)));
        CoatingModel { eta, absorption, specular, rough, interreflection, nested: Box::new(nested) }.into()
    }

    /// pbrt walks randomly between coat and base. The same sum in closed form: exact for a smooth coat; a rough one lets
    /// light pass at the angles of a smooth one.
    pub(super) fn coated_diffuse(
        &mut self,
        reflectance: &ColorInput,
        coat: &ir::Coat,
        origin: ir::Origin,
    ) -> Node {
        self.empty_coat(coat, origin);
        let eta = self.ior(&coat.eta, origin);
        let diffuse = self.reflectance(reflectance, origin);
        let walk = Walk::new(self.thickness(coat, origin), coat.max_depth, eta);
        let smooth = PlasticModel { eta, diffuse, specular: WHITE, between: DiffuseBase::Walk(walk) };
        match self.interface_roughness(&coat.microfacet, eta) {
            Some(roughness) => self.rough_plastic(smooth, roughness).into(),
            None => smooth.into(),
        }
    }

    pub(super) fn coated_conductor(
        &mut self,
        conductor: &ir::Conductor,
        microfacet: &ir::Microfacet,
        coat: &ir::Coat,
        origin: ir::Origin,
    ) -> Node {
        self.empty_coat(coat, origin);
        let eta = self.ior(&coat.eta, origin);
        let ConductorModel { metal, reflectance } = self.conductor(conductor, origin);
        let metal = match metal {
            Metal::Mirror => Metal::Mirror,
            Metal::Index { eta: n, k, outside } => Metal::Index { eta: n, k, outside: outside * eta },
            Metal::Reflectance { normal, outside } => Metal::Reflectance { normal, outside: outside * eta },
        };
        let thickness = self.thickness(coat, origin);
        let rough = self.interface_roughness(&coat.microfacet, eta);
        let base = self.roughness(microfacet);
        let (nested, interreflection): (Node, _) = match self.seen_through(rough, base, eta) {
            Some(roughness) => {
                let returned = Arc::new(RoundTrips::new(&roughness, eta, thickness));
                let rough = Interreflection::Rough(roughness, returned);
                (RoughConductorModel { metal, reflectance, roughness }.into(), rough)
            }
            None => (ConductorModel { metal, reflectance }.into(), Interreflection::Mirror),
        };
        let absorption = Param::gray(thickness);
        let coat = Coat { eta, absorption, specular: WHITE, rough, interreflection };
        self.coating(coat, nested, origin)
    }

    /// The roughness of a metal below a rough interface, which bends light at slopes of its own on the way in and out: a
    /// slope m turns a ray inside by (1 − 1/η)m, and the metal's turns it by 2m. Of two normal distributions of slopes, and
    /// twice the interface's, the squares add up: α² + ((1 − 1/η)α′)²/2.
    fn seen_through(
        &mut self,
        interface: Option<Roughness>,
        metal: Option<Roughness>,
        eta: f32,
    ) -> Option<Roughness> {
        let Some(rough) = interface else { return metal };
        let share = 0.5 * (1.0 - 1.0 / eta).powi(2);
        let own = metal.map_or(Some([0.0; 2]), |metal| metal.constant());
        if let (Some(through), Some(own)) = (rough.constant(), own) {
            let alpha = |i: usize| Param::gray((own[i].powi(2) + share * through[i].powi(2)).sqrt());
            return Some(Roughness { u: alpha(0), v: alpha(1), remap: Remap::None, ..rough });
        }
        if metal.is_some() {
            return metal;
        }
        let factor = if rough.remap == Remap::Sqrt { share } else { share.sqrt() };
        let [u, v] = [rough.u, rough.v].map(|param| self.scaled(param, factor));
        Some(Roughness { u, v, ..rough })
    }

    /// In pbrt's sense: the optical thickness of a passage straight through.
    fn thickness(&mut self, coat: &ir::Coat, origin: ir::Origin) -> f32 {
        match &coat.thickness {
            FloatInput::Value(v) => v.max(0.0) as f32,
            FloatInput::Texture(_) => {
                self.unsupported("a textured thickness of a coat", "a thickness of 0.01", origin);
                0.01
            }
        }
    }

    fn empty_coat(&mut self, coat: &ir::Coat, origin: ir::Origin) {
        if self.param(&coat.albedo, ColorSlot::Reflectance, origin) != BLACK {
            self.warn("the medium inside a coat is not rendered: the coat is clear", origin);
        }
    }
}

/// What [`CoatingModel`] is made from.
struct Coat {
    eta: f32,
    absorption: Param,
    specular: Param,
    rough: Option<Roughness>,
    interreflection: Interreflection<Roughness>,
}
