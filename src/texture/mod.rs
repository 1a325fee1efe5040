//! Textures: functions of a surface point giving linear RGB. One file per model.

mod attribute;
mod bitmap;
mod checkerboard;
mod mapping;
mod noise;
mod patterns;
mod site;
mod solid;

pub use attribute::{MeshAttribute, Values};
pub use bitmap::{Bitmap, Bytes, Texels, Wrap};
pub use checkerboard::Checkerboard;
pub use mapping::{Mapping, ToTexture, UvTransform};
pub use noise::{Noise, NoiseKind};
pub use patterns::{Bilerp, Grid, Mix, UnitChecks};
pub use site::{OnMesh, Site};
pub use solid::{DirectionMix, Dots, SolidChecks};

use crate::math::{Color, Vec2};

/// A colour parameter of a material or lamp. Scalars use the luminance of the colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Param {
    Constant(Color),
    /// Index into [`Textures`].
    Texture(u32),
}

impl Param {
    pub fn gray(value: f32) -> Self {
        Self::Constant(Color::splat(value))
    }

    pub fn texture(self, textures: &Textures) -> Option<&Texture> {
        match self {
            Self::Constant(_) => None,
            Self::Texture(i) => textures.0.get(i as usize),
        }
    }

    pub fn constant(&self) -> Option<Color> {
        match self {
            Self::Constant(c) => Some(*c),
            Self::Texture(_) => None,
        }
    }
}

#[derive(Clone, Debug)]
pub enum Texture {
    Bitmap(Bitmap),
    Checkerboard(Checkerboard),
    /// A parameter times a constant.
    Scaled(Param, Color),
    Product(Param, Param),
    Grid(Grid),
    UnitChecks(UnitChecks),
    Bilerp(Bilerp),
    Mix(Mix),
    DirectionMix(DirectionMix),
    SolidChecks(SolidChecks),
    Dots(Dots),
    Noise(Noise),
    MeshAttribute(MeshAttribute),
}

impl Texture {
    /// What it is made of.
    pub fn inputs(&self) -> Vec<Param> {
        match self {
            Self::Bitmap(_) | Self::Bilerp(_) | Self::Noise(_) | Self::MeshAttribute(_) => Vec::new(),
            Self::Scaled(p, _) => vec![*p],
            Self::Product(a, b) => vec![*a, *b],
            Self::Mix(t) => vec![t.inputs[0], t.inputs[1], t.amount],
            Self::DirectionMix(t) => t.inputs.to_vec(),
            Self::Checkerboard(t) => t.colors.to_vec(),
            Self::Grid(t) => t.colors.to_vec(),
            Self::UnitChecks(t) => t.colors.to_vec(),
            Self::SolidChecks(t) => t.colors.to_vec(),
            Self::Dots(t) => t.colors.to_vec(),
        }
    }
}

/// Every texture of a scene. A texture may refer to earlier ones only.
#[derive(Clone, Debug, Default)]
pub struct Textures(pub Vec<Texture>);

impl Textures {
    #[inline]
    pub fn eval(&self, param: Param, at: &Site) -> Color {
        match param {
            Param::Constant(c) => c,
            Param::Texture(i) => match &self.0[i as usize] {
                Texture::Bitmap(t) => t.eval(at),
                Texture::Checkerboard(t) => t.eval(self, at),
                Texture::Scaled(inner, factor) => self.eval(*inner, at) * *factor,
                Texture::Product(a, b) => self.eval(*a, at) * self.eval(*b, at),
                Texture::Grid(t) => t.eval(self, at),
                Texture::UnitChecks(t) => t.eval(self, at),
                Texture::Bilerp(t) => t.eval(at),
                Texture::Mix(t) => t.eval(self, at),
                Texture::DirectionMix(t) => t.eval(self, at),
                Texture::SolidChecks(t) => t.eval(self, at),
                Texture::Dots(t) => t.eval(self, at),
                Texture::Noise(t) => t.eval(at.p),
                Texture::MeshAttribute(t) => t.eval(&at.on),
            },
        }
    }

    /// Average over the unit square of a picture that lies on no surface, for choosing lamps by power. Exact for constants; textures
    /// are read on a 64 × 64 grid, which is enough for a sampling weight.
    pub fn mean(&self, param: Param) -> Color {
        match param {
            Param::Constant(c) => c,
            Param::Texture(_) => {
                let n = 64;
                let at = |i: u32| (i as f32 + 0.5) / n as f32;
                let sum = (0..n * n).fold(Color::ZERO, |s, i| {
                    s + self.eval(param, &Site::flat(Vec2::new(at(i % n), at(i / n))))
                });
                sum / (n * n) as f32
            }
        }
    }

    /// Indices of the mesh attributes that `params` show.
    pub fn attributes_in(&self, params: &[Param]) -> Vec<u32> {
        let mut left: Vec<Param> = params.to_vec();
        let mut found = Vec::new();
        while let Some(param) = left.pop() {
            let Param::Texture(i) = param else { continue };
            match &self.0[i as usize] {
                Texture::MeshAttribute(_) if !found.contains(&i) => found.push(i),
                texture => left.extend(texture.inputs()),
            }
        }
        found
    }

    /// Bytes held by pixels and attributes.
    pub fn bytes(&self) -> usize {
        let of = |texture: &Texture| match texture {
            Texture::Bitmap(t) => t.bytes(),
            Texture::MeshAttribute(t) => t.bytes(),
            _ => 0,
        };
        self.0.iter().map(of).sum()
    }
}
