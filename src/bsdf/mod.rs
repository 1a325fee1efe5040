//! Surface scattering.
//!
//! Conventions, for every model: directions are in the shading frame and point away from the surface;
//! `wi` is where the path came from, `wo` where it goes. `eval` is f without the cosine (a density
//! estimate must not divide by one). `sample` returns weight = f·|cosθo|/pdf. Densities are per solid
//! angle. Perfectly specular directions are never part of `eval` or `pdf`: they are listed by `deltas`.
//!
//! A model has two faces: `XModel` holds parameters that may be textured, `X` the numbers at one point.
//! Adding one is one new file and one row in each of the two tables below.

mod conductor;
mod dielectric;
mod diffuse;
pub mod fresnel;
mod plastic;
mod thindielectric;

pub use conductor::ConductorModel;
pub use dielectric::DielectricModel;
pub use diffuse::DiffuseModel;
pub use plastic::PlasticModel;
pub use thindielectric::ThinDielectricModel;

use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::{Param, Textures};

/// What a path carries. Refraction scales radiance by 1/eta², importance (photons) not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    Radiance,
    Importance,
}

/// A direction drawn from the smooth part of a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct SmoothSample {
    pub wo: Vec3,
    /// f·|cosθo|/pdf.
    pub weight: Rgb,
    pub pdf: f32,
}

/// One perfectly specular direction.
#[derive(Clone, Copy, Debug)]
pub struct DeltaLobe {
    pub wo: Vec3,
    /// Share of the incident quantity that goes this way.
    pub weight: Rgb,
    /// Probability with which a path should choose it among all lobes of the BSDF.
    pub probability: f32,
    /// Index of refraction behind over before the event; 1 for reflection.
    pub eta: f32,
}

/// At most two specular directions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deltas {
    lobes: [Option<DeltaLobe>; 2],
}

impl Deltas {
    fn push(&mut self, lobe: DeltaLobe) {
        if let Some(free) = self.lobes.iter_mut().find(|l| l.is_none()) {
            *free = Some(lobe);
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &DeltaLobe> {
        self.lobes.iter().flatten()
    }
}

/// Where a sampled direction came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    Smooth,
    Delta,
    /// Straight through an opening of a mask or an index-matched boundary.
    Null,
}

/// A sampled continuation.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub wo: Vec3,
    pub weight: Rgb,
    /// Density of `wo` among smooth directions, including the probability of choosing them; 0 for
    /// specular and null events.
    pub pdf: f32,
    pub eta: f32,
    pub event: Event,
}

/// Models with parameters.
#[derive(Clone, Copy, Debug)]
pub enum Model {
    Diffuse(DiffuseModel),
    Dielectric(DielectricModel),
    ThinDielectric(ThinDielectricModel),
    Conductor(ConductorModel),
    Plastic(PlasticModel),
    Null,
}

/// Models at a point.
#[derive(Clone, Copy, Debug)]
enum Lobe {
    Diffuse(diffuse::Diffuse),
    Dielectric(dielectric::Dielectric),
    ThinDielectric(thindielectric::ThinDielectric),
    Conductor(conductor::Conductor),
    Plastic(plastic::Plastic),
    Null,
}

impl Model {
    fn lobe(&self, textures: &Textures, uv: Vec2) -> Lobe {
        match self {
            Self::Diffuse(m) => Lobe::Diffuse(m.lobe(textures, uv)),
            Self::Dielectric(m) => Lobe::Dielectric(m.lobe(textures, uv)),
            Self::ThinDielectric(m) => Lobe::ThinDielectric(m.lobe(textures, uv)),
            Self::Conductor(m) => Lobe::Conductor(m.lobe(textures, uv)),
            Self::Plastic(m) => Lobe::Plastic(m.lobe(textures, uv)),
            Self::Null => Lobe::Null,
        }
    }

    fn params(&self) -> [Option<Param>; 2] {
        match self {
            Self::Diffuse(m) => [Some(m.reflectance), None],
            Self::Dielectric(m) | Self::ThinDielectric(ThinDielectricModel(m)) => {
                [Some(m.reflectance), Some(m.transmittance)]
            }
            Self::Conductor(m) => [Some(m.reflectance), None],
            Self::Plastic(m) => [Some(m.diffuse), Some(m.specular)],
            Self::Null => [None, None],
        }
    }

    /// Whether any parameter is a texture.
    pub fn is_textured(&self) -> bool {
        self.params().iter().flatten().any(|p| p.constant().is_none())
    }

    /// Whether perfectly specular directions exist: such a surface can throw caustics.
    pub fn has_delta(&self) -> bool {
        matches!(self, Self::Dielectric(_) | Self::ThinDielectric(_) | Self::Conductor(_) | Self::Plastic(_))
    }

    /// Whether light scatters into a continuum of directions: photons are stored on such surfaces.
    pub fn has_smooth(&self) -> bool {
        matches!(self, Self::Diffuse(_) | Self::Plastic(_))
    }

    /// Whether light reaches the other side.
    pub fn transmits(&self) -> bool {
        matches!(self, Self::Dielectric(_) | Self::ThinDielectric(_) | Self::Null)
    }
}

/// What a surface is made of, on both sides.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    pub front: Model,
    /// Serves directions below the surface, mirrored; `None` lets `front` decide (most are black there).
    pub back: Option<Model>,
    /// The rest goes straight through; `None` is opaque.
    pub opacity: Option<Param>,
    /// The closures of an untextured material, evaluated once.
    fixed: Option<[Closure; 2]>,
}

impl Material {
    pub fn new(front: Model, back: Option<Model>, opacity: Option<Param>) -> Self {
        let mut material = Self { front, back, opacity, fixed: None };
        let textured = front.is_textured()
            || back.is_some_and(|b| b.is_textured())
            || opacity.is_some_and(|o| o.constant().is_none());
        if !textured {
            let at = |side| material.evaluate(&Textures::default(), Vec2::ZERO, side);
            material.fixed = Some([at(false), at(true)]);
        }
        material
    }

    /// The scattering at a point, for light handled on the side of `wi` (local).
    #[inline(always)]
    pub fn closure(&self, textures: &Textures, uv: Vec2, wi: Vec3) -> Closure {
        let below = wi.z < 0.0;
        match &self.fixed {
            Some(closures) => closures[usize::from(below)],
            None => self.evaluate(textures, uv, below),
        }
    }

    fn evaluate(&self, textures: &Textures, uv: Vec2, below: bool) -> Closure {
        let (model, mirrored) = match self.back {
            Some(back) if below => (back, true),
            _ => (self.front, false),
        };
        let opacity =
            self.opacity.map_or(1.0, |o| crate::math::luminance(textures.eval(o, uv)).clamp(0.0, 1.0));
        Closure { lobe: model.lobe(textures, uv), opacity, mirrored }
    }

    pub fn models(&self) -> impl Iterator<Item = &Model> {
        std::iter::once(&self.front).chain(self.back.iter())
    }

    /// Whether sampling has to choose: anything but a plain diffuse surface.
    pub fn chooses_lobes(&self) -> bool {
        self.opacity.is_some() || self.models().any(|m| !matches!(m, Model::Diffuse(_)))
    }

    /// Whether a shadow ray may pass (in part) straight through.
    pub fn passes_shadow_rays(&self) -> bool {
        self.opacity.is_some() || matches!(self.front, Model::Null)
    }
}

/// A BSDF at a point: numbers only.
#[derive(Clone, Copy, Debug)]
pub struct Closure {
    lobe: Lobe,
    opacity: f32,
    /// Seen from below through a two-sided wrapper: z is negated on the way in and out.
    mirrored: bool,
}

impl Closure {
    #[inline]
    fn side(&self, w: Vec3) -> Vec3 {
        if self.mirrored { Vec3::new(w.x, w.y, -w.z) } else { w }
    }

    /// The reflectance when the surface is Lambertian as seen from `wi`: such a surface needs no
    /// directions in a density estimate.
    #[inline]
    pub fn lambertian(&self, wi: Vec3) -> Option<Rgb> {
        match &self.lobe {
            Lobe::Diffuse(d) if self.side(wi).z > 0.0 => Some(d.reflectance * self.opacity),
            _ => None,
        }
    }

    /// f of the smooth part, in 1/sr, without cosine.
    #[inline(always)]
    pub fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport) -> Rgb {
        let (wi, wo) = (self.side(wi), self.side(wo));
        let f = match &self.lobe {
            Lobe::Diffuse(l) => l.eval(wi, wo, mode),
            Lobe::Plastic(l) => l.eval(wi, wo, mode),
            Lobe::Dielectric(_) | Lobe::ThinDielectric(_) | Lobe::Conductor(_) | Lobe::Null => {
                return Rgb::ZERO;
            }
        };
        f * self.opacity
    }

    /// Density of `wo` under [`Closure::sample`].
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        let (l_wi, l_wo) = (self.side(wi), self.side(wo));
        let pdf = match &self.lobe {
            Lobe::Diffuse(l) => return l.pdf(l_wi, l_wo) * self.opacity,
            Lobe::Plastic(l) => l.pdf(l_wi, l_wo),
            Lobe::Dielectric(_) | Lobe::ThinDielectric(_) | Lobe::Conductor(_) | Lobe::Null => return 0.0,
        };
        pdf * self.smooth_probability(wi) * self.opacity
    }

    /// Share of what arrives along `wi` that is scattered smoothly (directional albedo; exact for
    /// diffuse and plastic).
    pub fn smooth_albedo(&self, wi: Vec3) -> Rgb {
        let wi = self.side(wi);
        match &self.lobe {
            Lobe::Diffuse(l) => l.albedo(wi) * self.opacity,
            Lobe::Plastic(l) => l.albedo(wi) * self.opacity,
            Lobe::Dielectric(_) | Lobe::ThinDielectric(_) | Lobe::Conductor(_) | Lobe::Null => Rgb::ZERO,
        }
    }

    #[inline]
    pub fn has_smooth(&self) -> bool {
        matches!(self.lobe, Lobe::Diffuse(_) | Lobe::Plastic(_))
    }

    /// Probability that light goes straight through.
    #[inline]
    pub fn transparency(&self) -> f32 {
        if matches!(self.lobe, Lobe::Null) { 1.0 } else { 1.0 - self.opacity }
    }

    /// Specular directions; weights and probabilities are those of an opaque surface.
    pub fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
        let local = self.side(wi);
        let mut deltas = match &self.lobe {
            Lobe::Diffuse(_) | Lobe::Null => Deltas::default(),
            Lobe::Dielectric(l) => l.deltas(local, mode),
            Lobe::ThinDielectric(l) => l.deltas(local, mode),
            Lobe::Conductor(l) => l.deltas(local, mode),
            Lobe::Plastic(l) => l.deltas(local, mode),
        };
        for lobe in deltas.lobes.iter_mut().flatten() {
            lobe.wo = self.side(lobe.wo);
        }
        deltas
    }

    fn smooth_probability(&self, wi: Vec3) -> f32 {
        1.0 - self.deltas(wi, Transport::Importance).iter().map(|l| l.probability).sum::<f32>()
    }

    /// Draws a direction from the smooth part alone; the weight is that of the smooth part.
    #[inline(always)]
    pub fn sample_smooth(&self, wi: Vec3, u: Vec2, mode: Transport) -> Option<SmoothSample> {
        let local = self.side(wi);
        let mut sample = match &self.lobe {
            Lobe::Diffuse(l) => l.sample(local, u, mode),
            Lobe::Plastic(l) => l.sample(local, u, mode),
            Lobe::Dielectric(_) | Lobe::ThinDielectric(_) | Lobe::Conductor(_) | Lobe::Null => None,
        }?;
        sample.wo = self.side(sample.wo);
        Some(sample)
    }

    /// Draws one continuation among all lobes; `None` when the path is absorbed.
    #[inline(always)]
    pub fn sample(&self, wi: Vec3, u_lobe: f32, u: Vec2, mode: Transport) -> Option<Sample> {
        let through = self.transparency();
        if u_lobe < through {
            return Some(Sample { wo: -wi, weight: Rgb::ONE, pdf: 0.0, eta: 1.0, event: Event::Null });
        }
        let solid = 1.0 - through;
        if let Lobe::Diffuse(_) = self.lobe {
            let s = self.sample_smooth(wi, u, mode)?;
            let pdf = s.pdf * solid;
            return Some(Sample { wo: s.wo, weight: s.weight, pdf, eta: 1.0, event: Event::Smooth });
        }
        self.sample_mixed(wi, (u_lobe - through) / solid, solid, u, mode)
    }

    /// [`Closure::sample`] of a surface with specular directions; `u_lobe` chooses among them.
    #[inline(never)]
    fn sample_mixed(&self, wi: Vec3, u_lobe: f32, solid: f32, u: Vec2, mode: Transport) -> Option<Sample> {
        let smooth = |probability: f32| {
            let s = self.sample_smooth(wi, u, mode)?;
            Some(Sample {
                wo: s.wo,
                weight: s.weight / probability,
                pdf: s.pdf * probability * solid,
                eta: 1.0,
                event: Event::Smooth,
            })
        };
        let mut rest = u_lobe;
        let deltas = self.deltas(wi, mode);
        let mut left = 1.0;
        for lobe in deltas.iter() {
            if rest < lobe.probability {
                return Some(Sample {
                    wo: lobe.wo,
                    weight: lobe.weight / lobe.probability,
                    pdf: 0.0,
                    eta: lobe.eta,
                    event: Event::Delta,
                });
            }
            rest -= lobe.probability;
            left -= lobe.probability;
        }
        if left > 0.0 { smooth(left) } else { None }
    }
}
