//! What a picture shows as a texture or as a light.

use crate::image::{Encoding, Image};
use crate::ir::TextureEncoding;
use crate::spectrum::srgb_to_linear;

/// Linear red, green and blue of every pixel, row by row from the top. A `channel` (`r g b a`) is shown as gray, where
/// the picture has it.
pub fn linear_rgb(image: &Image, encoding: TextureEncoding, channel: Option<char>) -> Vec<[f64; 3]> {
    let named = |c: char| image.channel(&c.to_ascii_uppercase().to_string());
    let places = match channel.and_then(named) {
        Some(place) => [place; 3],
        None => image.rgb().unwrap_or([0; 3]),
    };
    let decode = |v: f32| {
        let v = f64::from(v);
        match encoding {
            TextureEncoding::Auto if image.encoding == Encoding::Linear => v,
            TextureEncoding::Linear => v,
            TextureEncoding::Auto | TextureEncoding::Srgb => srgb_to_linear(v),
            TextureEncoding::Gamma(gamma) => v.max(0.0).powf(gamma),
        }
    };
    let pixels = image.data.chunks_exact(image.channels.len().max(1));
    pixels.map(|pixel| places.map(|place| decode(pixel[place]))).collect()
}
