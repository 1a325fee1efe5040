//! Surface scattering.
//!
//! Conventions, for every model: directions are in the shading frame and point away from the surface;
//! `wi` is where the path came from, `wo` where it goes. `eval` is f without the cosine (a density
//! estimate must not divide by one). `sample` returns weight = f·|cosθo|/pdf. Densities are per solid
//! angle. Perfectly specular directions are never part of `eval` or `pdf`: they are listed by `deltas`.
//!
//! A model has two faces: `XModel` holds parameters that may be textured ([`Parameters`]), `X` the
//! numbers at one point ([`Scatter`]). Adding one is one new file and a row in each of the two tables below.
//! [`Material`] nests models (masks, blends, two sides, bumps); [`Closure`] is a material at a point.

mod coating;
mod conductor;
mod dielectric;
mod difftrans;
mod diffuse;
mod event;
mod fourier;
pub mod fresnel;
mod fresnelblend;
mod interreflection;
mod lobes;
mod lobesum;
mod material;
mod metal;
pub mod microfacet;
mod phong;
mod plastic;
mod principled;
mod principledthin;
mod roughconductor;
mod roughdielectric;
mod roughdiffuse;
mod roughplastic;
mod thindielectric;
mod ward;

pub use coating::{Coating, CoatingModel, Interreflection};
pub use conductor::{Conductor, ConductorModel};
pub use dielectric::{Dielectric, DielectricModel};
pub use difftrans::{DiffuseTransmission, DiffuseTransmissionModel};
pub use diffuse::{Diffuse, DiffuseModel};
pub use event::{DeltaLobe, Deltas, Event, Range, Sample, SmoothSample, Transport, adjoint_correction};
pub use fourier::{Fourier, FourierModel, FourierTable};
pub use fresnelblend::{FresnelBlend, FresnelBlendModel};
pub use interreflection::{DiffuseBase, RoundTrips, Walk};
pub use lobes::{Lobe, Lobes};
pub use lobesum::{LobeSum, LobeSumModel};
pub use material::{Closure, Material, Node, Perturbation, Relief};
pub use metal::Metal;
pub use microfacet::{Roughness, Transmittance};
pub use phong::{Phong, PhongModel};
pub use plastic::{Plastic, PlasticModel};
pub use principled::{Principled, PrincipledModel};
pub use principledthin::{PrincipledThin, PrincipledThinModel};
pub use roughconductor::{RoughConductor, RoughConductorModel};
pub use roughdielectric::{RoughDielectric, RoughDielectricModel};
pub use roughdiffuse::{RoughDiffuse, RoughDiffuseModel};
pub use roughplastic::{RoughPlastic, RoughPlasticModel};
pub use thindielectric::{ThinDielectric, ThinDielectricModel};
pub use ward::{Ward, WardModel, WardVariant};

use crate::math::{Color, Vec2, Vec3, closed_enum};
use crate::spectrum;
use crate::texture::{Param, Site, Textures};

/// Where parameters are looked up.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    /// Where textures are found.
    pub textures: &'a Textures,
    /// What textures ask for.
    pub site: Site,
    /// ∂p/∂u and ∂p/∂v along the shading frame's s and t.
    pub tangents: [Vec2; 2],
    /// The shading frame's s and t.
    pub axes: [Vec3; 2],
}

impl<'a> Point<'a> {
    /// At `uv` of the plane z = 0.
    pub fn flat(textures: &'a Textures, uv: Vec2) -> Self {
        Self { textures, site: Site::flat(uv), tangents: [Vec2::X, Vec2::Y], axes: [Vec3::X, Vec3::Y] }
    }

    /// Moved by `d` in uv, along the tangent plane.
    fn shifted(&self, d: Vec2) -> Self {
        let along = self.tangents[0] * d.x + self.tangents[1] * d.y;
        let p = self.site.p + self.axes[0] * along.x + self.axes[1] * along.y;
        Self { site: Site { uv: self.site.uv + d, p, ..self.site }, ..*self }
    }

    /// The colour of a parameter here.
    #[inline]
    pub fn color(&self, param: Param) -> Color {
        self.textures.eval(param, &self.site)
    }

    /// Scalars are the luminance of the linear colour.
    #[inline]
    pub fn scalar(&self, param: Param) -> f32 {
        spectrum::scalar(self.color(param))
    }
}

/// What a model is like anywhere on the surface: for the plan, which looks at no points.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nature {
    /// Perfectly specular directions exist: such a surface can throw caustics.
    pub delta: bool,
    /// Bounds of the roughness of its smooth lobes.
    pub smooth: Option<[f32; 2]>,
    /// Light reaches the other side.
    pub transmits: bool,
    /// Smooth lobes are among what does.
    pub diffuses_through: bool,
    /// Turning the shading frame about the normal makes a difference.
    pub oriented: bool,
}

impl Nature {
    const DIFFUSE: [f32; 2] = [Range::DIFFUSE; 2];

    /// A lobe reflects or refracts like a mirror or is smoother than roughness `glossy`: it throws caustics.
    pub fn sharper_than(&self, glossy: f32) -> bool {
        self.delta || self.smooth.is_some_and(|[least, _]| least < glossy)
    }

    #[must_use]
    fn with(mut self, other: Self) -> Self {
        self.delta |= other.delta;
        self.transmits |= other.transmits;
        self.diffuses_through |= other.diffuses_through;
        self.oriented |= other.oriented;
        self.smooth = match (self.smooth, other.smooth) {
            (Some([a, b]), Some([c, d])) => Some([a.min(c), b.max(d)]),
            (a, b) => a.or(b),
        };
        self
    }
}

closed_enum! {
    /// A model with parameters, which may be textured. Nothing here fails: parameters out of range are clamped where
    /// they are looked up.
    pub trait Parameters {
        /// The model at a point.
        fn at(&self, point: &Point<'_>) -> Bxdf;

        /// Every parameter that may be a texture, those of nested materials included: mesh attributes are handed to
        /// the textures that are listed here, and to no others.
        fn params(&self) -> Vec<Param>;

        /// Whether the scattering differs from point to point.
        fn varies(&self) -> bool {
            self.params().iter().any(|p| p.constant().is_none())
        }

        /// What holds at every point.
        fn nature(&self) -> Nature;

        /// The reflectance of a model that is one Lambertian lobe on the front side and nothing else.
        fn lambertian(&self) -> Option<Param> {
            None
        }

        /// The parameter that tells the diffuse reflectance, or the nearest that the model has to it: what
        /// denoisers take for the colour of the surface.
        fn reflectance(&self) -> Option<Param> {
            self.lambertian()
        }
    }

    /// Every model, with parameters. To add one, add a row here and one to [`Bxdf`].
    #[derive(Clone, Debug)]
    pub enum Model {
        Diffuse(DiffuseModel),
        Dielectric(DielectricModel),
        ThinDielectric(ThinDielectricModel),
        RoughDielectric(RoughDielectricModel),
        Conductor(ConductorModel),
        RoughConductor(RoughConductorModel),
        Plastic(PlasticModel),
        RoughPlastic(RoughPlasticModel),
        Principled(PrincipledModel),
        PrincipledThin(PrincipledThinModel),
        RoughDiffuse(RoughDiffuseModel),
        DiffuseTransmission(DiffuseTransmissionModel),
        Phong(PhongModel),
        Ward(WardModel),
        LobeSum(LobeSumModel),
        FresnelBlend(FresnelBlendModel),
        Fourier(FourierModel),
        Coating(CoatingModel),
    }
}

closed_enum! {
    /// A model at a point. Directions are of unit length, in the shading frame, and point away from the surface: `wi` is
    /// where the path came from, `wo` where it goes; z > 0 is the front side, and a model answers for both. What takes a
    /// [`Range`] answers for the smooth lobes in it only.
    pub trait Scatter {
        /// How sampling chooses among the smooth lobes, for light handled along `wi`. Empty when there are none on that
        /// side.
        fn lobes(&self, _wi: Vec3) -> Lobes {
            Lobes::default()
        }

        /// f in 1/sr, per solid angle of `wo` and without the cosine; black where the lobes do not reach. For radiance
        /// refraction divides it by eta².
        fn eval(&self, _wi: Vec3, _wo: Vec3, _mode: Transport, _range: Range) -> Color {
            Color::ZERO
        }

        /// Density in 1/sr with which `draw` gives `wo`, times the probabilities of `lobes`; 0 where it never does.
        fn pdf(&self, _wi: Vec3, _wo: Vec3, _range: Range) -> f32 {
            0.0
        }

        /// Both: what they have in common is computed once.
        fn eval_pdf(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> (Color, f32) {
            (self.eval(wi, wo, mode, range), self.pdf(wi, wo, range))
        }

        /// A direction from the lobe numbered `lobe`, and the relative index it crossed (1 for reflection). `None` when
        /// the drawn direction is on the wrong side or does not exist: the path ends.
        fn draw(&self, _lobe: usize, _wi: Vec3, _u_lobe: f32, _u: Vec2) -> Option<(Vec3, f32)> {
            None
        }

        /// Share of what arrives along `wi` that is scattered by smooth lobes; where no closed form is known it is an
        /// estimate, good enough for choosing among lobes.
        fn albedo(&self, _wi: Vec3, _range: Range) -> Color {
            Color::ZERO
        }

        /// Perfectly specular directions: never part of `eval` and `pdf`. Their probabilities are among all lobes; what
        /// is left of 1 is that of the smooth ones.
        fn deltas(&self, _wi: Vec3, _mode: Transport) -> Deltas {
            Deltas::default()
        }

        /// The reflectance of one Lambertian lobe on the front side, when there is nothing else.
        fn lambertian(&self) -> Option<Color> {
            None
        }
    }

    /// Every model, at a point.
    #[derive(Clone, Debug)]
    pub enum Bxdf {
        Diffuse(Diffuse),
        Dielectric(Dielectric),
        ThinDielectric(ThinDielectric),
        RoughDielectric(RoughDielectric),
        Conductor(Conductor),
        RoughConductor(RoughConductor),
        Plastic(Plastic),
        RoughPlastic(RoughPlastic),
        Principled(Principled),
        PrincipledThin(PrincipledThin),
        RoughDiffuse(RoughDiffuse),
        DiffuseTransmission(DiffuseTransmission),
        Phong(Phong),
        Ward(Ward),
        LobeSum(LobeSum),
        FresnelBlend(FresnelBlend),
        Fourier(Fourier),
        Coating(Coating),
    }
}
