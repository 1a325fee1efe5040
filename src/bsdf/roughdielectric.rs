use super::microfacet::{Microfacet, reflect, refract};
use super::{Bxdf, Lobes, Nature, Parameters, Point, Range, Roughness, Scatter, Transport, fresnel};
use crate::math::{Color, Vec2, Vec3};
use crate::texture::Param;

/// Rough boundary between two dielectrics (Walter et al. 2007); `eta` as in `DielectricModel`.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectricModel {
    /// Index of refraction behind the normal over that before it.
    pub eta: f32,
    /// Share of the reflected light that is kept, by colour; 1 is physical.
    pub reflectance: Param,
    /// Share of the transmitted light that is kept, by colour; 1 is physical.
    pub transmittance: Param,
    /// Microfacets of the surface.
    pub roughness: Roughness,
}

impl Parameters for RoughDielectricModel {
    fn at(&self, point: &Point<'_>) -> Bxdf {
        RoughDielectric {
            eta: self.eta,
            reflectance: point.color(self.reflectance),
            transmittance: point.color(self.transmittance),
            microfacet: self.roughness.at(point),
        }
        .into()
    }

    fn params(&self) -> Vec<Param> {
        [self.roughness.params(), vec![self.reflectance, self.transmittance]].concat()
    }

    fn nature(&self) -> Nature {
        Nature {
            smooth: Some([Range::FOLLOWED; 2]),
            transmits: true,
            oriented: self.roughness.oriented(),
            ..Nature::default()
        }
    }
}

/// [`super::RoughDielectricModel`] at a point.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric {
    eta: f32,
    reflectance: Color,
    transmittance: Color,
    microfacet: Microfacet,
}

/// A pair of directions at a rough boundary.
pub(super) struct Meeting {
    /// Microfacet normal, on the upper side.
    pub m: Vec3,
    /// Both directions are on one side.
    pub reflected: bool,
    /// Reflectance at the microfacet.
    pub fresnel: f32,
    /// Index on the far side of `wi` over that on its own.
    pub eta: f32,
    /// |wi·m|.
    pub cos: f32,
    /// |dω_m/dω_o|.
    pub jacobian: f32,
}

impl Meeting {
    /// `None` where the microfacet would be seen from its back.
    pub fn new(wi: Vec3, wo: Vec3, eta: f32) -> Option<Self> {
        let reflected = wi.z * wo.z > 0.0;
        let eta_path = if wi.z > 0.0 { eta } else { 1.0 / eta };
        let h = wi + wo * if reflected { 1.0 } else { eta_path };
        let m = h.try_normalize()?;
        let m = if m.z < 0.0 { -m } else { m };
        let (im, om) = (wi.dot(m), wo.dot(m));
        if im * wi.z <= 0.0 || om * wo.z <= 0.0 {
            return None;
        }
        let (cos, jacobian) = if reflected {
            // Both are this; towards grazing the dot products are all rounding and would differ.
            let cos = 0.5 * h.length();
            (cos, 1.0 / (4.0 * cos))
        } else {
            let t = im + eta_path * om;
            (im.abs(), (eta_path * eta_path * om / (t * t)).abs())
        };
        let fresnel = fresnel::dielectric(im, eta).reflectance;
        jacobian.is_finite().then_some(Self { m, reflected, fresnel, eta: eta_path, cos, jacobian })
    }

    /// Specular BSDF without Fresnel factor and without cosine, for radiance or importance.
    pub fn f(&self, microfacet: &Microfacet, wi: Vec3, wo: Vec3, mode: Transport) -> f32 {
        self.of_dg(microfacet.d(self.m) * microfacet.g(wi, wo, self.m), wi, wo, mode)
    }

    fn of_dg(&self, dg: f32, wi: Vec3, wo: Vec3, mode: Transport) -> f32 {
        // |wi·m|·|dω_m/dω_o| is 1/4 for reflection, and Walter's eq. 21 for refraction.
        let f = dg * (self.cos * self.jacobian / (wi.z * wo.z)).abs();
        if !self.reflected && mode == Transport::Radiance { f / (self.eta * self.eta) } else { f }
    }

    /// [`Meeting::f`] and [`Meeting::pdf`].
    pub fn f_pdf(&self, microfacet: &Microfacet, wi: Vec3, wo: Vec3, mode: Transport) -> (f32, f32) {
        // Masking is the same for both sides, but a density asks for the upper one.
        let (dg, pdf) = microfacet.dg_pdf(wi, wo, self.m, self.cos);
        (self.of_dg(dg, wi, wo, mode), pdf.abs() * self.jacobian)
    }

    /// Density of `wo` given that its normal was sampled and the kind of event chosen.
    pub fn pdf(&self, microfacet: &Microfacet, wi: Vec3) -> f32 {
        let up = if wi.z < 0.0 { -wi } else { wi };
        microfacet.pdf(up, self.m, self.cos) * self.jacobian
    }
}

impl Scatter for RoughDielectric {
    fn lobes(&self, _: Vec3) -> Lobes {
        Lobes::one(Range::FOLLOWED)
    }

    fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        if !range.contains(Range::FOLLOWED) {
            return Color::ZERO;
        }
        let Some(meeting) = Meeting::new(wi, wo, self.eta) else { return Color::ZERO };
        let color = if meeting.reflected {
            self.reflectance * meeting.fresnel
        } else {
            self.transmittance * (1.0 - meeting.fresnel)
        };
        color * meeting.f(&self.microfacet, wi, wo, mode)
    }

    fn eval_pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> (Color, f32) {
        let none = (Color::ZERO, 0.0);
        if !range.contains(Range::FOLLOWED) {
            return none;
        }
        let Some(meeting) = Meeting::new(wi, wo, self.eta) else { return none };
        let (color, choice) = if meeting.reflected {
            (self.reflectance, meeting.fresnel)
        } else {
            (self.transmittance, 1.0 - meeting.fresnel)
        };
        let (f, pdf) = meeting.f_pdf(&self.microfacet, wi, wo, mode);
        (color * choice * f, choice * pdf)
    }

    fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
        if !range.contains(Range::FOLLOWED) {
            return 0.0;
        }
        let Some(meeting) = Meeting::new(wi, wo, self.eta) else { return 0.0 };
        let choice = if meeting.reflected { meeting.fresnel } else { 1.0 - meeting.fresnel };
        choice * meeting.pdf(&self.microfacet, wi)
    }

    fn draw(&self, _: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
        let up = if wi.z < 0.0 { -wi } else { wi };
        let m = self.microfacet.sample(up, u);
        let f = fresnel::dielectric(wi.dot(m), self.eta);
        let (wo, eta) = if u_lobe < f.reflectance {
            (reflect(wi, m), 1.0)
        } else {
            (refract(wi, m, f.cos_t, f.eta), f.eta)
        };
        // Reflection must stay on the side, refraction must leave it.
        ((wi.z * wo.z > 0.0) == (eta == 1.0)).then_some((wo, eta))
    }

    fn albedo(&self, wi: Vec3, range: Range) -> Color {
        if !range.contains(Range::FOLLOWED) {
            return Color::ZERO;
        }
        let r = fresnel::dielectric(wi.z, self.eta).reflectance;
        self.reflectance * r + self.transmittance * (1.0 - r)
    }
}
