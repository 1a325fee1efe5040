//! Textures and textured parameters. Only what is used is loaded, once per use as colour or emission.

mod mappings;

use std::collections::HashMap;

use caustica_formats::image::{self, Encoding};
use caustica_formats::ir::{self, ColorInput, ColorSlot, FloatInput};
use caustica_formats::spectrum::SrgbTable;

use super::Builder;
use crate::math::{Rgb, Vec3};
use crate::texture::{
    Bilerp, Bitmap, Checkerboard, DirectionMix, Dots, Grid, MeshAttribute, Mix, Noise, Param, SolidChecks,
    Texture, Textures, UnitChecks, Wrap,
};
use mappings::{noise, uv_transform};

#[derive(Default)]
pub struct TextureTable {
    textures: Textures,
    known: HashMap<(usize, bool), Param>,
    /// Per texture, how many are looked up for one value of it.
    lookups: Vec<u32>,
}

/// Textures that double each other thirty times would never come to an end.
const MAX_LOOKUPS: u32 = 4096;

impl TextureTable {
    pub fn finish(self) -> Textures {
        self.textures
    }

    /// Those that were built already.
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

    fn push(&mut self, texture: Texture) -> Param {
        let below = texture.inputs().into_iter().map(|input| self.lookups(input));
        self.lookups.push(below.fold(1, u32::saturating_add));
        self.textures.0.push(texture);
        Param::Texture(self.textures.0.len() as u32 - 1)
    }
}

impl Builder<'_> {
    pub(super) fn param(&mut self, input: &ColorInput, slot: ColorSlot, origin: ir::Origin) -> Param {
        match input {
            ColorInput::Color(c) => Param::Constant(self.color(c, slot, origin)),
            ColorInput::Texture(id) => self.texture(*id, slot),
        }
    }

    pub(super) fn scalar_param(&mut self, input: &FloatInput) -> Param {
        match input {
            FloatInput::Value(v) => Param::gray(*v as f32),
            FloatInput::Texture(id) => match &self.ir.textures[*id].kind {
                // Mitsuba 3.9.1 exchanges the colours of a checkerboard where it wants one number; its
                // pictures are matched.
                ir::TextureKind::Checkerboard { color0, color1, to_uv }
                    if self.ir.spectrum_rule == ir::SpectrumRule::Mitsuba3 =>
                {
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
            Param::Texture(_) => self.textures.push(Texture::Scaled(param, Rgb::splat(factor))),
        }
    }

    fn texture(&mut self, id: ir::Id<ir::Texture>, slot: ColorSlot) -> Param {
        let key = (id.index(), slot == ColorSlot::Emission);
        if let Some(param) = self.textures.known.get(&key) {
            return *param;
        }
        let texture = &self.ir.textures[id];
        let origin = texture.origin;
        let param = match &texture.kind {
            ir::TextureKind::Bitmap(b) => match self.bitmap(b, origin) {
                Some(b) => self.textures.push(Texture::Bitmap(b)),
                None => Param::gray(0.5),
            },
            ir::TextureKind::Checkerboard { color0, color1, to_uv } => {
                let colors = [self.param(color0, slot, origin), self.param(color1, slot, origin)];
                self.textures.push(Texture::Checkerboard(Checkerboard { colors, to_uv: uv_transform(to_uv) }))
            }
            ir::TextureKind::Scale { value, factor } => {
                let inner = self.param(value, slot, origin);
                match (inner, self.param(factor, ColorSlot::Unbounded, origin)) {
                    (Param::Constant(a), Param::Constant(b)) => Param::Constant(a * b),
                    (inner, Param::Constant(factor)) | (Param::Constant(factor), inner) => {
                        self.textures.push(Texture::Scaled(inner, factor))
                    }
                    (a, b) => self.textures.push(Texture::Product(a, b)),
                }
            }
            ir::TextureKind::Grid { color0, color1, line_width, to_uv } => {
                let colors = [self.param(color0, slot, origin), self.param(color1, slot, origin)];
                let (line, to_uv) = (*line_width as f32, uv_transform(to_uv));
                self.textures.push(Texture::Grid(Grid { colors, line, to_uv }))
            }
            ir::TextureKind::Mix { first, second, amount: ir::MixAmount::Input(amount) } => {
                let inputs = [self.param(first, slot, origin), self.param(second, slot, origin)];
                let amount = self.scalar_param(amount);
                self.textures.push(Texture::Mix(Mix { inputs, amount }))
            }
            ir::TextureKind::Mix { first, second, amount: ir::MixAmount::Direction(direction) } => {
                let inputs = [self.param(first, slot, origin), self.param(second, slot, origin)];
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
                let colors = [self.param(color0, slot, origin), self.param(color1, slot, origin)];
                let to_texture = self.to_texture(to_texture);
                self.textures.push(Texture::SolidChecks(SolidChecks { colors, to_texture }))
            }
            ir::TextureKind::MappedCheckerboard { color0, color1, mapping } => {
                let colors = [self.param(color0, slot, origin), self.param(color1, slot, origin)];
                match self.mapping(mapping, origin) {
                    Some(mapping) => self.textures.push(Texture::UnitChecks(UnitChecks { colors, mapping })),
                    None => Param::gray(0.5),
                }
            }
            ir::TextureKind::Dots { inside, outside, mapping } => {
                let colors = [self.param(outside, slot, origin), self.param(inside, slot, origin)];
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
        };
        let param = if self.textures.lookups(param) > MAX_LOOKUPS {
            self.error(format!("one value of this texture takes more than {MAX_LOOKUPS} lookups"), origin);
            Param::gray(0.5)
        } else {
            param
        };
        self.textures.known.insert(key, param);
        param
    }

    fn bitmap(&mut self, b: &ir::Bitmap, origin: ir::Origin) -> Option<Bitmap> {
        let read = self
            .files
            .read(&b.path)
            .map_err(|e| e.to_string())
            .and_then(|bytes| image::read(&bytes).map_err(|e| e.to_string()));
        let picture = match read {
            Ok(picture) => picture,
            Err(e) => {
                self.error(format!("cannot read texture `{}`: {e}", b.path.display()), origin);
                return None;
            }
        };
        let channels = channels(&picture.channels, b.channel);
        let Some(channels) = channels else {
            let known = picture.channels.join(", ");
            self.error(
                format!("texture `{}` has channels {known}, none of them usable", b.path.display()),
                origin,
            );
            return None;
        };
        let decode = decoder(b.encoding, picture.encoding);
        let mapping = self.mapping(&b.mapping, origin)?;
        let scale = b.scale as f32;
        // pbrt scales before it inverts.
        let adjust = |x: f32| if b.invert { (1.0 - x * scale).max(0.0) } else { x * scale };
        let texels = picture
            .data
            .chunks_exact(picture.channels.len())
            .map(|p| channels.map(|c| adjust(decode(p[c]))))
            .collect();
        Some(Bitmap {
            width: picture.width,
            height: picture.height,
            texels,
            bilinear: b.filter == ir::TextureFilter::Bilinear,
            wrap: [wrap(b.wrap_u), wrap(b.wrap_v)],
            mapping,
        })
    }
}

/// Indices of the channels to use as RGB. Alpha is dropped without un-premultiplying, as Mitsuba does.
pub(super) fn channels(names: &[String], one: Option<char>) -> Option<[usize; 3]> {
    let find = |wanted: &str| names.iter().position(|n| n.eq_ignore_ascii_case(wanted));
    if let Some(c) = one {
        return find(&c.to_string()).map(|i| [i; 3]);
    }
    match (find("R"), find("G"), find("B")) {
        (Some(r), Some(g), Some(b)) => Some([r, g, b]),
        _ => find("Y").or((names.len() == 1).then_some(0)).map(|i| [i; 3]),
    }
}

pub(super) fn decoder(wanted: ir::TextureEncoding, stored: Encoding) -> impl Fn(f32) -> f32 {
    let srgb = SrgbTable::new();
    move |x| match (wanted, stored) {
        (ir::TextureEncoding::Auto, Encoding::Srgb) | (ir::TextureEncoding::Srgb, _) => srgb.decode(x),
        (ir::TextureEncoding::Auto, Encoding::Linear) | (ir::TextureEncoding::Linear, _) => x,
        (ir::TextureEncoding::Gamma(g), _) => x.max(0.0).powf(g as f32),
    }
}

fn wrap(mode: ir::WrapMode) -> Wrap {
    match mode {
        ir::WrapMode::Repeat => Wrap::Repeat,
        ir::WrapMode::Mirror => Wrap::Mirror,
        ir::WrapMode::Clamp => Wrap::Clamp,
        ir::WrapMode::Zero => Wrap::Zero,
        ir::WrapMode::One => Wrap::One,
    }
}

/// A gray of 0.5: Mitsuba's default reflectance.
pub const DEFAULT_REFLECTANCE: Rgb = Rgb::splat(0.5);
