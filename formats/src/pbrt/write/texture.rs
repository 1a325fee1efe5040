//! Textures, named and defined once for colours and once for numbers.

use super::Writer;
use super::picture::sayable;
use super::text::{Params, transform};
use crate::ir::{
    Bitmap, ColorInput, ColorSlot, Id, Mapping, MixAmount, NoiseKind, Origin, Texture, TextureEncoding,
    TextureFilter, TextureKind, Transform, WrapMode, exchanges_numbers,
};
use crate::spectrum::luminance;
use crate::write::{Tone, WriteError};

/// Plugin, parameters, and the texture space (world → texture) where it has one.
type Said = (&'static str, Params, Option<Transform>);

impl Writer<'_, '_> {
    /// The name of a texture that is defined by then.
    pub fn texture(&mut self, id: Id<Texture>, numbers: bool) -> Result<String, WriteError> {
        if let Some(name) = self.textures.get(&(id, numbers)) {
            return Ok(name.clone());
        }
        let scene = self.scene;
        let Texture { name, origin, kind } = &scene.textures[id];
        let said = self.said_texture(id, kind, numbers, *origin)?;
        let name = self.free(name, "texture");
        self.define(&name, numbers, said, *origin);
        self.textures.insert((id, numbers), name.clone());
        Ok(name)
    }

    /// A texture of numbers or of colours times a factor.
    pub fn scaled_texture(
        &mut self,
        id: Id<Texture>,
        factor: f64,
        numbers: bool,
    ) -> Result<String, WriteError> {
        let plain = self.texture(id, numbers)?;
        if factor == 1.0 {
            return Ok(plain);
        }
        let name = self.free(&None, "scaled");
        let p = Params::default().texture("tex", &plain).float("scale", factor);
        self.define(&name, numbers, ("scale", p, None), self.scene.textures[id].origin);
        Ok(name)
    }

    /// A picture in other colours; `None` for a texture that is no picture.
    pub fn toned_texture(&mut self, id: Id<Texture>, tone: Tone) -> Result<Option<String>, WriteError> {
        let Texture { origin, kind: TextureKind::Bitmap(bitmap), .. } = &self.scene.textures[id] else {
            return Ok(None);
        };
        let said = self.bitmap(bitmap, Some(tone), *origin)?;
        let name = self.free(&None, "toned");
        self.define(&name, false, said, *origin);
        Ok(Some(name))
    }

    fn define(&mut self, name: &str, numbers: bool, (plugin, p, space): Said, origin: Origin) {
        let mut text = String::new();
        self.place(&mut text, "", origin);
        let kind = if numbers { "float" } else { "spectrum" };
        match space.and_then(|to_texture| to_texture.inverse()) {
            Some(to_world) if to_world != Transform::IDENTITY => {
                text.push_str("AttributeBegin\n");
                transform(&mut text, "\t", &to_world);
                p.write(&mut text, "\t", "Texture", &[name, kind, plugin]);
                text.push_str("AttributeEnd\n");
            }
            _ => p.write(&mut text, "", "Texture", &[name, kind, plugin]),
        }
        self.definitions.push_str(&text);
    }

    /// A value of the texture's kind.
    fn operand(
        &mut self,
        p: Params,
        name: &str,
        input: &ColorInput,
        numbers: bool,
        origin: Origin,
    ) -> Result<Params, WriteError> {
        match input {
            ColorInput::Color(color) if numbers => {
                let rgb = self.out.rgb(color, ColorSlot::Unbounded, origin);
                let gray = rgb[0] == rgb[1] && rgb[1] == rgb[2];
                Ok(p.float(name, if gray { rgb[0] } else { luminance(rgb) }))
            }
            ColorInput::Texture(id) => {
                let texture = self.texture(*id, numbers)?;
                Ok(p.texture(name, &texture))
            }
            ColorInput::Color(color) => {
                let rgb = self.out.rgb(color, ColorSlot::Unbounded, origin);
                let rgb = self.within(rgb, ColorSlot::Unbounded, origin);
                let most = rgb.into_iter().fold(0.0, f64::max);
                if most <= 1.0 {
                    return Ok(p.rgb(name, rgb));
                }
                // pbrt takes every texture as one of reflectances, too, and refuses colours above 1.
                let dim = self.free(&None, "color");
                let color = Params::default().rgb("value", rgb.map(|v| v / most));
                self.define(&dim, false, ("constant", color, None), origin);
                let bright = self.free(&None, "bright");
                let scale = Params::default().texture("tex", &dim).float("scale", most);
                self.define(&bright, false, ("scale", scale, None), origin);
                Ok(p.texture(name, &bright))
            }
        }
    }

    fn said_texture(
        &mut self,
        id: Id<Texture>,
        kind: &TextureKind,
        numbers: bool,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let none = Params::default();
        if let Some(what) = self.unsayable(kind, numbers, origin)
            && let Some(p) = self.baked(id, what, origin)?
        {
            return Ok(("imagemap", p, None));
        }
        match kind {
            TextureKind::Bitmap(bitmap) => self.bitmap(bitmap, None, origin),
            TextureKind::Checkerboard { color0, color1, to_uv } => {
                // Two cells where pbrt has one.
                let mapping = Mapping::Uv(Transform::scale([2.0, 2.0, 1.0]).after(to_uv));
                let exchanged = numbers && exchanges_numbers(self.scene);
                let colors = if exchanged { [color1, color0] } else { [color0, color1] };
                self.checkerboard(colors, &mapping, numbers, origin)
            }
            TextureKind::MappedCheckerboard { color0, color1, mapping } => {
                self.checkerboard([color0, color1], mapping, numbers, origin)
            }
            TextureKind::Scale { value, factor } => {
                // The factor is a number in pbrt; the order of the product does not matter.
                let (value, factor) =
                    if self.colored(factor, origin) { (factor, value) } else { (value, factor) };
                if self.colored(factor, origin) && !numbers {
                    self.out.lose(origin, "a colour times a colour", "the first times a number");
                }
                let p = self.operand(none, "tex", value, numbers, origin)?;
                Ok(("scale", self.operand(p, "scale", factor, true, origin)?, None))
            }
            TextureKind::Mix { first, second, amount: MixAmount::Input(amount) } => {
                let p = self.operand(none, "tex1", first, numbers, origin)?;
                let p = self.operand(p, "tex2", second, numbers, origin)?;
                Ok(("mix", self.float_input(p, "amount", amount)?, None))
            }
            TextureKind::Mix { first, second, amount: MixAmount::Direction(direction) } => {
                let p = self.operand(none, "tex1", second, numbers, origin)?;
                let p = self.operand(p, "tex2", first, numbers, origin)?;
                Ok(("directionmix", p.numbers("vector3", "dir", *direction), None))
            }
            TextureKind::Bilerp { corners, mapping } => {
                let mut p = none;
                for (name, corner) in ["v00", "v01", "v10", "v11"].into_iter().zip(corners) {
                    // No texture may stand here, and pbrt takes every texture as one of reflectances, too.
                    if numbers {
                        p = self.operand(p, name, &ColorInput::Color(corner.clone()), numbers, origin)?;
                    } else {
                        p = self.color(p, name, corner, ColorSlot::Reflectance, origin);
                    }
                }
                let (p, space) = self.mapped(p, mapping, origin);
                Ok(("bilerp", p, space))
            }
            TextureKind::Dots { inside, outside, mapping } => {
                // The wrong way round, as pbrt reads them.
                let p = self.operand(none, "inside", outside, numbers, origin)?;
                let p = self.operand(p, "outside", inside, numbers, origin)?;
                let (p, space) = self.mapped(p, mapping, origin);
                Ok(("dots", p, space))
            }
            TextureKind::Noise { kind, to_texture } => self.noise(*kind, *to_texture, numbers, origin),
            TextureKind::MeshAttribute { name, .. } => {
                let what = format!("the mesh attribute `{name}`");
                self.out.lose(origin, what, "the constant 0.5");
                self.constant([0.5; 3], numbers)
            }
            TextureKind::Grid { color0, .. } => {
                self.out.lose(origin, "a grid texture", "the colour between its lines");
                let p = self.operand(none, "value", color0, numbers, origin)?;
                Ok(("constant", p, None))
            }
        }
    }

    fn colored(&mut self, input: &ColorInput, origin: Origin) -> bool {
        match input {
            ColorInput::Color(color) => {
                let rgb = self.out.rgb(color, ColorSlot::Unbounded, origin);
                rgb[0] != rgb[1] || rgb[1] != rgb[2]
            }
            ColorInput::Texture(_) => false,
        }
    }

    /// What pbrt has no words for, unless as a picture.
    fn unsayable(&mut self, kind: &TextureKind, numbers: bool, origin: Origin) -> Option<&'static str> {
        match kind {
            TextureKind::Bitmap(b) if !sayable(b) => Some("a picture turned or wrapped as pbrt cannot"),
            TextureKind::Grid { .. } => Some("a grid texture"),
            TextureKind::Checkerboard { to_uv, .. } if diagonal(to_uv).is_none() => {
                Some("a rotated or sheared checkerboard")
            }
            TextureKind::Scale { value, factor }
                if !numbers && self.colored(value, origin) && self.colored(factor, origin) =>
            {
                Some("a colour times a colour")
            }
            _ => None,
        }
    }

    fn noise(
        &mut self,
        kind: NoiseKind,
        to_texture: Transform,
        numbers: bool,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let none = Params::default();
        let marble = matches!(kind, NoiseKind::Marble { .. });
        if marble == numbers {
            let what = "a noise texture of a type that pbrt does not have";
            self.out.lose(origin, what, "the constant 0.5");
            return self.constant([0.5; 3], numbers);
        }
        let octaves = |p: Params, n: u32, r: f64| p.integer("octaves", n.into()).float("roughness", r);
        let (plugin, p) = match kind {
            NoiseKind::Fbm { octaves: n, roughness } => ("fbm", octaves(none, n, roughness)),
            NoiseKind::Wrinkled { octaves: n, roughness } => ("wrinkled", octaves(none, n, roughness)),
            NoiseKind::Windy => ("windy", none),
            NoiseKind::Marble { octaves: n, roughness, scale, variation } => {
                let p = octaves(none, n, roughness);
                ("marble", p.float("scale", scale).float("variation", variation))
            }
        };
        Ok((plugin, p, Some(to_texture)))
    }

    fn constant(&mut self, rgb: [f64; 3], numbers: bool) -> Result<Said, WriteError> {
        let p = Params::default();
        Ok(("constant", if numbers { p.float("value", rgb[0]) } else { p.rgb("value", rgb) }, None))
    }

    fn checkerboard(
        &mut self,
        [a, b]: [&ColorInput; 2],
        mapping: &Mapping,
        numbers: bool,
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let p = self.operand(Params::default(), "tex1", a, numbers, origin)?;
        let p = self.operand(p, "tex2", b, numbers, origin)?;
        let (p, space) = self.mapped(p, mapping, origin);
        Ok(("checkerboard", p, space))
    }

    fn mapped(&mut self, p: Params, mapping: &Mapping, origin: Origin) -> (Params, Option<Transform>) {
        match mapping {
            Mapping::Uv(m) => match diagonal(m) {
                Some([su, sv, du, dv]) => {
                    let p = p.float_unless("uscale", su, 1.0).float_unless("vscale", sv, 1.0);
                    (p.float_unless("udelta", du, 0.0).float_unless("vdelta", dv, 0.0), None)
                }
                None => {
                    self.out.lose(
                        origin,
                        "a rotated or sheared texture",
                        "the texture without rotation or shear",
                    );
                    (p, None)
                }
            },
            Mapping::Spherical { to_texture } => (p.string("mapping", "spherical"), Some(*to_texture)),
            Mapping::Cylindrical { to_texture } => (p.string("mapping", "cylindrical"), Some(*to_texture)),
            Mapping::Planar { to_texture, axes, offset } => {
                let p = p.string("mapping", "planar").numbers("vector3", "v1", axes[0]);
                let p = p.numbers("vector3", "v2", axes[1]);
                let p = p.float_unless("udelta", offset[0], 0.0).float_unless("vdelta", offset[1], 0.0);
                (p, Some(*to_texture))
            }
            Mapping::Solid { to_texture } => (p.integer("dimension", 3), Some(*to_texture)),
        }
    }

    fn bitmap(&mut self, b: &Bitmap, tone: Option<Tone>, origin: Origin) -> Result<Said, WriteError> {
        // pbrt goes by the name of a file.
        let other = b.channel.is_some() || !self.out.is_well_named(&b.path);
        let tone = tone.or(other.then_some(Tone::Factor([1.0; 3])));
        let name = match tone {
            Some(tone) => self.out.bake(b, tone)?,
            None => self.out.carry(&b.path, "textures"),
        };
        let mut p = Params::default().string("filename", &name);
        if b.wrap_u != b.wrap_v {
            self.out.lose(origin, "wrap modes that differ between u and v", "the mode of u");
        }
        p = match b.wrap_u {
            WrapMode::Repeat => p,
            WrapMode::Clamp => p.string("wrap", "clamp"),
            WrapMode::Zero => p.string("wrap", "black"),
            WrapMode::Mirror => {
                self.out.lose(origin, "mirrored repetition", "plain repetition");
                p
            }
            WrapMode::One => {
                self.out.lose(origin, "white around the picture", "wrap `clamp`");
                p.string("wrap", "clamp")
            }
        };
        p = p.string("filter", if b.filter == TextureFilter::Nearest { "point" } else { "bilinear" });
        if tone.is_none() {
            p = match b.encoding {
                TextureEncoding::Auto => p,
                TextureEncoding::Linear => p.string("encoding", "linear"),
                TextureEncoding::Srgb => p.string("encoding", "sRGB"),
                TextureEncoding::Gamma(gamma) => p.string("encoding", &format!("gamma {gamma}")),
            };
            p = p.float_unless("scale", b.scale, 1.0).boolean_unless("invert", b.invert, false);
        }
        let (p, space) = self.mapped(p, &super::super::texture::upside_down(b.mapping), origin);
        Ok(("imagemap", p, space))
    }
}

/// [uscale, vscale, udelta, vdelta].
fn diagonal(Transform(m): &Transform) -> Option<[f64; 4]> {
    (m[0][1] == 0.0 && m[1][0] == 0.0).then(|| [m[0][0], m[1][1], m[0][3], m[1][3]])
}
