//! Images that have to be generated: baked textures, and environments in the other mapping.

use std::f64::consts::{FRAC_PI_4, PI, TAU};
use std::path::Path;
use std::rc::Rc;

use super::mesh::stem;
use super::{Output, WriteError};
use crate::image::{self, ExrLayer, ExrOptions, Image};
use crate::ir::{Bitmap, EnvironmentMapping, LightImage, TextureEncoding, WrapMode};
use crate::picture::linear_rgb;
use crate::spectrum::luminance;

/// What a baked texture's colours become.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tone {
    Factor([f64; 3]),
    /// The base that, below a coat which reflects this share of diffuse light back at it, looks like one whose
    /// bounces below the coat are all white (`plastic` without `nonlinear`): ρ'/(1 − ρ'F) = ρ/(1 − F).
    UnderCoat(f64),
}

impl Tone {
    pub fn of(self, rgb: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Factor(factor) => std::array::from_fn(|i| rgb[i] * factor[i]),
            Self::UnderCoat(internal) => rgb.map(|rho| rho / (1.0 - internal + rho * internal)),
        }
    }
}

/// Decoded linear RGB, row 0 at the top.
pub(crate) struct Pixels {
    pub width: usize,
    pub height: usize,
    pub rgb: Vec<[f64; 3]>,
}

impl Pixels {
    /// u to the right, v down, both from 0 to 1; `wrap` says what lies beyond the borders of each.
    pub fn bilinear(&self, [u, v]: [f64; 2], wrap: [WrapMode; 2]) -> [f64; 3] {
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        self.mix(x, y, |x, y| match (wrapped(x, self.width, wrap[0]), wrapped(y, self.height, wrap[1])) {
            (Ok(x), Ok(y)) => self.rgb[y * self.width + x],
            (Err(beyond), _) | (_, Err(beyond)) => [beyond; 3],
        })
    }

    pub fn nearest(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let inside = |t: f64, n: usize| ((t * n as f64) as usize).min(n - 1);
        self.rgb[inside(v, self.height) * self.width + inside(u, self.width)]
    }

    /// As `bilinear`, of the pixel that the place lies in.
    pub fn nearest_wrapped(&self, [u, v]: [f64; 2], wrap: [WrapMode; 2]) -> [f64; 3] {
        let (x, y) = ((u * self.width as f64).floor() as i64, (v * self.height as f64).floor() as i64);
        match (wrapped(x, self.width, wrap[0]), wrapped(y, self.height, wrap[1])) {
            (Ok(x), Ok(y)) => self.rgb[y * self.width + x],
            (Err(beyond), _) | (_, Err(beyond)) => [beyond; 3],
        }
    }

    /// Between the four pixels around a place, in pixels.
    fn mix(&self, x: f64, y: f64, at: impl Fn(i64, i64) -> [f64; 3]) -> [f64; 3] {
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        let (a, b, c, d) = (at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1));
        std::array::from_fn(|i| {
            (a[i] * (1.0 - fx) + b[i] * fx) * (1.0 - fy) + (c[i] * (1.0 - fx) + d[i] * fx) * fy
        })
    }
}

/// The index of a pixel in or beyond a row of `n`, or the value there.
fn wrapped(i: i64, n: usize, wrap: WrapMode) -> Result<usize, f64> {
    let n = n as i64;
    match wrap {
        _ if (0..n).contains(&i) => Ok(i as usize),
        WrapMode::Repeat => Ok(i.rem_euclid(n) as usize),
        WrapMode::Mirror => {
            let i = i.rem_euclid(2 * n);
            Ok(if i < n { i } else { 2 * n - 1 - i } as usize)
        }
        WrapMode::Clamp => Ok(i.clamp(0, n - 1) as usize),
        WrapMode::Zero => Err(0.0),
        WrapMode::One => Err(1.0),
    }
}

impl Output<'_> {
    pub(super) fn image(&self, path: &Path) -> Result<Rc<Image>, WriteError> {
        self.files.image(path)
    }

    /// Whether a picture shows gray only; false where it cannot be read.
    pub fn is_gray(&self, path: &Path) -> bool {
        self.image(path).is_ok_and(|image| image.rgb().is_some_and(|[r, g, _]| r == g))
    }

    /// Whether every reader finds colours or gray in a picture: an EXR may call its channels anything. True where it
    /// cannot be read.
    pub fn has_color(&self, path: &Path) -> bool {
        let exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        let named = |image: &Image| ["Y", "R"].iter().any(|name| image.channel(name).is_some());
        !exr || self.image(path).map_or(true, |image| image.rgb().is_none() || named(&image))
    }

    /// Whether the name of a picture says what is in it, for readers that go by it; true where it cannot be read.
    pub fn is_well_named(&self, path: &Path) -> bool {
        let starts: &[&[u8]] =
            match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
                Some("exr") => &[b"\x76\x2f\x31\x01"],
                Some("png") => &[b"\x89PNG"],
                Some("pfm") => &[b"PF", b"Pf"],
                Some("hdr") => &[b"#?"],
                _ => return true,
            };
        self.read(path).map_or(true, |bytes| starts.iter().any(|start| bytes.starts_with(start)))
    }

    pub(super) fn pixels(
        &self,
        path: &Path,
        encoding: TextureEncoding,
        channel: Option<char>,
    ) -> Result<Pixels, WriteError> {
        let image = self.image(path)?;
        let rgb = linear_rgb(&image, encoding, channel);
        Ok(Pixels { width: image.width, height: image.height, rgb })
    }

    /// A float image of the texture's values, changed by `tone`, to be read without decoding.
    pub fn bake(&mut self, bitmap: &Bitmap, tone: Tone) -> Result<String, WriteError> {
        let Bitmap { path, encoding, channel, scale, invert, .. } = bitmap;
        let key = format!("bitmap {path:?} {encoding:?} {channel:?} {scale} {invert} {tone:?}");
        self.make(&key, "textures", &format!("{}-baked", stem(path)), "exr", |output| {
            let mut pixels = output.pixels(path, *encoding, *channel)?;
            for pixel in &mut pixels.rgb {
                for value in pixel.iter_mut() {
                    let scaled = *value * scale;
                    *value = if *invert { (1.0 - scaled).max(0.0) } else { scaled };
                }
                *pixel = tone.of(*pixel);
            }
            exr(path, &pixels)
        })
    }

    /// The mean of a texture over its picture.
    pub fn mean(&self, bitmap: &Bitmap) -> Result<[f64; 3], WriteError> {
        let pixels = self.pixels(&bitmap.path, bitmap.encoding, bitmap.channel)?;
        let mut sum = [0.0; 3];
        for pixel in &pixels.rgb {
            sum = std::array::from_fn(|i| sum[i] + pixel[i]);
        }
        let count = pixels.rgb.len().max(1) as f64;
        Ok(sum.map(|v| {
            let mean = v / count * bitmap.scale;
            if bitmap.invert { 1.0 - mean } else { mean }
        }))
    }

    /// Luminance of the mean of a light's picture.
    pub fn mean_light(&self, light: &LightImage) -> Result<f64, WriteError> {
        let pixels = self.pixels(&light.path, light.encoding, None)?;
        let sum: f64 = pixels.rgb.iter().map(|rgb| luminance(*rgb)).sum();
        Ok(sum / pixels.rgb.len().max(1) as f64)
    }

    /// A light's picture as plain floats.
    pub fn decode(&mut self, light: &LightImage) -> Result<String, WriteError> {
        let LightImage { path, encoding, .. } = light;
        self.make(&format!("light {path:?} {encoding:?}"), "textures", &stem(path), "exr", |output| {
            exr(path, &output.pixels(path, *encoding, None)?)
        })
    }

    /// The same light with `mapping`, in the same local space.
    pub fn remap(&mut self, light: &LightImage, mapping: EnvironmentMapping) -> Result<String, WriteError> {
        let LightImage { path, encoding, .. } = light;
        let (name, key) = match mapping {
            EnvironmentMapping::LatLong => ("latlong", format!("latlong {path:?} {encoding:?}")),
            EnvironmentMapping::EqualArea => ("equalarea", format!("equalarea {path:?} {encoding:?}")),
        };
        self.make(&key, "textures", &format!("{}-{name}", stem(path)), "exr", |output| {
            let pixels = output.pixels(path, *encoding, None)?;
            exr(path, &resample(&pixels, mapping))
        })
    }
}

pub(super) fn exr(path: &Path, pixels: &Pixels) -> Result<Vec<u8>, WriteError> {
    let data: Vec<f32> = pixels.rgb.as_flattened().iter().map(|v| *v as f32).collect();
    let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &data };
    image::encode_exr(pixels.width, pixels.height, &[layer], &[], ExrOptions::default())
        .map_err(|e| WriteError::Asset { path: path.to_path_buf(), reason: e.to_string() })
}

/// Samples across a new pixel in each direction.
const SUBSAMPLES: usize = 4;

/// Rows of the resampled picture. pbrt shows the nearest texel, so a small picture becomes four times as fine; a
/// large one keeps the texels as small as they are on the equator, π/H against the √(4π)/side of equal areas.
fn rows(from: &Pixels, mapping: EnvironmentMapping) -> usize {
    let ratio = match mapping {
        EnvironmentMapping::LatLong => (PI / 4.0).sqrt(),
        EnvironmentMapping::EqualArea => (4.0 / PI).sqrt(),
    };
    let alike = (from.height as f64 * ratio).ceil() as usize;
    alike.max((4 * from.height).min(FINE)).max(2)
}

/// Up to so many rows, a resampled picture is finer than what it shows.
const FINE: usize = 512;

pub(super) fn resample(from: &Pixels, mapping: EnvironmentMapping) -> Pixels {
    let side = rows(from, mapping);
    let (width, height) = match mapping {
        EnvironmentMapping::LatLong => (2 * side, side),
        EnvironmentMapping::EqualArea => (side, side),
    };
    let mut rgb = Vec::with_capacity(width * height);
    for y in 0..height {
        for x in 0..width {
            let mut sum = [0.0; 3];
            for i in 0..SUBSAMPLES * SUBSAMPLES {
                let offset = |i: usize| (i as f64 + 0.5) / SUBSAMPLES as f64;
                let (dx, dy) = (offset(i % SUBSAMPLES), offset(i / SUBSAMPLES));
                let s = (x as f64 + dx) / width as f64;
                let value = match mapping {
                    EnvironmentMapping::LatLong => {
                        // Rows stand at v·(H − 1); the poles are the first and the last one.
                        let v = (y as f64 + dy - 0.5) / (height - 1) as f64;
                        equal_area_lookup(from, from_lat_long([s, v.clamp(0.0, 1.0)]))
                    }
                    EnvironmentMapping::EqualArea => {
                        lat_long_lookup(from, from_square([s, (y as f64 + dy) / height as f64]))
                    }
                };
                sum = std::array::from_fn(|c| sum[c] + value[c]);
            }
            rgb.push(sum.map(|v| v / (SUBSAMPLES * SUBSAMPLES) as f64));
        }
    }
    Pixels { width, height, rgb }
}

/// Mitsuba's environment: +Y up, the middle is +Z, +X a quarter from the left.
fn from_lat_long([u, v]: [f64; 2]) -> [f64; 3] {
    let (sin_phi, cos_phi) = (TAU * u).sin_cos();
    let (sin_theta, cos_theta) = (PI * v).sin_cos();
    [sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta]
}

fn lat_long_lookup(image: &Pixels, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let u = x.atan2(-z) / TAU;
    let v = y.clamp(-1.0, 1.0).acos() / PI;
    let (sx, sy) = (u * image.width as f64 - 0.5, v * (image.height - 1) as f64);
    image.mix(sx, sy, |x, y| {
        let x = x.rem_euclid(image.width as i64) as usize;
        let y = y.clamp(0, image.height as i64 - 1) as usize;
        image.rgb[y * image.width + x]
    })
}

/// Clarberg 2008: the equal-area octahedral square → direction, +Z in the middle.
pub(super) fn from_square([s, t]: [f64; 2]) -> [f64; 3] {
    let (u, v) = (2.0 * s - 1.0, 2.0 * t - 1.0);
    let distance = 1.0 - (u.abs() + v.abs());
    let r = 1.0 - distance.abs();
    let phi = if r == 0.0 { FRAC_PI_4 } else { ((v.abs() - u.abs()) / r + 1.0) * FRAC_PI_4 };
    let rho = r * (2.0 - r * r).sqrt();
    [(phi.cos() * rho).copysign(u), (phi.sin() * rho).copysign(v), (1.0 - r * r).copysign(distance)]
}

fn to_square([x, y, z]: [f64; 3]) -> [f64; 2] {
    let r = (1.0 - z.abs()).max(0.0).sqrt();
    let phi = y.abs().atan2(x.abs()) * 2.0 / PI;
    let (mut u, mut v) = (r * (1.0 - phi), r * phi);
    if z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    [0.5 * (u.copysign(x) + 1.0), 0.5 * (v.copysign(y) + 1.0)]
}

/// The nearest texel, as pbrt looks environments up.
fn equal_area_lookup(image: &Pixels, direction: [f64; 3]) -> [f64; 3] {
    image.nearest(to_square(direction))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn the_square_and_the_sphere_are_inverse() {
        for i in 0..400 {
            let (s, t) = (((i % 20) as f64 + 0.37) / 20.0, ((i / 20) as f64 + 0.61) / 20.0);
            let d = from_square([s, t]);
            assert!((d.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
            let [s2, t2] = to_square(d);
            assert!((s - s2).abs() < 1e-12 && (t - t2).abs() < 1e-12, "{s} {t}: {s2} {t2}");
        }
        assert!(near(from_square([0.5, 0.5]), [0.0, 0.0, 1.0]));
        // Halfway to an edge's middle: r = 1/2, so z = 3/4.
        assert!((from_square([0.75, 0.5])[2] - 0.75).abs() < 1e-12);
    }

    #[test]
    fn the_lat_long_map_is_turned_as_mitsuba_turns_it() {
        assert!(near(from_lat_long([0.5, 0.5]), [0.0, 0.0, 1.0]));
        assert!(near(from_lat_long([0.25, 0.5]), [1.0, 0.0, 0.0]));
        assert!(near(from_lat_long([0.3, 0.0]), [0.0, 1.0, 0.0]));
    }

    #[test]
    fn a_smooth_environment_survives_both_ways() {
        // Radiance 1 + d.x/2 + d.y/4 in each channel.
        let radiance = |d: [f64; 3]| [1.0 + 0.5 * d[0] + 0.25 * d[1]; 3];
        let side = 64;
        let rgb = (0..2 * side * side).map(|i| {
            let (x, y) = (i % (2 * side), i / (2 * side));
            let v = y as f64 / (side - 1) as f64;
            radiance(from_lat_long([(x as f64 + 0.5) / (2 * side) as f64, v]))
        });
        let first = Pixels { width: 2 * side, height: side, rgb: rgb.collect() };
        let square = resample(&first, EnvironmentMapping::EqualArea);
        let back = resample(&square, EnvironmentMapping::LatLong);
        for i in 0..200 {
            let d = from_square([((i % 20) as f64 + 0.5) / 20.0, ((i / 20) as f64 + 0.5) / 10.0]);
            // The gradient is below 0.6 a radian and a texel of the square spans some 0.04.
            let (a, b) = (radiance(d)[0], lat_long_lookup(&back, d)[0]);
            assert!((a - b).abs() < 0.6 * 0.04 + 0.01, "{d:?}: {a} and {b}");
        }
    }

    /// Rows of 0 and 1: between two of 8 rows radiance changes by 7/π a radian. A texel of the square spans √(4π)/32, of
    /// which a direction is a quarter off on average: 0.06. With 8 rows it would be four times that.
    #[test]
    fn a_coarse_environment_keeps_its_steps() {
        let (width, height) = (16, 8);
        let rgb = (0..width * height).map(|i| [f64::from(i / width % 2 == 0); 3]).collect();
        let first = Pixels { width, height, rgb };
        let square = resample(&first, EnvironmentMapping::EqualArea);
        let count = 4000;
        let off: f64 = (0..count)
            .map(|i| {
                // Spread evenly.
                let d = from_square([
                    (f64::from(i) + 0.5) / f64::from(count),
                    (f64::from(i) * 0.618_034).fract(),
                ]);
                (lat_long_lookup(&first, d)[0] - equal_area_lookup(&square, d)[0]).abs()
            })
            .sum();
        let mean = off / f64::from(count);
        assert!(mean < 0.1, "{mean}");
    }
}
