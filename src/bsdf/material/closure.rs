use std::f32::consts::FRAC_1_PI;

use super::{Composite, Prepared};
use crate::bsdf::{Deltas, Event, Range, Sample, SmoothSample, Transport};
use crate::math::{Color, Vec2, Vec3};
use crate::sampling::warp;

/// A BSDF at a point: numbers only.
#[derive(Clone, Debug)]
pub struct Closure<'a>(pub(super) Content<'a>);

#[derive(Clone, Debug)]
pub(super) enum Content<'a> {
    /// Made once: the material is everywhere the same.
    Fixed(&'a Prepared),
    /// One diffuse lobe, made for this point.
    Diffuse(Lambertian),
    /// Anything else that was made for it.
    Here(Box<Composite>),
}

/// One diffuse lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lambertian {
    /// Albedo.
    pub reflectance: Color,
    /// The rest of the light goes straight through.
    pub opacity: f32,
    /// Which side reflects: 1 the front, −1 the back.
    pub side: f32,
}

impl Lambertian {
    #[inline(always)]
    fn lit(&self, wi: Vec3, wo: Vec3) -> bool {
        wi.z * self.side > 0.0 && wo.z * self.side > 0.0
    }
}

impl Closure<'_> {
    #[inline(always)]
    fn content(&self) -> Result<&Lambertian, &Composite> {
        match &self.0 {
            Content::Fixed(Prepared::Diffuse(d)) | Content::Diffuse(d) => Ok(d),
            Content::Fixed(Prepared::Composite(composite)) => Err(composite),
            Content::Here(composite) => Err(composite),
        }
    }

    /// The reflectance when the surface is Lambertian as seen from `wi`: such a surface needs no
    /// directions in a density estimate.
    #[inline]
    pub fn lambertian(&self, wi: Vec3) -> Option<Color> {
        match self.content() {
            Ok(d) if wi.z * d.side > 0.0 => Some(d.reflectance * d.opacity),
            _ => None,
        }
    }

    /// f of the smooth lobes in `range`, in 1/sr, without cosine.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
        match self.content() {
            Ok(d) if range.diffuse() && d.lit(wi, wo) => d.reflectance * (FRAC_1_PI * d.opacity),
            Ok(_) => Color::ZERO,
            Err(composite) => composite.eval(wi, wo, mode, range),
        }
    }

    /// Density of `wo` under [`Closure::sample`], for events from lobes in `range`.
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> f32 {
        match self.content() {
            Ok(d) if range.diffuse() && d.lit(wi, wo) => wo.z.abs() * FRAC_1_PI * d.opacity,
            Ok(_) => 0.0,
            Err(composite) => composite.pdf(wi, wo, mode, range),
        }
    }

    /// [`Closure::eval`] and [`Closure::pdf`] together.
    #[inline(always)]
    pub fn eval_pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> (Color, f32) {
        match self.content() {
            Ok(_) => (self.eval(wi, wo, mode, range), self.pdf(wi, wo, mode, range)),
            Err(composite) => composite.eval_pdf(wi, wo, mode, range),
        }
    }

    /// Share of what arrives along `wi` that is scattered by the smooth lobes in `range` (directional
    /// albedo; exact for diffuse and plastic, an estimate for others).
    pub fn smooth_albedo(&self, wi: Vec3, range: Range) -> Color {
        match self.content() {
            Ok(d) if range.diffuse() && wi.z * d.side > 0.0 => d.reflectance * d.opacity,
            Ok(_) => Color::ZERO,
            Err(composite) => composite.albedo(wi, range),
        }
    }

    /// Whether smooth lobes in `range` can be chosen by light along `wi`.
    #[inline(always)]
    pub fn has_smooth(&self, wi: Vec3, range: Range) -> bool {
        match self.content() {
            Ok(_) => range.diffuse(),
            Err(composite) => composite.has_smooth(wi, range),
        }
    }

    /// Probability that light goes straight through.
    #[inline]
    pub fn transparency(&self) -> f32 {
        match self.content() {
            Ok(d) => 1.0 - d.opacity,
            Err(composite) => composite.through,
        }
    }

    /// Share of the light along `wi` that goes straight through, panes included.
    pub fn passage(&self, wi: Vec3) -> Color {
        let through = self.transparency();
        let deltas = self.deltas(wi, Transport::Radiance);
        let panes: Color = deltas.iter().filter(|lobe| lobe.straight).map(|lobe| lobe.weight).sum();
        Color::splat(through) + panes * (1.0 - through)
    }

    /// Specular directions; weights and probabilities are those of an opaque surface.
    #[inline]
    pub fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        match self.content() {
            Ok(_) => Deltas::default(),
            Err(composite) => composite.deltas(wi, mode),
        }
    }

    /// Draws a direction from the smooth lobes of `range` alone; the weight is theirs.
    pub fn sample_smooth(
        &self,
        wi: Vec3,
        u_lobe: f32,
        u: Vec2,
        mode: Transport,
        range: Range,
    ) -> Option<SmoothSample> {
        match self.content() {
            Ok(d) if range.diffuse() => {
                let wo = warp::cosine_hemisphere(u);
                let pdf = wo.z * FRAC_1_PI;
                let wo = Vec3::new(wo.x, wo.y, wo.z * d.side);
                let weight = d.reflectance * d.opacity;
                d.lit(wi, wo).then_some(SmoothSample { wo, weight, pdf, eta: 1.0 })
            }
            Ok(_) => None,
            Err(composite) => composite.sample_smooth(wi, u_lobe, u, mode, range),
        }
    }

    /// Draws one continuation among all lobes; `None` when the path is absorbed. Lobes of roughness
    /// below `glossy` give [`Event::Glossy`], and the weight is that of the lobes on its side of the
    /// threshold: so light that took one way is told from light that took the other.
    #[inline(always)]
    pub fn sample(&self, wi: Vec3, u_lobe: f32, u: Vec2, mode: Transport, glossy: f32) -> Option<Sample> {
        match self.content() {
            Ok(d) => {
                let through = 1.0 - d.opacity;
                if u_lobe < through {
                    return Some(Sample::through(-wi));
                }
                let wo = warp::cosine_hemisphere(u);
                let pdf = wo.z * FRAC_1_PI * d.opacity;
                let wo = Vec3::new(wo.x, wo.y, wo.z * d.side);
                let event = Event::Smooth;
                let weight = d.reflectance;
                d.lit(wi, wo).then_some(Sample { wo, weight, pdf, eta: 1.0, event, straight: false })
            }
            Err(composite) => composite.sample(wi, u_lobe, u, mode, glossy),
        }
    }
}
