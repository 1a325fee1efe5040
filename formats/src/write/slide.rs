//! Images of projectors: Mitsuba's are irradiance on the plane z = 1, pbrt's are intensity, which is
//! the same times the inverse cube of the cosine to the axis (E = I·cos³ at distance 1).

use std::path::Path;

use super::image::{Pixels, exr};
use super::mesh::stem;
use super::{Output, Sampled, WriteError};
use crate::ir::{Id, LightImage, SpotFalloff, Texture};

/// Pixels of the longer side of a picture that is made: the cosine is even over such a pixel, and a
/// lookup of the nearest one is as good as one that interpolates.
const SIDE: usize = 512;

/// The cone of a spot; half angles in radians.
pub(crate) struct Cone {
    /// No light from here on.
    pub cutoff: f64,
    /// Full light up to here.
    pub beam: f64,
    pub falloff: SpotFalloff,
}

impl Cone {
    /// From half angles in degrees.
    pub fn new(cutoff: f64, beam: f64, falloff: SpotFalloff) -> Self {
        Self { cutoff: cutoff.to_radians(), beam: beam.min(cutoff).to_radians(), falloff }
    }

    /// Its light with another falloff, in parts of its own, less one.
    pub fn change(&self, other: SpotFalloff) -> f64 {
        let (b, c) = (self.beam, self.cutoff);
        let flux = |falloff| {
            let rim = match falloff {
                SpotFalloff::Linear if c > b => b.cos() - (c.sin() - b.sin()) / (c - b),
                SpotFalloff::Linear => 0.0,
                SpotFalloff::Smoothstep => 0.5 * (b.cos() - c.cos()),
                SpotFalloff::Quartic => 0.2 * (b.cos() - c.cos()),
            };
            1.0 - b.cos() + rim
        };
        flux(other) / flux(self.falloff) - 1.0
    }

    /// Share of the light on the axis, at this angle to it.
    fn share(&self, angle: f64) -> f64 {
        if angle >= self.cutoff {
            return 0.0;
        }
        match self.falloff {
            _ if angle <= self.beam => 1.0,
            SpotFalloff::Linear => (self.cutoff - angle) / (self.cutoff - self.beam),
            SpotFalloff::Smoothstep | SpotFalloff::Quartic => {
                let x = (angle.cos() - self.cutoff.cos()) / (self.beam.cos() - self.cutoff.cos());
                let end = if self.falloff == SpotFalloff::Quartic { x * x } else { 3.0 - 2.0 * x };
                x * x * end
            }
        }
    }
}

impl Output<'_> {
    /// The intensity of a texture that gives the irradiance on a picture of `size`; the shorter side of
    /// the picture is at `tangent` of its half angle.
    pub fn slide_intensity(
        &mut self,
        id: Id<Texture>,
        sampled: &Sampled,
        size: [usize; 2],
        tangent: f64,
    ) -> Result<String, WriteError> {
        let key = format!("intensity {} {tangent}", id.index());
        let stem = self.texture_stem(id, "intensity");
        self.make(&key, "textures", &stem, "exr", |_| {
            exr(Path::new(&stem), &fan(size, |uv| sampled.at(uv), tangent, -3))
        })
    }

    /// The intensity of a spot with a texture, on a square picture that spans its cone.
    pub fn spot_intensity(
        &mut self,
        id: Id<Texture>,
        sampled: &Sampled,
        intensity: [f64; 3],
        cone: &Cone,
    ) -> Result<String, WriteError> {
        let tangent = cone.cutoff.tan();
        let key =
            format!("spot {} {intensity:?} {} {} {:?}", id.index(), cone.cutoff, cone.beam, cone.falloff);
        let stem = self.texture_stem(id, "spot");
        self.make(&key, "textures", &stem, "exr", |_| {
            // The picture's u and v run against those of the texture.
            let light = |[u, v]: [f64; 2]| {
                let out = (1.0 - 2.0 * u).hypot(1.0 - 2.0 * v) * tangent;
                let (color, share) = (sampled.at([1.0 - u, 1.0 - v]), cone.share(out.atan()));
                std::array::from_fn(|i| intensity[i] * color[i] * share)
            };
            exr(Path::new(&stem), &fan([SIDE; 2], light, tangent, 0))
        })
    }

    /// As `slide_intensity` of a picture that is 1 everywhere.
    pub fn even_intensity(&mut self, tangent: f64) -> Result<String, WriteError> {
        self.make(&format!("even intensity {tangent}"), "textures", "intensity", "exr", |_| {
            exr(Path::new("intensity"), &fan([1; 2], |_| [1.0; 3], tangent, -3))
        })
    }

    /// The irradiance of a picture whose nearest pixel gives the intensity.
    pub fn slide_irradiance(&mut self, light: &LightImage, tangent: f64) -> Result<String, WriteError> {
        let LightImage { path, encoding, .. } = light;
        let key = format!("irradiance {path:?} {encoding:?} {tangent}");
        self.make(&key, "textures", &format!("{}-irradiance", stem(path)), "exr", |output| {
            let pixels = output.pixels(path, *encoding, None)?;
            exr(path, &fan([pixels.width, pixels.height], |uv| pixels.nearest(uv), tangent, 3))
        })
    }
}

/// A picture finer than `size`, times a power of the cosine between its pixel and the axis.
fn fan(size: [usize; 2], lookup: impl Fn([f64; 2]) -> [f64; 3], tangent: f64, power: i32) -> Pixels {
    let times = SIDE.div_ceil(size[0].max(size[1]));
    let [width, height] = size.map(|n| n * times);
    let shorter = width.min(height) as f64;
    let mut rgb = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let along = |i: usize, n: usize| (2 * i + 1) as f64 / n as f64;
            let plane = |i: usize, n: usize| (along(i, n) - 1.0) * tangent * n as f64 / shorter;
            let (px, py) = (plane(x, width), plane(y, height));
            let factor = (1.0 + px * px + py * py).sqrt().recip().powi(power);
            let uv = [along(x, width) / 2.0, along(y, height) / 2.0];
            rgb.push(lookup(uv).map(|v| v * factor));
        }
    }
    Pixels { width, height, rgb }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::WrapMode;

    /// Light by the sum over thin rings, for a wide rim: the closed form is the same.
    #[test]
    fn the_change_of_falloff_is_that_of_the_light() {
        let cone = |falloff| Cone { cutoff: 1.0, beam: 0.2, falloff };
        let sum = |cone: &Cone| -> f64 {
            (0..10_000).map(|i| (f64::from(i) + 0.5) / 10_000.0).map(|a| a.sin() * cone.share(a)).sum()
        };
        let all = [SpotFalloff::Linear, SpotFalloff::Smoothstep, SpotFalloff::Quartic];
        for (from, to) in all.into_iter().flat_map(|from| all.map(|to| (from, to))) {
            let right = sum(&cone(to)) / sum(&cone(from)) - 1.0;
            let change = cone(from).change(to);
            assert!((change - right).abs() < 1e-6, "{from:?} to {to:?}: {change} {right}");
            assert!(from == to || right.abs() > 0.05, "{right}");
        }
    }

    /// Two pixels, 0 and 1: at the left border, a hair inside, the left one is mixed half and half with
    /// what lies beyond.
    #[test]
    fn the_border_of_a_picture_follows_its_wrapping() {
        let picture = Pixels { width: 2, height: 1, rgb: vec![[0.0; 3], [1.0; 3]] };
        let at = |wrap| {
            let made = fan([2, 1], |uv| picture.bilinear(uv, [wrap; 2]), 0.0, 1);
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
        let size = [side, side / 2];
        let there = fan(size, |uv| picture.nearest(uv), 1.0, -3);
        let back = fan(size, |uv| there.nearest(uv), 1.0, 3);
        let pairs = picture.rgb.as_flattened().iter().zip(back.rgb.as_flattened());
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
        // The longer side reaches 2 where the shorter one is at 1; the pixel's middle is half a pixel in.
        let (x, y) = (2.0 * (1.0 - 1.0 / side as f64), 1.0 - 2.0 / side as f64);
        assert!((there.rgb[0][0] - (1.0 + x * x + y * y).powf(1.5)).abs() < 1e-9);
    }
}
