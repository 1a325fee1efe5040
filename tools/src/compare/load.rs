//! Image files as linear RGB.

use super::error::CompareError;
use crate::pixels::{Pixels, srgb_to_linear};
use caustica_formats::image::{self, Encoding, Image};
use rayon::prelude::*;
use std::path::Path;

/// A picture read from a file.
#[derive(Debug)]
pub struct Loaded {
    /// Linear RGB.
    pub pixels: Pixels,
    /// Whether the file held display values (PNG, JPEG …), which are decoded from sRGB, instead of radiance.
    pub display: bool,
}

/// A picture with all that its file holds.
#[derive(Debug)]
pub(super) struct Opened {
    /// The file.
    pub bytes: Vec<u8>,
    /// All channels.
    pub image: Image,
}

impl Opened {
    /// The bytes of a picture that errors call `name`.
    ///
    /// # Errors
    /// They are not a picture.
    pub fn of_bytes(bytes: Vec<u8>, name: &Path) -> Result<Self, CompareError> {
        let read = image::read(&bytes);
        let image = read.map_err(|source| CompareError::Read { path: name.to_path_buf(), source })?;
        Ok(Self { bytes, image })
    }

    /// A picture of radiance that no file holds.
    pub fn of_pixels(pixels: &Pixels) -> Self {
        let channels = ["R", "G", "B"].map(str::to_owned).to_vec();
        let data = pixels.rgb.as_flattened().to_vec();
        let (width, height, encoding) = (pixels.width, pixels.height, Encoding::Linear);
        Self { bytes: Vec::new(), image: Image { width, height, channels, data, encoding } }
    }
}

/// Reads a picture with all its channels.
///
/// # Errors
/// The file cannot be read, or is not a picture.
pub(super) fn open(path: &Path) -> Result<Opened, CompareError> {
    let bytes = std::fs::read(path);
    let bytes = bytes.map_err(|source| CompareError::Io { path: path.to_path_buf(), source })?;
    Opened::of_bytes(bytes, path)
}

/// Reads a picture as linear RGB: the channels `R G B`, else `Y` as gray, else the only channel. With `layer`
/// these are `layer.R` and so on. Other channels are ignored.
///
/// # Errors
/// The file cannot be read, is not a picture, lacks the channels, or holds a value that is not finite.
pub fn load(path: &Path, layer: Option<&str>) -> Result<Loaded, CompareError> {
    rgb_of(&open(path)?.image, path, layer)
}

/// The linear RGB of a picture that was read from `path`, see [`load()`].
///
/// # Errors
/// The picture lacks the channels, or holds a value that is not finite.
pub(super) fn rgb_of(image: &Image, path: &Path, layer: Option<&str>) -> Result<Loaded, CompareError> {
    let rgb = select(image, layer).ok_or_else(|| CompareError::MissingChannels {
        path: path.to_path_buf(),
        wanted: layer.map_or("R G B or Y".into(), |l| format!("{l}.R {l}.G {l}.B or {l}.Y or {l}")),
        found: image.channels.join(" "),
    })?;
    let display = image.encoding == Encoding::Srgb;
    let pixels = to_pixels(image, rgb, display);
    check_finite(&pixels, path)?;
    Ok(Loaded { pixels, display })
}

/// Indices of the red, green and blue channel, of a layer or of none.
fn select(image: &Image, layer: Option<&str>) -> Option<[usize; 3]> {
    let find = |name: &str| image.channels.iter().position(|c| c == name);
    let Some(layer) = layer else {
        let xyz = find("X").is_some() && find("Z").is_some();
        let gray = || if xyz { None } else { find("Y") };
        let named = |r, g, b| Some([find(r)?, find(g)?, find(b)?]);
        let only = || (image.channels.len() == 1).then_some([0; 3]);
        return named("R", "G", "B")
            .or_else(|| named("r", "g", "b"))
            .or_else(|| gray().map(|i| [i; 3]))
            .or_else(only);
    };
    let of = |suffix: &str| find(&format!("{layer}.{suffix}"));
    let named = |r, g, b| Some([of(r)?, of(g)?, of(b)?]);
    let gray = || of("Y").or_else(|| find(layer)).map(|i| [i; 3]);
    named("R", "G", "B").or_else(|| named("r", "g", "b")).or_else(gray)
}

fn to_pixels(image: &Image, rgb: [usize; 3], display: bool) -> Pixels {
    let pick = |p: &[f32]| {
        let v = rgb.map(|i| p[i]);
        if display { v.map(srgb_to_linear) } else { v }
    };
    let rgb = image.data.par_chunks_exact(image.channels.len()).map(pick).collect();
    Pixels { width: image.width, height: image.height, rgb }
}

fn check_finite(pixels: &Pixels, path: &Path) -> Result<(), CompareError> {
    let bad = |p: &[f32; 3]| p.iter().filter(|v| !v.is_finite()).count();
    let count: usize = pixels.rgb.par_iter().map(bad).sum();
    let Some(first) = pixels.rgb.iter().position(|p| bad(p) > 0).filter(|_| count > 0) else {
        return Ok(());
    };
    let pixel = pixels.rgb[first];
    let channel =
        pixel.iter().position(|v| !v.is_finite()).expect("the pixel has a value that is not finite");
    Err(CompareError::NotFinite {
        path: path.to_path_buf(),
        count,
        value: pixel[channel],
        channel: ['R', 'G', 'B'][channel],
        x: first % pixels.width,
        y: first / pixels.width,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(channels: &[&str]) -> Image {
        let n = channels.len();
        Image {
            width: 2,
            height: 1,
            channels: channels.iter().map(|c| c.to_string()).collect(),
            data: (0..2 * n).map(|i| i as f32).collect(),
            encoding: Encoding::Linear,
        }
    }

    #[test]
    fn channels_of_other_renderers() {
        let pbrt = image(&["Albedo.B", "Albedo.G", "Albedo.R", "B", "G", "R"]);
        assert_eq!(select(&pbrt, None), Some([5, 4, 3]));
        assert_eq!(select(&pbrt, Some("Albedo")), Some([2, 1, 0]));
        assert_eq!(select(&pbrt, Some("Ns")), None);
        assert_eq!(select(&image(&["A", "Y"]), None), Some([1; 3]));
        assert_eq!(select(&image(&["X", "Y", "Z"]), None), None);
        assert_eq!(select(&image(&["depth"]), None), Some([0; 3]));
        assert_eq!(select(&image(&["R", "depth"]), Some("depth")), Some([1; 3]));
    }

    #[test]
    fn values_that_are_not_finite_are_counted_and_located() {
        let mut p = Pixels::from_fn(4, 3, |_, _| [1.0; 3]);
        assert!(check_finite(&p, Path::new("a.exr")).is_ok());
        p.rgb[6] = [1.0, f32::NAN, f32::INFINITY];
        p.rgb[9][0] = f32::NEG_INFINITY;
        assert_eq!(
            check_finite(&p, Path::new("a.exr")).unwrap_err().to_string(),
            "a.exr: 3 values are not finite; the first is NaN in channel G at column 2, row 1"
        );
    }
}
