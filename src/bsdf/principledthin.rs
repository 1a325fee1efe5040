use std::f32::consts::FRAC_1_PI;

use super::diffuse::cosine_pdf;
use super::microfacet::{Microfacet, reflect};
use super::principled::{bounds, diffuse_lobes, distribution, schlick, schlick_between, tint};
use super::roughconductor::reflected_pdf;
use super::{Bxdf, Lobe, Lobes, Nature, Parameters, Point, Range, Scatter, Transport, fresnel};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;
use crate::spectrum::scalar;
use crate::texture::Param;

/// Disney's model for thin sheets: both sides are alike, and what is refracted leaves at once, blurred.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThinModel {
    /// Colour of the diffuse part, and of the reflection of metal.
    pub base_color: Param,
    /// 0 to 1; the α of the distribution is its square.
    pub roughness: Param,
    /// 0 to 1: how far the highlight is stretched along the tangent.
    pub anisotropic: Param,
    /// 0 to 1: share of light that is refracted instead of scattered diffusely.
    pub spec_trans: Param,
    /// Index of refraction of the sheet over that outside.
    pub eta: Param,
    /// 0 to 1: how much the reflection takes the base colour.
    pub spec_tint: Param,
    /// Strength of the soft reflection at grazing angles.
    pub sheen: Param,
    /// 0 to 1: how much the sheen takes the base colour.
    pub sheen_tint: Param,
    /// 0 to 1: from the diffuse lobe to one that imitates subsurface scattering.
    pub flatness: Param,
    /// 0..2: half of it is transmitted.
    pub diff_trans: Param,
}

impl Parameters for PrincipledThinModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        let share = |p: Param| point.scalar(p).clamp(0.0, 1.0);
        let base = point.color(self.base_color);
        let (roughness, anisotropic, eta) =
            (share(self.roughness), share(self.anisotropic), point.scalar(self.eta));
        let (spec_trans, spec_tint) = (share(self.spec_trans), share(self.spec_tint));
        let diff_trans = (0.5 * point.scalar(self.diff_trans)).clamp(0.0, 1.0);
        let tint = tint(base);
        PrincipledThin {
            base,
            roughness,
            spec_trans,
            eta,
            spec_tint,
            tint,
            sheen: (Color::ONE + (tint - Color::ONE) * share(self.sheen_tint)) * share(self.sheen),
            flatness: share(self.flatness),
            diff_trans,
            reflection: distribution(roughness, anisotropic),
            // Burley 2015, figure 15.
            transmission: distribution(((0.65 * eta - 0.35) * roughness).abs(), anisotropic),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        vec![
            self.base_color,
            self.roughness,
            self.anisotropic,
            self.spec_trans,
            self.eta,
            self.spec_tint,
            self.sheen,
            self.sheen_tint,
            self.flatness,
            self.diff_trans,
        ]
    }

    fn reflectance(&self) -> Option<Param> {
        Some(self.base_color)
    }

    fn nature(&self) -> Nature {
        let [min, max] = bounds(self.roughness, self.anisotropic);
        let least = match (self.spec_trans == Param::gray(0.0), self.eta) {
            (true, _) => Range::DIFFUSE,
            (false, Param::Constant(eta)) => min * (0.65 * scalar(eta) - 0.35).abs().powi(2).min(1.0),
            (false, Param::Texture(_)) => 0.0,
        };
        let most = if self.spec_trans == Param::gray(1.0) { max } else { Range::DIFFUSE };
        Nature {
            smooth: Some([least, most]),
            transmits: true,
            oriented: self.anisotropic != Param::gray(0.0),
            ..Nature::default()
        }
    }
}

/// [`super::PrincipledThinModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct PrincipledThin {
    base: Color,
    roughness: f32,
    spec_trans: f32,
    eta: f32,
    spec_tint: f32,
    tint: Color,
    sheen: Color,
    flatness: f32,
    diff_trans: f32,
    reflection: Microfacet,
    transmission: Microfacet,
}

/// Both directions as if `wi` were above, and whether the light stays on its side.
fn upright(wi: Vec3, wo: Vec3) -> (Vec3, Vec3, bool) {
    let sign = 1.0f32.copysign(wi.z);
    let (wi, wo) = (wi * sign, wo * sign);
    (wi, wo, wo.z > 0.0)
}

fn mirrored(w: Vec3) -> Vec3 {
    Vec3::new(w.x, w.y, -w.z)
}

impl PrincipledThin {
    fn fresnel(&self, cos: f32) -> Color {
        let r = (self.eta - 1.0) / (self.eta + 1.0);
        let r0 = self.tint * (r * r);
        let tinted = r0 + (Color::ONE - r0) * schlick_between(cos, self.eta);
        let plain = Color::splat(fresnel::dielectric(cos, self.eta).reflectance);
        plain + (tinted - plain) * self.spec_tint
    }

    fn diffuse(&self, wi: Vec3, wo: Vec3) -> Color {
        let cos_d = (wi + wo).normalize().dot(wo);
        let retro = 2.0 * self.roughness * cos_d * cos_d;
        (diffuse_lobes(self.base, self.flatness, retro, wi.z, wo.z) + self.sheen * schlick(cos_d.abs()))
            * ((1.0 - self.spec_trans) * (1.0 - self.diff_trans))
    }

    /// The blurred straight passage is a reflection turned to the other side.
    fn refracted(&self, wi: Vec3, wo: Vec3, mode: Transport) -> Color {
        let above = mirrored(wo);
        let h = (wi + above).normalize();
        // Mitsuba masks facets whose front the turned direction would not see, as seen from the camera.
        let light = if mode == Transport::Radiance { above } else { wi };
        if mirrored(light).dot(h) >= 0.0 {
            return Color::ZERO;
        }
        let (f, t) = (fresnel::dielectric(wi.dot(h), self.eta).reflectance, &self.transmission);
        let dg = t.d(h) * t.g(wi, above, h);
        self.base * (self.spec_trans * (1.0 - f) * dg / (4.0 * wi.z * above.z))
    }
}

impl Scatter for PrincipledThin {
    /// Glossy reflection and passage, diffuse reflection and passage.
    fn lobes(&self, _: Vec3) -> Lobes {
        let diffuse = 1.0 - self.spec_trans;
        let lobe = |probability, roughness| Lobe { probability, roughness };
        Lobes::from([
            lobe(0.5 * self.spec_trans, self.reflection.roughness()),
            lobe(0.5 * self.spec_trans, self.transmission.roughness()),
            lobe(diffuse * (1.0 - self.diff_trans), Range::DIFFUSE),
            lobe(diffuse * self.diff_trans, Range::DIFFUSE),
        ])
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        let (wi, wo, reflected) = upright(wi, wo);
        let mut f = Color::ZERO;
        if wi.z == 0.0 || wo.z == 0.0 {
            return f;
        }
        if reflected {
            if range.contains(self.reflection.roughness()) && self.spec_trans > 0.0 {
                let h = (wi + wo).normalize();
                let dg = self.reflection.d(h) * self.reflection.g(wi, wo, h);
                f += self.fresnel(wi.dot(h)) * (self.spec_trans * dg / (4.0 * wi.z * wo.z));
            }
            if range.diffuse() {
                f += self.diffuse(wi, wo);
            }
        } else {
            if range.contains(self.transmission.roughness()) && self.spec_trans > 0.0 {
                f += self.refracted(wi, wo, mode);
            }
            if range.diffuse() {
                f += self.base * (FRAC_1_PI * (1.0 - self.spec_trans) * self.diff_trans);
            }
        }
        f
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        let (wi, wo, reflected) = upright(wi, wo);
        if wi.z == 0.0 || wo.z == 0.0 {
            return 0.0;
        }
        let lobes = self.lobes(wi);
        let side = if reflected { wo } else { mirrored(wo) };
        let (glossy, diffuse) = if reflected { (0, 2) } else { (1, 3) };
        let mut pdf = 0.0;
        if range.diffuse() {
            pdf += lobes[diffuse].probability * cosine_pdf(side);
        }
        if lobes[glossy].probability > 0.0 && range.contains(lobes[glossy].roughness) {
            let microfacet = if reflected { &self.reflection } else { &self.transmission };
            pdf += lobes[glossy].probability * reflected_pdf(microfacet, wi, side);
        }
        pdf
    }

    fn draw(&self, lobe: usize, wi: Vec3, _: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let up = upright(wi, wi).0;
        let wo = match lobe {
            0 => reflect(up, self.reflection.sample(up, u)),
            1 => reflect(up, self.transmission.sample(up, u)),
            _ => warp::cosine_hemisphere(u),
        };
        if wo.z <= 0.0 {
            return None;
        }
        let wo = if lobe % 2 == 1 { mirrored(wo) } else { wo };
        Some((wo * 1.0f32.copysign(wi.z), 1.0))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        let f = fresnel::dielectric(wi.z.abs(), self.eta).reflectance;
        let mut albedo = Color::ZERO;
        if range.contains(self.reflection.roughness()) {
            albedo += self.fresnel(wi.z.abs()) * self.spec_trans;
        }
        if range.contains(self.transmission.roughness()) {
            albedo += self.base * (self.spec_trans * (1.0 - f));
        }
        if range.diffuse() {
            albedo += self.base * (1.0 - self.spec_trans);
        }
        albedo
    }
}
