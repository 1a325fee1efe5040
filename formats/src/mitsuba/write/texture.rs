//! Textures.

use super::Writer;
use super::color::rgb_element;
use super::element::Element;
use crate::ir::{
    AreaEmission, Bitmap, ColorInput, ColorSlot, FloatInput, Id, Mapping, MixAmount, Origin, Texture,
    TextureEncoding, TextureFilter, TextureKind, Transform, WrapMode, exchanges_numbers,
};
use crate::spectrum::luminance;
use crate::write::{Sampled, Tone, WriteError};

/// Most elements of a texture that is copied to apply a factor. The copy includes everything it refers to, which may
/// double at each level of a checkerboard.
const LARGEST_COPY: usize = 1000;

/// What is written for a texture.
#[derive(Clone)]
pub(super) enum Said {
    Plugin(Element),
    Constant([f64; 3]),
}

impl Writer<'_, '_> {
    /// The texture at the top level, unless it reduces to a colour.
    pub fn texture_definition(&mut self, id: Id<Texture>) -> Result<Option<Element>, WriteError> {
        Ok(match self.said(id, [1.0; 3])? {
            Said::Plugin(element) => Some(element.id(self.ids.textures[id.index()].as_deref())),
            Said::Constant(_) => None,
        })
    }

    /// The texture as parameter `name`: a reference where it is shared, otherwise the texture itself.
    pub fn texture(&mut self, name: &str, id: Id<Texture>) -> Result<Element, WriteError> {
        self.scaled_texture(name, id, 1.0)
    }

    pub fn scaled_texture(
        &mut self,
        name: &str,
        id: Id<Texture>,
        factor: f64,
    ) -> Result<Element, WriteError> {
        let said = self.said(id, [factor; 3])?;
        Ok(match (said, &self.ids.textures[id.index()]) {
            (Said::Constant(rgb), _) => rgb_element(name, rgb),
            (Said::Plugin(_), Some(shared)) if factor == 1.0 => {
                Element::new("ref").with("id", shared.as_str()).with("name", name)
            }
            (Said::Plugin(element), _) => element.with("name", name),
        })
    }

    /// The light of a lamp times its opacity, where either is textured.
    pub fn masked_light(
        &mut self,
        e: &AreaEmission,
        scale: f64,
        opacity: Option<&FloatInput>,
    ) -> Result<Element, WriteError> {
        let factor = [scale * self.light; 3];
        let radiance = match &e.radiance {
            ColorInput::Color(color) => {
                Some(Sampled::Constant(self.rgb(color, ColorSlot::Emission, e.origin)))
            }
            ColorInput::Texture(id) => self.out.sampled(*id)?,
        };
        if let Some(FloatInput::Texture(id)) = opacity
            && let (Some(radiance), Some(opacity)) = (radiance, self.out.sampled(*id)?)
        {
            let light = Sampled::Product(Box::new([radiance, opacity]));
            if !light.repeats() && self.out.any_leaves_the_square()? {
                self.out.lose(
                    e.origin,
                    "the opacity of a light beyond uv 0 to 1",
                    "that from 0 to 1, repeated",
                );
            }
            let name = self.out.make_light(*id, &light, factor)?;
            return Ok(raw_picture(&name).with("name", "radiance"));
        }
        self.out.lose(e.origin, "the opacity of a light that is not by uv", "a mask on its material only");
        match &e.radiance {
            ColorInput::Color(color) => Ok(self.light("radiance", color, scale, e.origin)),
            ColorInput::Texture(id) => self.scaled_texture("radiance", *id, factor[0]),
        }
    }

    pub fn float_texture(&mut self, name: &str, id: Id<Texture>) -> Result<Element, WriteError> {
        Ok(match self.said(id, [1.0; 3])? {
            Said::Constant(rgb) => {
                let value = super::element::number(luminance(rgb));
                Element::new("float").with("name", name).with("value", value)
            }
            Said::Plugin(element) if element.is_checkerboard() && !exchanges_numbers(self.scene) => {
                element.exchanged().with("name", name)
            }
            Said::Plugin(_) => self.texture(name, id)?,
        })
    }

    /// `factor` times a texture as a picture of uv from 0 to 1.
    pub(super) fn squared(
        &mut self,
        id: Id<Texture>,
        sampled: &Sampled,
        what: &str,
        factor: [f64; 3],
        origin: Origin,
    ) -> Result<Element, WriteError> {
        if !sampled.repeats() && self.out.any_leaves_the_square()? {
            self.out.lose(origin, format!("{what}, beyond uv 0 to 1"), "the part from 0 to 1, repeated");
        }
        Ok(raw_picture(&self.out.make_square(id, sampled, factor, true)?))
    }

    /// `factor` times the texture. Made once for each texture and factor, however many refer to it.
    pub(super) fn said(&mut self, id: Id<Texture>, factor: [f64; 3]) -> Result<Said, WriteError> {
        let key = (id, factor.map(f64::to_bits));
        if let Some(said) = self.said.get(&key) {
            return Ok(said.clone());
        }
        let said = self.made(id, factor)?;
        self.said.insert(key, said.clone());
        Ok(said)
    }

    fn made(&mut self, id: Id<Texture>, factor: [f64; 3]) -> Result<Said, WriteError> {
        let scene = self.scene;
        let Texture { origin, kind, .. } = &scene.textures[id];
        let origin = *origin;
        if let Some(what) = unsayable(kind)
            && let Some(sampled) = self.out.sampled(id)?
        {
            if let Sampled::Constant(rgb) = sampled {
                return Ok(Said::Constant(times(factor, rgb)));
            }
            return self.squared(id, &sampled, what, factor, origin).map(Said::Plugin);
        }
        match kind {
            TextureKind::Bitmap(bitmap) => self.bitmap(bitmap, factor, origin).map(Said::Plugin),
            TextureKind::Checkerboard { color0, color1, to_uv } => {
                self.checkerboard([color0, color1], to_uv, factor, origin)
            }
            TextureKind::MappedCheckerboard { color0, color1, mapping } => {
                // pbrt has one cell where Mitsuba has two.
                let to_uv = Transform::scale([0.5, 0.5, 1.0]).after(&self.uv_transform(mapping, origin));
                self.checkerboard([color0, color1], &to_uv, factor, origin)
            }
            TextureKind::Scale { value, factor: more } => self.product([value, more], factor, origin),
            TextureKind::MeshAttribute { name, scale } => {
                if factor[0] != factor[1] || factor[1] != factor[2] {
                    self.out.lose(origin, "the colour factor of a mesh attribute", "its luminance");
                }
                let element = Element::plugin("texture", "mesh_attribute").string("name", name);
                Ok(Said::Plugin(element.float_unless("scale", scale * luminance(factor), 1.0)))
            }
            TextureKind::Grid { color0, color1, line_width, .. } => {
                // A line on either side of each cell's edge, in both directions.
                let inside = (1.0 - 2.0 * line_width).clamp(0.0, 1.0).powi(2);
                self.mean("a grid texture", color0, color1, 1.0 - inside, factor, origin)
            }
            TextureKind::Mix { first, second, amount } => {
                let amount = match amount {
                    MixAmount::Input(FloatInput::Value(amount)) => *amount,
                    _ => 0.5,
                };
                self.mean("a mix of textures", first, second, amount, factor, origin)
            }
            TextureKind::Bilerp { corners, .. } => {
                let mut sum = [0.0; 3];
                for corner in corners {
                    let rgb = self.rgb(corner, ColorSlot::Unbounded, origin);
                    sum = std::array::from_fn(|i| sum[i] + 0.25 * rgb[i]);
                }
                self.out.lose(origin, "a bilerp texture", "the mean of its corners");
                Ok(Said::Constant(times(factor, sum)))
            }
            TextureKind::Dots { inside, outside, .. } => {
                self.mean("a dots texture", inside, outside, 1.0, factor, origin)
            }
            TextureKind::Noise { .. } => {
                self.out.lose(origin, "a noise texture", "the constant 0.5");
                Ok(Said::Constant(factor.map(|v| 0.5 * v)))
            }
        }
    }

    /// `factor` times the product of two inputs.
    fn product(
        &mut self,
        [first, second]: [&ColorInput; 2],
        factor: [f64; 3],
        origin: Origin,
    ) -> Result<Said, WriteError> {
        match (first, second) {
            (ColorInput::Texture(inner), ColorInput::Color(c))
            | (ColorInput::Color(c), ColorInput::Texture(inner)) => {
                let c = self.rgb(c, ColorSlot::Unbounded, origin);
                self.said(*inner, times(factor, c))
            }
            (ColorInput::Color(a), ColorInput::Color(b)) => {
                let a = self.rgb(a, ColorSlot::Unbounded, origin);
                let b = self.rgb(b, ColorSlot::Unbounded, origin);
                Ok(Said::Constant(times(factor, times(a, b))))
            }
            (ColorInput::Texture(a), ColorInput::Texture(b)) => {
                let (a, b) = (*a, *b);
                match self.said(b, [1.0; 3])? {
                    Said::Constant(c) => self.said(a, times(factor, c)),
                    Said::Plugin(_) => {
                        self.out.lose(origin, "a product of two textures", "the first of them");
                        self.said(a, factor)
                    }
                }
            }
        }
    }

    /// The mixture of two inputs' constants; what is textured counts as its own constant or 0.5.
    fn mean(
        &mut self,
        what: &str,
        first: &ColorInput,
        second: &ColorInput,
        amount: f64,
        factor: [f64; 3],
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let mut values = [[0.5; 3]; 2];
        for (value, input) in values.iter_mut().zip([first, second]) {
            match input {
                ColorInput::Color(color) => *value = self.rgb(color, ColorSlot::Unbounded, origin),
                ColorInput::Texture(id) => {
                    if let Said::Constant(rgb) = self.said(*id, [1.0; 3])? {
                        *value = rgb;
                    }
                }
            }
        }
        let rgb = std::array::from_fn(|i| values[0][i] * (1.0 - amount) + values[1][i] * amount);
        self.out.lose(origin, what, "one colour, its mean");
        Ok(Said::Constant(times(factor, rgb)))
    }

    fn checkerboard(
        &mut self,
        colors: [&ColorInput; 2],
        to_uv: &Transform,
        factor: [f64; 3],
        origin: Origin,
    ) -> Result<Said, WriteError> {
        let mut element = Element::plugin("texture", "checkerboard");
        for ((input, name), default) in colors.into_iter().zip(["color0", "color1"]).zip([0.4, 0.2]) {
            let child = if factor == [1.0; 3] {
                self.color_input(name, input, ColorSlot::Reflectance, Some(default), origin)?
            } else {
                Some(match input {
                    ColorInput::Color(color) => {
                        let rgb = self.rgb(color, ColorSlot::Unbounded, origin);
                        rgb_element(name, times(factor, rgb))
                    }
                    ColorInput::Texture(id) => match self.said(*id, factor)? {
                        Said::Plugin(inner) if inner.is_within(LARGEST_COPY) => inner.with("name", name),
                        Said::Plugin(_) => {
                            self.out.lose(origin, "a factor on a very large tree of textures", "gray 0.5");
                            rgb_element(name, times(factor, [0.5; 3]))
                        }
                        Said::Constant(rgb) => rgb_element(name, rgb),
                    },
                })
            };
            element = element.children(child);
        }
        Ok(Said::Plugin(element.transform("to_uv", to_uv)))
    }

    fn bitmap(&mut self, b: &Bitmap, factor: [f64; 3], origin: Origin) -> Result<Element, WriteError> {
        let extension = b.path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let float_image = matches!(extension.as_str(), "exr" | "hdr" | "pfm" | "rgbe");
        let readable = match b.encoding {
            // Mitsuba recognises images by their first bytes, and TGA has no magic number.
            _ if extension == "tga" || !self.out.has_color(&b.path) => false,
            TextureEncoding::Auto | TextureEncoding::Linear => true,
            TextureEncoding::Srgb => !float_image,
            TextureEncoding::Gamma(_) => false,
        };
        let plain = b.channel.is_none() && b.scale == 1.0 && !b.invert && factor == [1.0; 3];
        let (name, raw) = if readable && plain {
            (self.out.carry(&b.path, "textures"), b.encoding == TextureEncoding::Linear)
        } else {
            (self.out.bake(b, Tone::Factor(factor))?, true)
        };
        let filter = match b.filter {
            TextureFilter::Bilinear => None,
            TextureFilter::Nearest => Some("nearest"),
        };
        if b.wrap_u != b.wrap_v {
            self.out.lose(origin, "wrap modes that differ between u and v", "the mode of u");
        }
        let wrap = match b.wrap_u {
            WrapMode::Repeat => None,
            WrapMode::Mirror => Some("mirror"),
            WrapMode::Clamp => Some("clamp"),
            WrapMode::Zero | WrapMode::One => {
                self.out.lose(origin, "a constant colour around the picture", "wrap_mode `clamp`");
                Some("clamp")
            }
        };
        let mut element = Element::plugin("texture", "bitmap").string("filename", &name);
        if let Some(filter) = filter {
            element = element.string("filter_type", filter);
        }
        if let Some(wrap) = wrap {
            element = element.string("wrap_mode", wrap);
        }
        let to_uv = self.uv_transform(&b.mapping, origin);
        Ok(element.boolean_unless("raw", raw, false).transform("to_uv", &to_uv))
    }

    fn uv_transform(&mut self, mapping: &Mapping, origin: Origin) -> Transform {
        let what = match mapping {
            Mapping::Uv(transform) => return *transform,
            Mapping::Spherical { .. } => "a spherical mapping",
            Mapping::Cylindrical { .. } => "a cylindrical mapping",
            Mapping::Planar { .. } => "a planar mapping",
            Mapping::Solid { .. } => "a texture in 3D space",
        };
        self.out.lose(origin, what, "the uv of the surface");
        Transform::IDENTITY
    }

    /// The mean of an input where the language takes one number only.
    pub fn one_number(&mut self, input: &FloatInput, what: &str, origin: Origin) -> Result<f64, WriteError> {
        Ok(match input {
            FloatInput::Value(v) => *v,
            FloatInput::Texture(id) => {
                let scene = self.scene;
                let mean = match (&scene.textures[*id].kind, self.said(*id, [1.0; 3])?) {
                    (_, Said::Constant(rgb)) => luminance(rgb),
                    (TextureKind::Bitmap(bitmap), _) => luminance(self.out.mean(bitmap)?),
                    (TextureKind::Checkerboard { color0, color1, .. }, _) => {
                        let value = |w: &mut Self, input: &ColorInput| match input {
                            ColorInput::Color(c) => luminance(w.rgb(c, ColorSlot::Unbounded, origin)),
                            ColorInput::Texture(_) => 0.5,
                        };
                        0.5 * (value(self, color0) + value(self, color1))
                    }
                    _ => 0.5,
                };
                self.out.lose(origin, format!("a texture for {what}"), format!("its mean, {mean:.6}"));
                mean
            }
        })
    }
}

/// What Mitsuba has no words for, unless as a picture.
fn unsayable(kind: &TextureKind) -> Option<&'static str> {
    match kind {
        TextureKind::Bitmap(b) if b.wrap_u != b.wrap_v => Some("a picture wrapped differently along u and v"),
        TextureKind::Bitmap(b) if matches!(b.wrap_u, WrapMode::Zero | WrapMode::One) => {
            Some("a constant colour around a picture")
        }
        TextureKind::Scale { value: ColorInput::Texture(_), factor: ColorInput::Texture(_) } => {
            Some("a product of textures")
        }
        TextureKind::Grid { .. } => Some("a grid texture"),
        TextureKind::Mix { .. } => Some("a mix of textures"),
        TextureKind::Bilerp { .. } => Some("a bilerp texture"),
        _ => None,
    }
}

/// The values of a float picture by uv.
pub(super) fn raw_picture(name: &str) -> Element {
    Element::plugin("texture", "bitmap").string("filename", name).boolean("raw", true)
}

fn times(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] * b[i])
}
