//! Surface scattering.
//!
//! Conventions, for every model: directions are in the shading frame and point away from the surface;
//! `wi` is where the path came from, `wo` where it goes. `eval` is f without the cosine (a density
//! estimate must not divide by one). `sample` returns weight = f·|cosθo|/pdf. Densities are per solid
//! angle. Perfectly specular directions are never part of `eval` or `pdf`: they are listed by `deltas`.
//!
//! A model has two faces: `XModel` holds parameters that may be textured ([`Parameters`]), `X` the
//! numbers at one point ([`Scatter`]). Adding one is one new file and one row in the table below.
//! [`Material`] nests models (masks, blends, two sides, bumps); [`Closure`] is a material at a point.

mod between;
mod closure;
mod coating;
mod conductor;
mod dielectric;
mod difftrans;
mod diffuse;
mod event;
pub mod fresnel;
mod layers;
mod material;
mod metal;
pub mod microfacet;
mod phong;
mod plastic;
mod principled;
mod principledthin;
mod returned;
mod roughconductor;
mod roughdielectric;
mod roughdiffuse;
mod roughness;
mod roughplastic;
mod rows;
mod special;
mod thindielectric;
mod tilt;
mod transmittance;
mod ward;

pub use between::{Between, Walk};
pub use closure::Closure;
pub use coating::{CoatingModel, Interreflection};
pub use conductor::ConductorModel;
pub use dielectric::DielectricModel;
pub use difftrans::DiffuseTransmissionModel;
pub use diffuse::DiffuseModel;
pub use event::{DeltaLobe, Deltas, Event, Range, Sample, SmoothSample, Transport};
pub use material::{Material, Node};
pub use metal::Metal;
pub use phong::PhongModel;
pub use plastic::PlasticModel;
pub use principled::PrincipledModel;
pub use principledthin::PrincipledThinModel;
pub use returned::Returned;
pub use roughconductor::RoughConductorModel;
pub use roughdielectric::RoughDielectricModel;
pub use roughdiffuse::RoughDiffuseModel;
pub use roughness::Roughness;
pub use roughplastic::RoughPlasticModel;
pub use thindielectric::ThinDielectricModel;
pub use tilt::{Perturbation, Relief};
pub use transmittance::Transmittance;
pub use ward::{WardModel, WardVariant};

use crate::math::{Color, Vec2, Vec3};
use crate::spectrum;
use crate::texture::{Param, Site, Textures};

/// Where parameters are looked up.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    pub textures: &'a Textures,
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

/// A model with parameters.
trait Parameters {
    type At: Scatter;

    fn at(&self, point: &Point<'_>) -> Self::At;
    fn params(&self) -> Vec<Param>;
    /// Whether any parameter is a texture.
    fn varies(&self) -> bool {
        self.params().iter().any(|p| p.constant().is_none())
    }
    fn nature(&self) -> Nature;
}

/// A lobe of a model that can be chosen when sampling.
#[derive(Clone, Copy, Debug, Default)]
struct Part {
    /// Among the smooth lobes.
    probability: f32,
    roughness: f32,
}

/// The smooth lobes of a model; unused ones have probability 0.
type PartList = [Part; PARTS];

/// Two nested models of three lobes under a coat, and one to spare.
const PARTS: usize = 8;

fn one_part(roughness: f32) -> PartList {
    let mut parts = PartList::default();
    parts[0] = Part { probability: 1.0, roughness };
    parts
}

/// A model at a point. What takes a [`Range`] answers for the lobes in it.
trait Scatter {
    /// How sampling chooses among the smooth lobes, for light handled along `wi`.
    fn parts(&self, _wi: Vec3) -> PartList {
        PartList::default()
    }

    fn eval(&self, _wi: Vec3, _wo: Vec3, _mode: Transport, _range: Range) -> Color {
        Color::ZERO
    }

    /// Density with which `draw` gives `wo`, times the probabilities of `parts`.
    fn pdf(&self, _wi: Vec3, _wo: Vec3, _range: Range) -> f32 {
        0.0
    }

    /// A direction from the lobe numbered `part`, and the relative index it crossed (1 for reflection).
    fn draw(&self, _part: usize, _wi: Vec3, _u_lobe: f32, _u: Vec2) -> Option<(Vec3, f32)> {
        None
    }

    /// Share of what arrives along `wi` that is scattered by smooth lobes; where no closed form is
    /// known it is an estimate, good enough for choosing among lobes.
    fn albedo(&self, _wi: Vec3, _range: Range) -> Color {
        Color::ZERO
    }

    fn deltas(&self, _wi: Vec3, _mode: Transport) -> Deltas {
        Deltas::default()
    }
}

macro_rules! models {
    ($($name:ident($model:ty)),+ $(,)?) => {
        /// Models with parameters.
        #[derive(Clone, Debug)]
        pub enum Model { $($name($model)),+ }

        /// Models at a point.
        #[derive(Clone, Debug)]
        enum Lobe { $($name(<$model as Parameters>::At)),+ }

        $(impl From<$model> for Model {
            fn from(model: $model) -> Self {
                Self::$name(model)
            }
        })+

        impl Model {
            fn at(&self, point: &Point<'_>) -> Lobe {
                match self { $(Self::$name(m) => Lobe::$name(m.at(point))),+ }
            }

            fn varies(&self) -> bool {
                match self { $(Self::$name(m) => m.varies()),+ }
            }

            fn params(&self) -> Vec<Param> {
                match self { $(Self::$name(m) => m.params()),+ }
            }

            pub fn nature(&self) -> Nature {
                match self { $(Self::$name(m) => m.nature()),+ }
            }
        }

        impl Scatter for Lobe {
            fn parts(&self, wi: Vec3) -> PartList {
                match self { $(Self::$name(l) => l.parts(wi)),+ }
            }

            fn eval(&self, wi: Vec3, wo: Vec3, mode: Transport, range: Range) -> Color {
                match self { $(Self::$name(l) => l.eval(wi, wo, mode, range)),+ }
            }

            fn pdf(&self, wi: Vec3, wo: Vec3, range: Range) -> f32 {
                match self { $(Self::$name(l) => l.pdf(wi, wo, range)),+ }
            }

            fn draw(&self, part: usize, wi: Vec3, u_lobe: f32, u: Vec2) -> Option<(Vec3, f32)> {
                match self { $(Self::$name(l) => l.draw(part, wi, u_lobe, u)),+ }
            }

            fn albedo(&self, wi: Vec3, range: Range) -> Color {
                match self { $(Self::$name(l) => l.albedo(wi, range)),+ }
            }

            fn deltas(&self, wi: Vec3, mode: Transport) -> Deltas {
                match self { $(Self::$name(l) => l.deltas(wi, mode)),+ }
            }
        }
    };
}

models! {
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
    Coating(CoatingModel),
}
