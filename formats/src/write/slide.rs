//! Images of projectors: Mitsuba's are irradiance on the plane z = 1, pbrt's are intensity, which is
//! the same times the inverse cube of the cosine to the axis (E = I·cos³ at distance 1).

use std::path::Path;

use super::image::{Pixels, exr};
use super::mesh::stem;
use super::{Output, WriteError};
use crate::ir::{Bitmap, LightImage, TextureFilter};

/// Pixels of the longer side of a picture that is made: the cosine is even over such a pixel, and a
/// lookup of the nearest one is as good as one that interpolates.
const SIDE: usize = 512;

impl Output<'_> {
    /// The intensity of a picture that gives the irradiance, read as its filter and wrapping say; the
    /// shorter side of the picture is at `tangent` of its half angle.
    pub fn slide_intensity(&mut self, bitmap: &Bitmap, tangent: f64) -> Result<String, WriteError> {
        let Bitmap { path, encoding, channel, scale, invert, filter, wrap_u, wrap_v, .. } = bitmap;
        let wrap = [*wrap_u, *wrap_v];
        let key = format!(
            "intensity {path:?} {encoding:?} {channel:?} {scale} {invert} {filter:?} {wrap:?} {tangent}"
        );
        self.make(&key, "textures", &format!("{}-intensity", stem(path)), "exr", |output| {
            let mut pixels = output.pixels(path, *encoding, *channel)?;
            for value in pixels.rgb.as_flattened_mut() {
                let scaled = *value * scale;
                *value = if *invert { (1.0 - scaled).max(0.0) } else { scaled };
            }
            let lookup = |pixels: &Pixels, uv| match filter {
                TextureFilter::Nearest => pixels.nearest(uv),
                TextureFilter::Bilinear => pixels.bilinear(uv, wrap),
            };
            exr(path, &fan(&pixels, lookup, tangent, -3))
        })
    }

    /// As `slide_intensity` of a picture that is 1 everywhere.
    pub fn even_intensity(&mut self, tangent: f64) -> Result<String, WriteError> {
        self.make(&format!("even intensity {tangent}"), "textures", "intensity", "exr", |_| {
            let one = Pixels { width: 1, height: 1, rgb: vec![[1.0; 3]] };
            exr(Path::new("intensity"), &fan(&one, Pixels::nearest, tangent, -3))
        })
    }

    /// The irradiance of a picture whose nearest pixel gives the intensity.
    pub fn slide_irradiance(&mut self, light: &LightImage, tangent: f64) -> Result<String, WriteError> {
        let LightImage { path, encoding, .. } = light;
        let key = format!("irradiance {path:?} {encoding:?} {tangent}");
        self.make(&key, "textures", &format!("{}-irradiance", stem(path)), "exr", |output| {
            exr(path, &fan(&output.pixels(path, *encoding, None)?, Pixels::nearest, tangent, 3))
        })
    }

    /// Width over height of a picture.
    pub fn aspect(&self, path: &Path) -> Result<f64, WriteError> {
        let image = self.image(path)?;
        Ok(image.width as f64 / image.height as f64)
    }
}

/// A finer picture, times a power of the cosine between its pixel and the axis.
fn fan(from: &Pixels, lookup: impl Fn(&Pixels, [f64; 2]) -> [f64; 3], tangent: f64, power: i32) -> Pixels {
    let times = SIDE.div_ceil(from.width.max(from.height));
    let (width, height) = (from.width * times, from.height * times);
    let shorter = width.min(height) as f64;
    let mut rgb = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let along = |i: usize, n: usize| (2 * i + 1) as f64 / n as f64;
            let plane = |i: usize, n: usize| (along(i, n) - 1.0) * tangent * n as f64 / shorter;
            let (px, py) = (plane(x, width), plane(y, height));
            let factor = (1.0 + px * px + py * py).sqrt().recip().powi(power);
            let uv = [along(x, width) / 2.0, along(y, height) / 2.0];
            rgb.push(lookup(from, uv).map(|v| v * factor));
        }
    }
    Pixels { width, height, rgb }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::WrapMode;

    /// Two pixels, 0 and 1: at the left border, a hair inside, the left one is mixed half and half with
    /// what lies beyond.
    #[test]
    fn the_border_of_a_picture_follows_its_wrapping() {
        let picture = Pixels { width: 2, height: 1, rgb: vec![[0.0; 3], [1.0; 3]] };
        let at = |wrap| {
            let made = fan(&picture, |pixels: &Pixels, uv| pixels.bilinear(uv, [wrap; 2]), 0.0, 1);
            made.rgb[made.width * made.height / 2][0]
        };
        // The middle of the first of 512 pixels is 1/512 of a pixel of the picture from the border.
        let inside = 1.0 / SIDE as f64;
        assert!((at(WrapMode::Repeat) - (0.5 - inside)).abs() < 1e-12);
        assert!(at(WrapMode::Clamp).abs() < 1e-12);
        assert!(at(WrapMode::Mirror).abs() < 1e-12);
        assert!(at(WrapMode::Zero).abs() < 1e-12);
    }

    /// Both ways undo each other; a corner of a 90° picture is at cos = 1/√3.
    #[test]
    fn intensity_and_irradiance_are_inverse() {
        let side = SIDE;
        let rgb = (0..side * side / 2).map(|i| [1.0, (i % 7) as f64, (i % 5) as f64]).collect();
        let picture = Pixels { width: side, height: side / 2, rgb };
        let there = fan(&picture, Pixels::nearest, 1.0, -3);
        let back = fan(&there, Pixels::nearest, 1.0, 3);
        let pairs = picture.rgb.as_flattened().iter().zip(back.rgb.as_flattened());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
        // The longer side reaches 2 where the shorter one is at 1; the pixel's middle is half a pixel in.
        let (x, y) = (2.0 * (1.0 - 1.0 / side as f64), 1.0 - 2.0 / side as f64);
        assert!((there.rgb[0][0] - (1.0 + x * x + y * y).powf(1.5)).abs() < 1e-9);
    }
}
