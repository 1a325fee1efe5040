use std::sync::Arc;

use super::material::{Composite, flat};
use super::microfacet::{Microfacet, reflect};
use super::roughconductor::reflected_pdf;
use super::{
    Bxdf, DeltaLobe, Deltas, Lobe, Lobes, Nature, Node, Parameters, Point, Range, Roughness, RoundTrips,
    Scatter, Transmittance, Transport, fresnel,
};
use crate::math::{Color, Vec2, Vec3};
use crate::texture::Param;

/// A dielectric layer over other models, on both sides of the surface (Weidlich and Wilkie 2007). What
/// lies below is seen along refracted directions; nothing it does may pass to the other side.
#[derive(Clone, Debug)]
pub struct CoatingModel {
    /// Index of the coat over the index outside.
    pub eta: f32,
    /// Absorption over the thickness of the coat.
    pub absorption: Param,
    /// Factor of the coat's own reflection; 1 is physical.
    pub specular: Param,
    /// A rough surface, with its transmittance; `None` is smooth.
    pub rough: Option<(Roughness, Arc<Transmittance>)>,
    /// Exact for a smooth coat over a smooth metal.
    pub interreflection: Interreflection<Roughness>,
    /// What lies below the coat.
    pub nested: Box<Node>,
}

/// How light is thrown back and forth between the coat and a metal below it, of which `R` is the roughness.
#[derive(Clone, Debug)]
pub enum Interreflection<R> {
    /// It is not.
    None,
    /// At the angle of the light.
    Mirror,
    /// By a table for rough metal, at its roughness.
    Rough(R, Arc<RoundTrips>),
}

impl Parameters for CoatingModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        Coating {
            eta: self.eta,
            absorption: point.color(self.absorption),
            specular: point.color(self.specular),
            rough: self.rough.as_ref().map(|(r, t)| (r.at(point), t.clone())),
            interreflection: match &self.interreflection {
                Interreflection::None => Interreflection::None,
                Interreflection::Mirror => Interreflection::Mirror,
                Interreflection::Rough(r, table) => {
                    Interreflection::Rough(r.at(point).roughness(), table.clone())
                }
            },
            nested: [Vec3::Z, -Vec3::Z].map(|wi| flat(&self.nested, point, wi)),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        let rough = self.rough.iter().flat_map(|(r, _)| r.params());
        let base = match &self.interreflection {
            Interreflection::Rough(r, _) => r.params(),
            Interreflection::None | Interreflection::Mirror => Vec::new(),
        };
        rough.chain(base).chain([self.absorption, self.specular]).chain(self.nested.params()).collect()
    }

    fn varies(&self) -> bool {
        self.nested.varies() || self.params().iter().any(|p| p.constant().is_none())
    }

    fn nature(&self) -> Nature {
        let own = match &self.rough {
            Some((r, _)) => Nature { smooth: Some(r.bounds()), oriented: r.oriented(), ..Nature::default() },
            None => Nature { delta: true, ..Nature::default() },
        };
        self.nested.nature().with(own)
    }
}

/// [`super::CoatingModel`] at a point.
#[derive(Clone, Debug)]
pub struct Coating {
    eta: f32,
    absorption: Color,
    specular: Color,
    rough: Option<(Microfacet, Arc<Transmittance>)>,
    interreflection: Interreflection<f32>,
    /// Above and below.
    nested: [Composite; 2],
}

impl Coating {
    fn below(&self, wi: Vec3) -> &Composite {
        &self.nested[usize::from(wi.z < 0.0)]
    }

    /// The direction inside the coat.
    fn inside(&self, w: Vec3) -> Vec3 {
        let z = 1.0 - (1.0 - w.z * w.z) / (self.eta * self.eta);
        Vec3::new(w.x / self.eta, w.y / self.eta, z.max(0.0).sqrt().copysign(w.z))
    }

    /// Back out of the coat, where light gets out at that angle.
    fn outside(&self, w: Vec3) -> Option<Vec3> {
        let z2 = 1.0 - (1.0 - w.z * w.z) * (self.eta * self.eta);
        (z2 > 0.0).then(|| Vec3::new(w.x * self.eta, w.y * self.eta, z2.sqrt().copysign(w.z)))
    }

    /// Share that enters along `w`.
    fn transmitted(&self, w: Vec3) -> f32 {
        match &self.rough {
            Some((m, table)) => table.external(m.roughness(), w.z.abs()),
            None => 1.0 - fresnel::dielectric(w.z.abs(), self.eta).reflectance,
        }
    }

    fn absorbed(&self, inside_i: Vec3, inside_o: Vec3) -> Color {
        if self.absorption == Color::ZERO {
            return Color::ONE;
        }
        (self.absorption * -(1.0 / inside_i.z.abs() + 1.0 / inside_o.z.abs())).exp()
    }

    /// Sum of the round trips between coat and base.
    fn round_trips(&self, wi: Vec3, wo: Vec3) -> Color {
        let base = |w: Vec3| {
            let (w, below) = (self.inside(w), self.below(wi));
            let deltas: Color = below.deltas(w, Transport::Importance).iter().map(|l| l.weight).sum();
            below.albedo(w, Range::ALL) + deltas
        };
        let trips = |w: Vec3| match &self.interreflection {
            Interreflection::None => Color::ONE,
            Interreflection::Rough(alpha, table) => table.sum(*alpha, self.inside(w).z.abs(), base(w)),
            // Equal angles have equal Fresnel reflectance on both sides of the interface.
            Interreflection::Mirror => {
                let again =
                    base(w) * self.absorbed(self.inside(w), self.inside(w)) * (1.0 - self.transmitted(w));
                Color::ONE / (Color::ONE - again.min(Color::splat(0.99)))
            }
        };
        (trips(wi) + trips(wo)) * 0.5
    }

    /// What becomes of light that goes in along one and out along the other direction.
    fn passage(&self, wi: Vec3, wo: Vec3) -> Color {
        self.absorbed(self.inside(wi), self.inside(wo))
            * self.round_trips(wi, wo)
            * (self.transmitted(wi) * self.transmitted(wo))
    }

    /// Probability of choosing the coat's reflection.
    fn coat_probability(&self, wi: Vec3) -> f32 {
        let t = self.transmitted(wi);
        let w = self.specular.max_element() / (self.specular.max_element() + 1.0);
        let (s, d) = ((1.0 - t) * w, t * (1.0 - w));
        if s + d > 0.0 { s / (s + d) } else { 0.0 }
    }

    /// Smooth lobes below, in order, with where they are found there. Probabilities are joint with those
    /// of the specular directions below.
    fn nested_lobes(&self, inside: Vec3) -> impl Iterator<Item = (usize, usize, Lobe)> {
        self.below(inside).smooth_lobes(inside)
    }

    /// What the coat's rough reflection is drawn with, and the sum of all smooth lobes.
    fn weights(&self, wi: Vec3, inside: Vec3) -> (f32, f32) {
        let coat = self.coat_probability(wi);
        let nested: f32 = self.nested_lobes(inside).map(|(_, _, l)| l.probability).sum();
        let own = if self.rough.is_some() { coat } else { 0.0 };
        (own, own + (1.0 - coat) * nested)
    }

    fn rough_lobe(&self, wi: Vec3, wo: Vec3, range: Range) -> Option<(Microfacet, Vec3, Vec3)> {
        let (m, _) = self.rough.as_ref().filter(|(m, _)| range.contains(m.roughness()))?;
        let sign = 1.0f32.copysign(wi.z);
        Some((*m, wi * sign, wo * sign))
    }
}

impl Scatter for Coating {
    fn lobes(&self, wi: Vec3) -> Lobes {
        let inside = self.inside(wi);
        let (own, total) = self.weights(wi, inside);
        if total <= 0.0 {
            return Lobes::default();
        }
        // The coat's own lobe is the first, even if a smooth coat never chooses it.
        let roughness = self.rough.as_ref().map_or(0.0, |(m, _)| m.roughness());
        let mut lobes = Lobes::one(roughness);
        lobes[0].probability = own / total;
        let share = (1.0 - self.coat_probability(wi)) / total;
        for (_, _, lobe) in self.nested_lobes(inside) {
            lobes.push(Lobe { probability: lobe.probability * share, ..lobe });
        }
        lobes
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        if wi.z * wo.z <= 0.0 {
            return Color::ZERO;
        }
        let mut f = self.below(wi).eval(self.inside(wi), self.inside(wo), mode, range);
        if f != Color::ZERO {
            f *= self.passage(wi, wo) / (self.eta * self.eta);
        }
        if let Some((microfacet, wi, wo)) = self.rough_lobe(wi, wo, range) {
            let m = (wi + wo).normalize();
            let dg = microfacet.d(m) * microfacet.g(wi, wo, m);
            let reflected = fresnel::dielectric(wi.dot(m), self.eta).reflectance;
            f += self.specular * (reflected * dg / (4.0 * wi.z * wo.z));
        }
        f
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if wi.z * wo.z <= 0.0 {
            return 0.0;
        }
        let (inside_i, inside_o) = (self.inside(wi), self.inside(wo));
        let (own, total) = self.weights(wi, inside_i);
        let nested = self.below(wi).pdf(inside_i, inside_o, Transport::Radiance, range);
        // dω inside over dω outside.
        let jacobian = (wo.z / inside_o.z).abs() / (self.eta * self.eta);
        let mut pdf = (1.0 - self.coat_probability(wi)) * nested * jacobian;
        if let Some((microfacet, wi, wo)) = self.rough_lobe(wi, wo, range) {
            pdf += own * reflected_pdf(&microfacet, wi, wo);
        }
        if total > 0.0 { pdf / total } else { 0.0 }
    }

    fn draw(&self, lobe: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        if lobe == 0 {
            let (microfacet, up, _) = self.rough_lobe(wi, wi, Range::ALL)?;
            let wo = reflect(up, microfacet.sample(up, u));
            return (wo.z > 0.0).then(|| (wo * 1.0f32.copysign(wi.z), 1.0));
        }
        let inside = self.inside(wi);
        let (component, nested, _) = self.nested_lobes(inside).nth(lobe - 1)?;
        let wo = self.below(wi).draw(component, nested, inside, u_lobe, u)?.0;
        self.outside(wo).filter(|wo| wo.z * wi.z > 0.0).map(|wo| (wo, 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let t = self.transmitted(wi);
        let mut albedo = self.below(wi).albedo(self.inside(wi), range) * t;
        if self.rough_lobe(wi, wi, range).is_some() {
            albedo += self.specular * (1.0 - t);
        }
        albedo
    }

    fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        let mut deltas = Deltas::default();
        let coat = self.coat_probability(wi);
        if self.rough.is_none() {
            deltas.push(DeltaLobe {
                wo: Vec3::new(-wi.x, -wi.y, wi.z),
                weight: self.specular * fresnel::dielectric(wi.z.abs(), self.eta).reflectance,
                probability: coat,
                eta: 1.0,
                straight: false,
            });
        }
        for lobe in self.below(wi).deltas(self.inside(wi), mode).iter() {
            let probability = lobe.probability * (1.0 - coat);
            match self.outside(lobe.wo).filter(|wo| wo.z * wi.z > 0.0) {
                Some(wo) => deltas.push(DeltaLobe {
                    wo,
                    weight: lobe.weight * self.passage(wi, wo),
                    probability,
                    eta: 1.0,
                    straight: false,
                }),
                // Thrown back for good: it keeps its probability, so that all sum to one.
                None => deltas.push(DeltaLobe { weight: Color::ZERO, probability, ..*lobe }),
            }
        }
        deltas
    }
}
