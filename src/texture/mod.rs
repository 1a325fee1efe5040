//! Textures: functions of a surface point giving a linear colour. One file per model; [`Pattern`] is the contract,
//! [`Texture`] the table.

mod attribute;
mod bilerp;
mod bitmap;
mod checkerboard;
mod clamped;
mod directionmix;
mod dots;
mod grid;
mod mapping;
mod mix;
mod noise;
mod product;
mod scaled;
mod site;
mod solidchecks;
mod unitchecks;

pub use attribute::{MeshAttribute, Values};
pub use bilerp::Bilerp;
pub use bitmap::{Bitmap, Bytes, Texels, Wrap};
pub use checkerboard::Checkerboard;
pub use clamped::Clamped;
pub use directionmix::DirectionMix;
pub use dots::Dots;
pub use grid::Grid;
pub use mapping::{Mapping, ToTexture, UvTransform};
pub use mix::Mix;
pub use noise::{Noise, NoiseKind, perlin};
pub use product::Product;
pub use scaled::Scaled;
pub use site::{OnMesh, Site};
pub use solidchecks::SolidChecks;
pub use unitchecks::UnitChecks;

use crate::math::{Color, Vec2, closed_enum};

/// A colour parameter of a material or lamp. Scalars use the luminance of the colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Param {
    /// The same everywhere.
    Constant(Color),
    /// Index into [`Textures`].
    Texture(u32),
}

impl Param {
    /// The same value in every lane.
    pub fn gray(value: f32) -> Self {
        Self::Constant(Color::splat(value))
    }

    /// The texture, if it is one.
    pub fn texture(self, textures: &Textures) -> Option<&Texture> {
        match self {
            Self::Constant(_) => None,
            Self::Texture(i) => textures.0.get(i as usize),
        }
    }

    /// The value, if it is the same everywhere.
    pub fn constant(&self) -> Option<Color> {
        match self {
            Self::Constant(c) => Some(*c),
            Self::Texture(_) => None,
        }
    }
}

closed_enum! {
    /// A colour as a function of a surface point.
    pub trait Pattern {
        /// The linear colour at a point, in no unit of its own. `textures` holds the inputs. Any finite or broken uv
        /// gives a colour: what is not finite is looked up as 0.
        fn eval(&self, textures: &Textures, at: &Site) -> Color;

        /// What it is made of: parameters that may be other textures.
        fn inputs(&self) -> Vec<Param> {
            Vec::new()
        }

        /// Whether a value may be outside of [0, 1].
        fn may_leave_unit(&self, textures: &Textures) -> bool {
            self.inputs().into_iter().any(|input| textures.may_leave_unit(input))
        }

        /// Bytes held by pixels and attributes.
        fn bytes(&self) -> usize {
            0
        }

        /// Whether its values lie with the meshes that show it.
        fn is_attribute(&self) -> bool {
            false
        }
    }

    /// Every texture.
    #[derive(Clone, Debug)]
    pub enum Texture {
        Bitmap(Bitmap),
        Checkerboard(Checkerboard),
        Clamped(Clamped),
        Scaled(Scaled),
        Product(Product),
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
}

/// Every texture of a scene. A texture may refer to earlier ones only.
#[derive(Clone, Debug, Default)]
pub struct Textures(pub Vec<Texture>);

impl Textures {
    /// The value of a parameter at a point: linear, not clamped.
    #[inline]
    pub fn eval(&self, param: Param, at: &Site) -> Color {
        match param {
            Param::Constant(c) => c,
            Param::Texture(i) => self.0[i as usize].eval(self, at),
        }
    }

    /// Whether a value of a parameter may be outside of [0, 1].
    pub fn may_leave_unit(&self, param: Param) -> bool {
        match param {
            Param::Constant(c) => leaves_unit(c),
            Param::Texture(i) => self.0[i as usize].may_leave_unit(self),
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

    /// Indices of the mesh attributes that `params` show, themselves or through what they are made of.
    pub fn attributes_in(&self, params: &[Param]) -> Vec<u32> {
        let mut left: Vec<Param> = params.to_vec();
        let mut seen = vec![false; self.0.len()];
        let mut found = Vec::new();
        while let Some(param) = left.pop() {
            let Param::Texture(i) = param else { continue };
            if std::mem::replace(&mut seen[i as usize], true) {
                continue;
            }
            let texture = &self.0[i as usize];
            if texture.is_attribute() {
                found.push(i);
            }
            left.extend(texture.inputs());
        }
        found
    }

    /// Bytes held by pixels and attributes.
    pub fn bytes(&self) -> usize {
        self.0.iter().map(Texture::bytes).sum()
    }
}

/// Whether a lane is outside of [0, 1].
fn leaves_unit(c: Color) -> bool {
    c.lanes().iter().any(|x| !(0.0..=1.0).contains(x))
}
