//! Heights and normals: Mitsuba takes pictures only, with three channels for normals.

use super::Writer;
use super::element::{Element, numbers};
use super::texture::Said;
use crate::ir::{ColorInput, ColorSlot, FloatInput, Id, Origin, Texture, TextureKind};
use crate::write::WriteError;

impl Writer<'_, '_> {
    /// The texture of a bump map; `None` is a flat surface.
    pub fn heights(&mut self, height: &FloatInput, origin: Origin) -> Result<Option<Element>, WriteError> {
        let FloatInput::Texture(id) = *height else { return Ok(None) };
        match self.said(id, [1.0; 3])? {
            Said::Constant(_) => Ok(None),
            Said::Plugin(element) if element.is_a("bitmap") => self.float_texture("height", id).map(Some),
            Said::Plugin(_) => {
                let picture = self.as_picture(id, "a bump map that is no picture", origin)?;
                if picture.is_some() {
                    let instead = "a picture of it, whose edges are a pixel wide";
                    self.out.lose(origin, "a bump map that is no picture", instead);
                } else {
                    self.out.lose(origin, "a bump map that is not by uv", "a flat surface");
                }
                Ok(picture.map(|element| element.with("name", "height")))
            }
        }
    }

    /// The texture of a normal map; `None` after a loss.
    pub fn normals(&mut self, normals: &ColorInput, origin: Origin) -> Result<Option<Element>, WriteError> {
        let constant = |rgb: [f64; 3]| {
            let value = Element::new("vector").with("name", "value").with("value", numbers(&rgb));
            Element::plugin("texture", "rawconstant").with("name", "normalmap").child(value)
        };
        let id = match normals {
            ColorInput::Color(color) => {
                return Ok(Some(constant(self.rgb(color, ColorSlot::Unbounded, origin))));
            }
            ColorInput::Texture(id) => *id,
        };
        let gray = match &self.scene.textures[id].kind {
            TextureKind::Bitmap(b) => self.out.is_gray(&b.path),
            _ => false,
        };
        match self.said(id, [1.0; 3])? {
            Said::Constant(rgb) => return Ok(Some(constant(rgb))),
            Said::Plugin(element) if !gray && (element.is_a("bitmap") || element.is_a("mesh_attribute")) => {
                return self.texture("normalmap", id).map(Some);
            }
            Said::Plugin(_) => {}
        }
        let picture = self.as_picture(id, "a normal map", origin)?;
        if picture.is_none() {
            self.out.lose(origin, "a normal map that is not by uv", "no normal map");
        }
        Ok(picture.map(|element| element.with("name", "normalmap")))
    }

    /// A texture by uv as a float picture of three channels.
    fn as_picture(
        &mut self,
        id: Id<Texture>,
        what: &str,
        origin: Origin,
    ) -> Result<Option<Element>, WriteError> {
        let Some(sampled) = self.out.sampled(id)? else { return Ok(None) };
        self.squared(id, &sampled, what, [1.0; 3], origin).map(Some)
    }
}
