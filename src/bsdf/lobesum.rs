use std::f32::consts::FRAC_1_PI;

use super::diffuse::cosine_pdf;
use super::microfacet::{Microfacet, reflect, refract};
use super::roughdielectric::Meeting;
use super::{
    Bxdf, DeltaLobe, Deltas, Lobe, Lobes, Nature, Parameters, Point, Range, Roughness, Scatter, Transport,
    fresnel,
};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::texture::Param;

/// Lobes that add up, as pbrt-v3's `uber` and `translucent` have them, on both sides of the surface. Each pair is what
/// is reflected and what is transmitted.
#[derive(Clone, Copy, Debug)]
pub struct LobeSumModel {
    /// Factors of the Lambertian lobes.
    pub diffuse: [Param; 2],
    /// Factors of what an interface of microfacets does.
    pub glossy: [Param; 2],
    /// Factors of what a smooth interface does.
    pub specular: [Param; 2],
    /// Index of refraction behind the normal over that before it.
    pub eta: Param,
    /// Microfacets of the glossy lobes.
    pub roughness: Roughness,
}

/// The least α that pbrt-v3 has.
pub(super) const LEAST_ALPHA: f32 = 1e-3;

/// The microfacets of a material of pbrt-v3.
pub(super) fn facets(roughness: &Roughness, point: &Point<'_>) -> Microfacet {
    let m = roughness.at(point);
    Microfacet { au: m.au.max(LEAST_ALPHA), av: m.av.max(LEAST_ALPHA), ..m }
}

impl Parameters for LobeSumModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let colors = |pair: [Param; 2]| pair.map(|p| point.color(p).max(Color::ZERO));
        LobeSum {
            diffuse: colors(self.diffuse),
            glossy: colors(self.glossy),
            specular: colors(self.specular),
            // Of a broken texture: an index that reflects nothing.
            eta: Some(point.scalar(self.eta)).filter(|eta| *eta > 0.0).unwrap_or(1.0),
            microfacet: facets(&self.roughness, point),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        let colors = [self.diffuse, self.glossy, self.specular].concat();
        [self.roughness.params(), colors, vec![self.eta]].concat()
    }

    fn nature(&self) -> Nature {
        let any = |params: &[Param]| params.iter().any(|p| *p != Param::gray(0.0));
        let mut smooth: Option<[f32; 2]> = None;
        let mut has = |bounds: [f32; 2]| {
            smooth = Some(smooth.map_or(bounds, |[a, b]| [a.min(bounds[0]), b.max(bounds[1])]));
        };
        if any(&self.diffuse) {
            has(Nature::DIFFUSE);
        }
        if any(&self.glossy[..1]) {
            has(self.roughness.bounds().map(|alpha| alpha.max(LEAST_ALPHA)));
        }
        if any(&self.glossy[1..]) {
            has([Range::FOLLOWED; 2]);
        }
        Nature {
            delta: any(&self.specular),
            smooth,
            transmits: any(&[self.diffuse[1], self.glossy[1], self.specular[1]]),
            oriented: any(&self.glossy) && self.roughness.oriented(),
            ..Nature::default()
        }
    }
}

/// [`super::LobeSumModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct LobeSum {
    diffuse: [Color; 2],
    glossy: [Color; 2],
    specular: [Color; 2],
    eta: f32,
    microfacet: Microfacet,
}

const DIFFUSE: [usize; 2] = [0, 1];
const GLOSSY: [usize; 2] = [2, 3];

/// Facets reflect and transmit at least so much on average, for the choice of lobes: they are tilted.
const LEAST: f32 = 0.1;

/// Index of a pair: reflected or transmitted.
fn across(wi: Vec3, wo: Vec3) -> usize {
    usize::from(wi.z * wo.z < 0.0)
}

impl LobeSum {
    /// Probabilities of the lobes for light handled along `wi`: the smooth ones by number, and the specular ones.
    fn probabilities(&self, wi: Vec3) -> ([f32; 4], [f32; 2]) {
        let most = |pair: [Color; 2]| pair.map(Color::max_element);
        let r = fresnel::dielectric(wi.z, self.eta).reflectance;
        let (d, g, s) = (most(self.diffuse), most(self.glossy), most(self.specular));
        let smooth = [d[0], d[1], g[0] * r.max(LEAST), g[1] * (1.0 - r).max(LEAST)];
        let specular = [s[0] * r, s[1] * (1.0 - r)];
        let sum = smooth.iter().chain(&specular).sum::<f32>();
        let share = |x: f32| if sum > 0.0 { x / sum } else { 0.0 };
        (smooth.map(share), specular.map(share))
    }

    fn roughness(&self, lobe: usize) -> f32 {
        match lobe {
            0 | 1 => Range::DIFFUSE,
            2 => self.microfacet.roughness(),
            _ => Range::FOLLOWED,
        }
    }

    /// Whether the interface of facets is asked, for directions on one or on two sides.
    fn asks_facets(&self, side: usize, range: Range) -> bool {
        range.contains(self.roughness(GLOSSY[side])) && self.glossy[side] != Color::ZERO
    }
}

impl Scatter for LobeSum {
    fn lobes(&self, wi: Vec3) -> Lobes {
        let (smooth, _) = self.probabilities(wi);
        let sum: f32 = smooth.iter().sum();
        if sum <= 0.0 {
            return Lobes::default();
        }
        let lobe = |i: usize| Lobe { probability: smooth[i] / sum, roughness: self.roughness(i) };
        Lobes::from([0, 1, 2, 3].map(lobe))
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        let side = across(wi, wo);
        let mut f = Color::ZERO;
        if range.diffuse() {
            f += self.diffuse[side] * FRAC_1_PI;
        }
        if self.asks_facets(side, range)
            && let Some(m) = Meeting::new(wi, wo, self.eta)
        {
            let share = if m.reflected { m.fresnel } else { 1.0 - m.fresnel };
            f += self.glossy[side] * (share * m.f(&self.microfacet, wi, wo, mode));
        }
        f
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let (side, lobes) = (across(wi, wo), self.lobes(wi));
        let mut pdf = 0.0;
        if lobes.iter().next().is_none() {
            return pdf;
        }
        if range.diffuse() {
            pdf += lobes[DIFFUSE[side]].probability * cosine_pdf(wo.abs());
        }
        if self.asks_facets(side, range)
            && let Some(m) = Meeting::new(wi, wo, self.eta)
        {
            pdf += lobes[GLOSSY[side]].probability * m.pdf(&self.microfacet, wi);
        }
        pdf
    }

    fn draw(&self, lobe: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let own = 1.0f32.copysign(wi.z);
        if lobe < GLOSSY[0] {
            let w = warp::cosine_hemisphere(u);
            let side = if lobe == DIFFUSE[0] { own } else { -own };
            return (w.z > 0.0).then(|| (Vec3::new(w.x, w.y, w.z * side), 1.0));
        }
        let m = self.microfacet.sample(wi * own, u);
        if lobe == GLOSSY[0] {
            let wo = reflect(wi, m);
            return (wi.z * wo.z > 0.0).then_some((wo, 1.0));
        }
        let f = fresnel::dielectric(wi.dot(m), self.eta);
        let wo = refract(wi, m, f.cos_t, f.eta);
        (f.reflectance < 1.0 && wi.z * wo.z < 0.0).then_some((wo, f.eta))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let r = fresnel::dielectric(wi.z, self.eta).reflectance;
        let mut albedo = Color::ZERO;
        if range.diffuse() {
            albedo += self.diffuse[0] + self.diffuse[1];
        }
        for (side, share) in [r, 1.0 - r].into_iter().enumerate() {
            if range.contains(self.roughness(GLOSSY[side])) {
                albedo += self.glossy[side] * share.max(LEAST);
            }
        }
        albedo
    }

    fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        let mut deltas = Deltas::default();
        if self.specular == [Color::ZERO; 2] {
            return deltas;
        }
        let (_, probabilities) = self.probabilities(wi);
        let f = fresnel::dielectric(wi.z, self.eta);
        let scale = match mode {
            Transport::Radiance => 1.0 / (f.eta * f.eta),
            Transport::Importance => 1.0,
        };
        let reflected = DeltaLobe {
            wo: Vec3::new(-wi.x, -wi.y, wi.z),
            weight: self.specular[0] * f.reflectance,
            probability: probabilities[0],
            eta: 1.0,
            straight: false,
        };
        let transmitted = DeltaLobe {
            wo: Vec3::new(-wi.x / f.eta, -wi.y / f.eta, f.cos_t),
            weight: self.specular[1] * ((1.0 - f.reflectance) * scale),
            probability: probabilities[1],
            eta: f.eta,
            straight: false,
        };
        [reflected, transmitted].into_iter().filter(|l| l.probability > 0.0).for_each(|l| deltas.push(l));
        deltas
    }
}
