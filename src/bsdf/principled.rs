use std::f32::consts::{FRAC_1_PI, PI};

use super::diffuse::cosine_pdf;
use super::microfacet::{Distribution, Microfacet, Shadowing, reflect, refract};
use super::roughdielectric::Meeting;
use super::{Bxdf, Lobe, Lobes, Nature, Parameters, Point, Range, Scatter, Transport, fresnel};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::spectrum::{luminance, scalar};
use crate::texture::Param;

/// Disney's principled model in Mitsuba 3's form (Burley 2012, 2015).
#[derive(Clone, Copy, Debug)]
pub struct PrincipledModel {
    /// Colour of the diffuse part, and of the reflection of metal.
    pub base_color: Param,
    /// 0 to 1; the α of the distribution is its square.
    pub roughness: Param,
    /// 0 to 1: how far the highlight is stretched along the tangent.
    pub anisotropic: Param,
    /// 0 to 1: from dielectric to metal.
    pub metallic: Param,
    /// 0 to 1: share of light that is refracted instead of scattered diffusely.
    pub spec_trans: Param,
    /// Index of refraction behind the normal over that before it.
    pub eta: f32,
    /// 0 to 1: how much the reflection takes the base colour.
    pub spec_tint: Param,
    /// Strength of the soft reflection at grazing angles.
    pub sheen: Param,
    /// 0 to 1: how much the sheen takes the base colour.
    pub sheen_tint: Param,
    /// 0 to 1: from the diffuse lobe to one that imitates subsurface scattering.
    pub flatness: Param,
    /// 0 to 1: strength of the second, colourless reflection.
    pub clearcoat: Param,
    /// 0 to 1: how narrow that is.
    pub clearcoat_gloss: Param,
}

impl Parameters for PrincipledModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let share = |p: Param| point.scalar(p).clamp(0.0, 1.0);
        let base = point.color(self.base_color);
        let (roughness, metallic, spec_trans) =
            (share(self.roughness), share(self.metallic), share(self.spec_trans));
        let tint = tint(base);
        Principled {
            base,
            roughness,
            metallic,
            brdf: (1.0 - metallic) * (1.0 - spec_trans),
            bsdf: (1.0 - metallic) * spec_trans,
            eta: self.eta,
            spec_tint: share(self.spec_tint),
            tint,
            sheen: (Color::ONE + (tint - Color::ONE) * share(self.sheen_tint))
                * (share(self.sheen) * (1.0 - metallic)),
            flatness: share(self.flatness),
            clearcoat: 0.25 * share(self.clearcoat),
            clearcoat_alpha: 0.1 + (0.001 - 0.1) * share(self.clearcoat_gloss),
            microfacet: distribution(roughness, share(self.anisotropic)),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        vec![
            self.base_color,
            self.roughness,
            self.anisotropic,
            self.metallic,
            self.spec_trans,
            self.spec_tint,
            self.sheen,
            self.sheen_tint,
            self.flatness,
            self.clearcoat,
            self.clearcoat_gloss,
        ]
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.base_color)
    }

    fn nature(&self) -> Nature {
        let none = |p: Param| p == Param::gray(0.0);
        let coated = !none(self.clearcoat);
        let [min, max] = bounds(self.roughness, self.anisotropic);
        let all_metal = self.metallic == Param::gray(1.0) || self.spec_trans == Param::gray(1.0);
        Nature {
            smooth: Some([if coated { 0.0 } else { min }, if all_metal { max } else { Range::DIFFUSE }]),
            transmits: !none(self.spec_trans),
            oriented: !none(self.anisotropic),
            ..Nature::default()
        }
    }
}

/// Bounds of the specular lobe's roughness.
pub(super) fn bounds(roughness: Param, anisotropic: Param) -> [f32; 2] {
    match (roughness, anisotropic) {
        (Param::Constant(r), Param::Constant(a)) => [distribution(scalar(r), scalar(a)).roughness(); 2],
        _ => [0.0, Range::DIFFUSE],
    }
}

/// α = roughness², stretched by the anisotropy.
pub(super) fn distribution(roughness: f32, anisotropic: f32) -> Microfacet {
    let aspect = (1.0 - 0.9 * anisotropic).sqrt();
    let r2 = roughness * roughness;
    let [au, av] = [r2 / aspect, r2 * aspect].map(|a| a.max(0.001));
    Microfacet::new(Distribution::Ggx, Shadowing::Separable, au, av)
}

/// A colour without its brightness.
pub(super) fn tint(base: Color) -> Color {
    let lum = luminance(base);
    if lum > 0.0 { base / lum } else { Color::ONE }
}

/// (1 − cos)⁵.
pub(super) fn schlick(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's weight at an interface; towards the thinner side by the angle behind it.
pub(super) fn schlick_between(cos: f32, eta: f32) -> f32 {
    let eta = if cos >= 0.0 { eta } else { 1.0 / eta };
    if eta > 1.0 {
        return schlick(cos.abs());
    }
    schlick((1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt())
}

/// [`super::PrincipledModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct Principled {
    base: Color,
    roughness: f32,
    metallic: f32,
    /// Weights of the diffuse and of the refracting lobes.
    brdf: f32,
    bsdf: f32,
    eta: f32,
    spec_tint: f32,
    tint: Color,
    sheen: Color,
    flatness: f32,
    clearcoat: f32,
    clearcoat_alpha: f32,
    microfacet: Microfacet,
}

const SPECULAR: usize = 0;
const DIFFUSE: usize = 1;
const CLEARCOAT: usize = 2;

impl Principled {
    /// Fresnel factor of the main reflection.
    fn reflected(&self, dielectric: f32, cos: f32, front: bool) -> Color {
        if !front {
            return Color::splat(self.bsdf * dielectric);
        }
        let weight = schlick_between(cos, self.eta);
        let between = |r0: Color| r0 + (Color::ONE - r0) * weight;
        let r = (self.eta - 1.0) / (self.eta + 1.0);
        let plain = 1.0 - self.metallic;
        between(self.base) * self.metallic
            + Color::splat(plain * (1.0 - self.spec_tint) * dielectric)
            + between(self.tint * (r * r)) * (plain * self.spec_tint)
    }

    fn diffuse(&self, wi: Vec3, wo: Vec3) -> Color {
        let h = (wi + wo).normalize();
        let cos_d = h.dot(wo);
        let retro = 2.0 * self.roughness * cos_d * cos_d;
        diffuse_lobes(self.base, self.flatness, retro, wi.z, wo.z) * self.brdf
            + if self.brdf > 0.0 { self.sheen * schlick(cos_d.abs()) } else { Color::ZERO }
    }

    /// Without the 1/(4 cosθi cosθo) that a microfacet lobe would have: so it is in Disney's code.
    fn coat(&self, wi: Vec3, wo: Vec3, h: Vec3) -> f32 {
        let f = 0.04 + 0.96 * schlick_between(wi.dot(h), self.eta);
        let shadow = Microfacet::new(Distribution::Ggx, Shadowing::Separable, 0.25, 0.25);
        self.clearcoat * f * gtr1(h.z, self.clearcoat_alpha) * shadow.g(wi, wo, h)
    }

    /// Of reflection rather than refraction, given a facet with this Fresnel reflectance.
    fn reflect_probability(&self, wi: Vec3, fresnel: f32) -> f32 {
        if wi.z > 0.0 { 1.0 - self.bsdf * (1.0 - fresnel) } else { fresnel }
    }

    fn has_clearcoat(&self, wi: Vec3) -> bool {
        self.clearcoat > 0.0 && wi.z > 0.0
    }
}

/// Diffuse, retro-reflecting and fake subsurface lobes, with 1/π and without cosine.
pub(super) fn diffuse_lobes(base: Color, flatness: f32, retro: f32, cos_i: f32, cos_o: f32) -> Color {
    let (fi, fo) = (schlick(cos_i.abs()), schlick(cos_o.abs()));
    let diffuse = (1.0 - 0.5 * fi) * (1.0 - 0.5 * fo) + retro * (fo + fi + fo * fi * (retro - 1.0));
    let toward = |f: f32| 1.0 + (0.5 * retro - 1.0) * f;
    let subsurface = 1.25 * (toward(fo) * toward(fi) * (1.0 / (cos_o.abs() + cos_i.abs()) - 0.5) + 0.5);
    base * (FRAC_1_PI * (diffuse + (subsurface - diffuse) * flatness))
}

/// Generalised Trowbridge and Reitz with exponent 1.
fn gtr1(cos: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    if cos > 0.0 { (a2 - 1.0) / (PI * a2.ln() * (1.0 + (a2 - 1.0) * cos * cos)) } else { 0.0 }
}

impl Scatter for Principled {
    fn lobes(&self, wi: Vec3) -> Lobes {
        let mut lobes = [Lobe::default(); 3];
        let roughness = self.microfacet.roughness();
        if wi.z < 0.0 {
            if self.bsdf > 0.0 {
                lobes[SPECULAR] = Lobe { probability: 1.0, roughness };
            }
            return lobes.into();
        }
        let total = 1.0 + self.brdf + self.clearcoat;
        lobes[SPECULAR] = Lobe { probability: 1.0 / total, roughness };
        lobes[DIFFUSE] = Lobe { probability: self.brdf / total, roughness: Range::DIFFUSE };
        lobes[CLEARCOAT] = Lobe { probability: self.clearcoat / total, roughness: self.clearcoat_alpha };
        lobes.into()
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        let front = wi.z > 0.0;
        let mut f = Color::ZERO;
        if range.diffuse() && front && wo.z > 0.0 {
            f += self.diffuse(wi, wo);
        }
        let (main, coat) = (
            range.contains(self.microfacet.roughness()),
            range.contains(self.clearcoat_alpha) && self.has_clearcoat(wi),
        );
        if !main && !coat {
            return f;
        }
        let Some(m) = Meeting::new(wi, wo, self.eta) else { return f };
        if main && (m.reflected || self.bsdf > 0.0) {
            let color = if m.reflected {
                self.reflected(m.fresnel, wi.dot(m.m), front)
            } else {
                self.base.max(Color::ZERO).map(f32::sqrt) * (self.bsdf * (1.0 - m.fresnel))
            };
            f += color * m.f(&self.microfacet, wi, wo, mode);
        }
        if coat && m.reflected {
            f += Color::splat(self.coat(wi, wo, m.m));
        }
        f
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let lobes = self.lobes(wi);
        let on = |lobe: usize| range.contains(lobes[lobe].roughness) && lobes[lobe].probability > 0.0;
        let mut pdf = 0.0;
        if on(DIFFUSE) {
            pdf += lobes[DIFFUSE].probability * cosine_pdf(wo);
        }
        if !on(SPECULAR) && !on(CLEARCOAT) {
            return pdf;
        }
        let Some(m) = Meeting::new(wi, wo, self.eta) else { return pdf };
        if on(SPECULAR) {
            let reflected = self.reflect_probability(wi, m.fresnel);
            let choice = if m.reflected { reflected } else { 1.0 - reflected };
            pdf += lobes[SPECULAR].probability * choice * m.pdf(&self.microfacet, wi);
        }
        if on(CLEARCOAT) && m.reflected {
            pdf += lobes[CLEARCOAT].probability * gtr1(m.m.z, self.clearcoat_alpha) * m.m.z * m.jacobian;
        }
        pdf
    }

    fn draw(&self, lobe: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        match lobe {
            DIFFUSE => Some((warp::cosine_hemisphere(u), 1.0)),
            SPECULAR => {
                let up = if wi.z < 0.0 { -wi } else { wi };
                let m = self.microfacet.sample(up, u);
                let f = fresnel::dielectric(wi.dot(m), self.eta);
                let reflected = u_lobe < self.reflect_probability(wi, f.reflectance);
                let (wo, eta) =
                    if reflected { (reflect(wi, m), 1.0) } else { (refract(wi, m, f.cos_t, f.eta), f.eta) };
                ((wi.z * wo.z > 0.0) == reflected).then_some((wo, eta))
            }
            _ => {
                let a2 = self.clearcoat_alpha * self.clearcoat_alpha;
                let cos2 = ((1.0 - a2.powf(1.0 - u.x)) / (1.0 - a2)).clamp(0.0, 1.0);
                let (sin, (sin_phi, cos_phi)) = ((1.0 - cos2).sqrt(), (2.0 * PI * u.y).sin_cos());
                let wo = reflect(wi, Vec3::new(sin * cos_phi, sin * sin_phi, cos2.sqrt()));
                (wo.z > 0.0).then_some((wo, 1.0))
            }
        }
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let front = wi.z > 0.0;
        let mut albedo = Color::ZERO;
        if range.diffuse() && front {
            albedo += self.base * self.brdf + self.sheen * (0.2 * schlick(wi.z));
        }
        if range.contains(self.microfacet.roughness()) {
            let f = fresnel::dielectric(wi.z, self.eta).reflectance;
            albedo += self.reflected(f, wi.z, front) + self.base * (self.bsdf * (1.0 - f));
        }
        if range.contains(self.clearcoat_alpha) && self.has_clearcoat(wi) {
            albedo += Color::splat(self.clearcoat * (0.04 + 0.96 * schlick(wi.z)));
        }
        albedo.min(Color::ONE)
    }
}
