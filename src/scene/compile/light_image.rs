//! Pictures that emit.

use caustica_formats::image;
use caustica_formats::ir;

use super::Compiler;
use super::textures::{channels, decoder};
use crate::emitter::Picture;

impl Compiler<'_> {
    /// Decoded and scaled; `illuminance` is the caller's matter.
    pub(super) fn light_image(&mut self, l: &ir::LightImage, origin: ir::Origin) -> Option<Picture> {
        let name = l.path.display();
        let read = self
            .files
            .read(&l.path)
            .map_err(|e| e.to_string())
            .and_then(|bytes| image::read(&bytes).map_err(|e| e.to_string()));
        let picture = match read {
            Ok(picture) => picture,
            Err(e) => {
                self.error(format!("cannot read picture `{name}`: {e}"), origin);
                return None;
            }
        };
        let Some(channels) = channels(&picture.channels, None) else {
            let known = picture.channels.join(", ");
            self.error(format!("picture `{name}` has channels {known}, none of them usable"), origin);
            return None;
        };
        let decode = decoder(l.encoding, picture.encoding);
        let pixels = picture.data.chunks_exact(picture.channels.len());
        let texels = pixels.map(|p| channels.map(|c| decode(p[c]) * l.scale as f32)).collect();
        Some(Picture::new(picture.width, picture.height, texels))
    }
}
