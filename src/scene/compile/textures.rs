//! Textures and textured parameters. Only what is used is loaded, once per use as colour or emission.

mod mappings;
mod pictures;

use std::collections::HashMap;

use caustica_formats::ir::{self, ColorInput, ColorSlot, FloatInput};

use super::Compiler;
use crate::math::{Color, Vec3};
use crate::texture::{
    Bilerp, Checkerboard, Clamped, DirectionMix, Dots, Grid, MeshAttribute, Mix, Noise, Param, Product,
    Scaled, SolidChecks, Texture, Textures, UnitChecks,
};
use mappings::{noise, uv_transform};
use pictures::Waiting;
pub(super) use pictures::{channels, decode_all, decoder};

#[derive(Default)]
pub struct TextureTable {
    textures: Textures,
    known: HashMap<(usize, bool), Param>,
    /// Per texture, how many are looked up for one value of it.
    lookups: Vec<u32>,
    waiting: Vec<Waiting>,
}

/// Textures that look up another texture twice double the work at each level; thirty levels would never finish.
const MAX_LOOKUPS: u32 = 4096;

impl TextureTable {
    pub fn finish(self) -> Textures {
        self.textures
    }

    /// Those that were built already, perhaps without their pictures.
    pub fn so_far(&self) -> &Textures {
        &self.textures
    }

    pub fn at(&mut self, index: u32) -> Option<&mut Texture> {
        self.textures.0.get_mut(index as usize)
    }

    fn lookups(&self, param: Param) -> u32 {
        match param {
            Param::Constant(_) => 0,
            Param::Texture(i) => self.lookups.get(i as usize).copied().unwrap_or(0),
        }
    }

    pub(super) fn push(&mut self, texture: Texture) -> Param {
        let below = texture.inputs().into_iter().map(|input| self.lookups(input));
        self.lookups.push(below.fold(1, u32::saturating_add));
        self.textures.0.push(texture);
        Param::Texture(self.textures.0.len() as u32 - 1)
    }
}

impl Compiler<'_> {
    pub(super) fn param(&mut self, input: &ColorInput, slot: ColorSlot, origin: ir::Origin) -> Param {
        match input {
            ColorInput::Color(c) => Param::Constant(self.color(c, slot, origin)),
            ColorInput::Texture(id) => self.texture(*id, slot),
        }
    }

    /// Of a reflectance, what a surface makes of it: pbrt-v4 clamps it (`Material::GetBxDF`), Mitsuba takes it as it is.
    pub(super) fn reflectance(&mut self, input: &ColorInput, origin: ir::Origin) -> Param {
        let param = self.param(input, ColorSlot::Reflectance, origin);
        if ir::clamps_reflectance(self.ir) && self.textures.so_far().may_leave_unit(param) {
            return self.textures.push(Clamped(param).into());
        }
        param
    }

    pub(super) fn scalar_param(&mut self, input: &FloatInput) -> Param {
        match input {
            FloatInput::Value(v) => Param::gray(*v as f32),
            FloatInput::Texture(id) => match &self.ir.textures[*id].kind {
                // Their pictures are matched.
                ir::TextureKind::Checkerboard { color0, color1, to_uv } if ir::exchanges_numbers(self.ir) => {
                    let origin = self.ir.textures[*id].origin;
                    let colors = [color1, color0].map(|c| self.param(c, ColorSlot::Reflectance, origin));
                    let to_uv = uv_transform(to_uv);
                    self.textures.push(Texture::Checkerboard(Checkerboard { colors, to_uv }))
                }
                _ => self.texture(*id, ColorSlot::Reflectance),
            },
        }
    }

    /// `param` times `factor`.
    pub(super) fn scaled(&mut self, param: Param, factor: f32) -> Param {
        match param {
            Param::Constant(c) => Param::Constant(c * factor),
            Param::Texture(_) if factor == 1.0 => param,
            Param::Texture(_) => {
                self.textures.push(Scaled { input: param, factor: Color::splat(factor) }.into())
            }
        }
    }

    fn texture(&mut self, id: ir::Id<ir::Texture>, slot: ColorSlot) -> Param {
        let key = (id.index(), slot == ColorSlot::Emission);
        if let Some(param) = self.textures.known.get(&key) {
            return *param;
        }
        let mut param = self.compiled(id, slot);
        if self.textures.lookups(param) > MAX_LOOKUPS {
            let text = format!("one value of this texture takes more than {MAX_LOOKUPS} lookups");
            self.error(text, self.ir.textures[id].origin);
            param = Param::gray(0.5);
        }
        self.textures.known.insert(key, param);
        param
    }

    fn compiled(&mut self, id: ir::Id<ir::Texture>, slot: ColorSlot) -> Param {
        let texture = &self.ir.textures[id];
        let origin = texture.origin;
        match &texture.kind {
            ir::TextureKind::Bitmap(b) => self.bitmap(id, b).unwrap_or(Param::gray(0.5)),
            ir::TextureKind::Checkerboard { color0, color1, to_uv } => {
                let colors = [self.nested(color0, slot, origin), self.nested(color1, slot, origin)];
                self.textures.push(Texture::Checkerboard(Checkerboard { colors, to_uv: uv_transform(to_uv) }))
            }
            ir::TextureKind::Scale { value, factor } => {
                let inner = self.nested(value, slot, origin);
                match (inner, self.nested(factor, ColorSlot::Unbounded, origin)) {
                    (Param::Constant(a), Param::Constant(b)) => Param::Constant(a * b),
                    (inner, Param::Constant(factor)) | (Param::Constant(factor), inner) => {
                        self.textures.push(Scaled { input: inner, factor }.into())
                    }
                    (a, b) => self.textures.push(Product([a, b]).into()),
                }
            }
            ir::TextureKind::Grid { color0, color1, line_width, to_uv } => {
                let colors = [self.nested(color0, slot, origin), self.nested(color1, slot, origin)];
                let (line, to_uv) = (*line_width as f32, uv_transform(to_uv));
                self.textures.push(Texture::Grid(Grid { colors, line, to_uv }))
            }
            ir::TextureKind::Mix { first, second, amount: ir::MixAmount::Input(amount) } => {
                let inputs = [self.nested(first, slot, origin), self.nested(second, slot, origin)];
                let amount = self.scalar_param(amount);
                self.textures.push(Texture::Mix(Mix { inputs, amount }))
            }
            ir::TextureKind::Mix { first, second, amount: ir::MixAmount::Direction(direction) } => {
                let inputs = [self.nested(first, slot, origin), self.nested(second, slot, origin)];
                let direction = Vec3::from(direction.map(|x| x as f32));
                self.textures.push(Texture::DirectionMix(DirectionMix { inputs, direction }))
            }
            ir::TextureKind::Bilerp { corners, mapping } => {
                let corners = std::array::from_fn(|i| self.color(&corners[i], slot, origin));
                match self.mapping(mapping, origin) {
                    Some(mapping) => self.textures.push(Texture::Bilerp(Bilerp { corners, mapping })),
                    None => Param::gray(0.5),
                }
            }
            ir::TextureKind::MappedCheckerboard {
                color0,
                color1,
                mapping: ir::Mapping::Solid { to_texture },
            } => {
                let colors = [self.nested(color0, slot, origin), self.nested(color1, slot, origin)];
                let to_texture = self.to_texture(to_texture);
                self.textures.push(Texture::SolidChecks(SolidChecks { colors, to_texture }))
            }
            ir::TextureKind::MappedCheckerboard { color0, color1, mapping } => {
                let colors = [self.nested(color0, slot, origin), self.nested(color1, slot, origin)];
                match self.mapping(mapping, origin) {
                    Some(mapping) => self.textures.push(Texture::UnitChecks(UnitChecks { colors, mapping })),
                    None => Param::gray(0.5),
                }
            }
            ir::TextureKind::Dots { inside, outside, mapping } => {
                let colors = [self.nested(outside, slot, origin), self.nested(inside, slot, origin)];
                match self.mapping(mapping, origin) {
                    Some(mapping) => self.textures.push(Texture::Dots(Dots { colors, mapping })),
                    None => Param::gray(0.5),
                }
            }
            ir::TextureKind::Noise { kind, to_texture } => {
                let (kind, to_texture) = (noise(*kind), self.to_texture(to_texture));
                self.textures.push(Texture::Noise(Noise { kind, to_texture }))
            }
            ir::TextureKind::MeshAttribute { .. } if slot == ColorSlot::Emission => {
                self.unsupported("a light from an attribute of the mesh", "gray 0.5", origin);
                Param::gray(0.5)
            }
            ir::TextureKind::MeshAttribute { name, scale } => {
                let (name, scale, by_shape) = (name.clone(), *scale as f32, Vec::new());
                self.textures.push(Texture::MeshAttribute(MeshAttribute { name, scale, by_shape }))
            }
        }
    }

    /// A value within a texture. Mitsuba 3 takes a spectrum for light, which has a tint in RGB, only where a lamp itself has
    /// it.
    fn nested(&mut self, input: &ColorInput, slot: ColorSlot, origin: ir::Origin) -> Param {
        let rule = self.options.spectrum_rule.unwrap_or(self.ir.spectrum_rule);
        match input {
            ColorInput::Color(c) if slot == ColorSlot::Emission && rule == ir::SpectrumRule::Mitsuba3 => {
                Param::Constant(self.color(c, ColorSlot::Unbounded, origin))
            }
            _ => self.param(input, slot, origin),
        }
    }
}

/// A gray of 0.5: Mitsuba's default reflectance.
pub const DEFAULT_REFLECTANCE: Color = Color::splat(0.5);
