//! The variance of a picture: in a file beside it, or in layers of its own.

use super::error::CompareError;
use super::load::{self, Opened};
use crate::metrics::{Space, rgb_to_xyz};
use crate::pixels::Pixels;
use caustica_formats::image::{Image, attribute};
use std::path::{Path, PathBuf};

/// What a variance image holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VarianceKind {
    /// Variance of one sample, as in Mitsuba's `moment` integrator and the `*_ref_rgb_var.exr` of its render
    /// tests.
    OfSample,
    /// Variance of the pixel's mean, already divided by the number of samples.
    OfMean,
}

/// The variance of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Variance {
    /// Pixel by pixel, in `space`.
    pub values: Vec<[f64; 3]>,
    /// Of what the variances are.
    pub space: Space,
    /// Variance of what.
    pub kind: VarianceKind,
    /// Samples by which a mean square about the mean of the same samples is too small: 1 there, otherwise 0.
    pub lost: f64,
    /// The file or layer, for messages.
    pub from: String,
}

/// Mean squares less squared means are off by up to 1.5e-3 of the squared values where both were stored as half floats,
/// whose rounding error is 2⁻¹¹: once for the mean square, twice for the mean. Files of Mitsuba's tests, which were
/// converted from XYZ to RGB as well, have up to 2.4e-3.
const ROUNDING: f64 = 1.0 / 256.0;

/// A variance file that the command line names.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given<'a> {
    pub file: Option<&'a Path>,
    pub kind: Option<VarianceKind>,
}

/// The variance of a picture: from the file that is given, from one beside the picture, or, where `layers` may
/// speak for it, from its own layers.
///
/// # Errors
/// A file cannot be read or has another size, or what should be variances is not.
pub fn find(
    path: &Path,
    image: &Image,
    given: Given<'_>,
    layers: bool,
) -> Result<Option<Variance>, CompareError> {
    let named = given.file.map(|file| (file.to_path_buf(), kind_by_name(file)));
    let Some((file, kind)) = named.or_else(|| beside(path)) else {
        let found = if layers { in_layers(image, path) } else { None };
        return found.map(|found| checked(found, image)).transpose();
    };
    let pixels = load::load(&file, None)?.pixels;
    if [pixels.width, pixels.height] != [image.width, image.height] {
        return Err(CompareError::Size {
            path: path.to_path_buf(),
            size: [image.width, image.height],
            reference: file,
            reference_size: [pixels.width, pixels.height],
        });
    }
    let found = of_file(&pixels, given.kind.unwrap_or(kind), file.display().to_string());
    checked(found, image).map(Some)
}

/// Camera samples of each pixel, where the picture says: the layer `samples`, or the attribute of the header that
/// pbrt and caustica write.
pub fn samples(opened: &Opened) -> Option<f64> {
    let image = &opened.image;
    let layer = || {
        let index = image.channel("samples.Y").or_else(|| image.channel("samples"))?;
        let values = image.data.chunks_exact(image.channels.len()).map(|p| f64::from(p[index]));
        Some(values.sum::<f64>() / (image.width * image.height) as f64)
    };
    let header = || attribute(&opened.bytes, "samplesPerPixel")?.trim().parse().ok();
    layer().or_else(header).filter(|n: &f64| n.is_finite() && *n >= 1.0)
}

/// The variance image beside a picture: `x.ref.exr` has `x.ref.var.exr` (variance of the mean),
/// `x_ref_rgb.exr` has `x_ref_rgb_var.exr` (Mitsuba's tests: variance of one sample).
pub fn beside(picture: &Path) -> Option<(PathBuf, VarianceKind)> {
    let extension = picture.extension()?.to_str()?;
    [".var", "_var"].into_iter().find_map(|suffix| {
        let name = format!("{}{suffix}.{extension}", picture.file_stem()?.to_str()?);
        let path = picture.with_file_name(name);
        path.is_file().then(|| (path.clone(), kind_by_name(&path)))
    })
}

/// What a variance file holds, by its name: Mitsuba's `_var` the variance of a sample, any other that of the
/// mean.
fn kind_by_name(path: &Path) -> VarianceKind {
    let stem = path.file_stem().map(|s| s.to_string_lossy()).unwrap_or_default();
    if stem.ends_with("_var") { VarianceKind::OfSample } else { VarianceKind::OfMean }
}

/// Mitsuba's render tests compare XYZ, and take the variances of RGB there as if they were colours.
fn of_file(pixels: &Pixels, kind: VarianceKind, from: String) -> Variance {
    let space = if kind == VarianceKind::OfSample { Space::Xyz } else { Space::Rgb };
    let values = pixels.rgb.iter().map(|v| {
        let v = v.map(f64::from);
        if space == Space::Xyz { rgb_to_xyz(v) } else { v }
    });
    Variance { values: values.collect(), space, kind, lost: 0.0, from }
}

fn in_layers(image: &Image, path: &Path) -> Option<Variance> {
    let named = |channels: [&str; 3], space, kind| {
        let [a, b, c] = channels.map(|name| image.channel(name));
        let indices = [a?, b?, c?];
        let from = format!("layer `{}` of {}", channels[0].rsplit_once('.')?.0, path.display());
        let values = per_pixel(image).map(|p| indices.map(|i| f64::from(p[i]))).collect();
        Some(Variance { values, space, kind, lost: 0.0, from })
    };
    let (mean, sample) = (VarianceKind::OfMean, VarianceKind::OfSample);
    named(["variance.Y"; 3], Space::Luminance, mean)
        .or_else(|| named(["variance.R", "variance.G", "variance.B"], Space::Rgb, mean))
        .or_else(|| moments(image, path))
        .or_else(|| named(["Variance.R", "Variance.G", "Variance.B"], Space::Rgb, sample))
}

fn per_pixel(image: &Image) -> impl Iterator<Item = &[f32]> {
    image.data.chunks_exact(image.channels.len())
}

/// Mitsuba's `moment` integrator: means of X, Y, Z and of their squares. Of several pictures in the file, the one
/// that R, G, B show.
fn moments(image: &Image, path: &Path) -> Option<Variance> {
    let indices = |name: &str| {
        let [x, y, z] = ["X", "Y", "Z"].map(|c| image.channel(&format!("{name}.{c}")));
        Some([x?, y?, z?])
    };
    let names = image.channels.iter().filter_map(|c| c.strip_suffix(".Y"));
    let both = names.filter_map(|name| Some((name, indices(name)?, indices(&format!("m2_{name}"))?)));
    let rgb = image.rgb()?;
    let away = |first: [usize; 3]| {
        let difference = |p: &[f32]| f64::from(p[first[1]]) - rgb_to_xyz(rgb.map(|i| f64::from(p[i])))[1];
        per_pixel(image).map(|p| difference(p).abs()).sum::<f64>()
    };
    let (name, first, second) = both.min_by(|a, b| away(a.1).total_cmp(&away(b.1)))?;
    let of = |p: &[f32]| {
        std::array::from_fn(|c| (f64::from(p[second[c]]) - f64::from(p[first[c]]).powi(2)).max(0.0))
    };
    let from = format!("layers `{name}` and `m2_{name}` of {}", path.display());
    let values = per_pixel(image).map(of).collect();
    Some(Variance { values, space: Space::Xyz, kind: VarianceKind::OfSample, lost: 1.0, from })
}

/// Refuses what says nothing about noise: a render of one pass stores the largest number. What rounding has left below 0
/// where there is no noise becomes 0; `image` is the picture.
fn checked(mut variance: Variance, image: &Image) -> Result<Variance, CompareError> {
    let rgb = image.rgb();
    let largest =
        |p: &[f32]| rgb.map_or(0.0, |rgb| rgb.into_iter().map(|i| f64::from(p[i]).abs()).fold(0.0, f64::max));
    for (values, pixel) in variance.values.iter_mut().zip(per_pixel(image)) {
        let rounding = ROUNDING * largest(pixel).powi(2);
        for v in values {
            let why = match *v {
                v if !v.is_finite() => "a value is not finite",
                v if v < -rounding => "a value is below 0",
                v if v >= f64::from(f32::MAX) => "a single pass was rendered",
                _ => {
                    *v = v.max(0.0);
                    continue;
                }
            };
            return Err(CompareError::NotVariance { from: variance.from, why });
        }
    }
    Ok(variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use caustica_formats::image::Encoding;

    fn picture(channels: &[(&str, f32)]) -> Image {
        Image {
            width: 2,
            height: 1,
            channels: channels.iter().map(|c| c.0.to_owned()).collect(),
            data: [channels, channels].concat().iter().map(|c| c.1).collect(),
            encoding: Encoding::Linear,
        }
    }

    fn layers(channels: &[(&str, f32)]) -> Option<(Space, VarianceKind, [f64; 3])> {
        let found = in_layers(&picture(channels), Path::new("a.exr"))?;
        Some((found.space, found.kind, found.values[1]))
    }

    #[test]
    fn layers_of_all_renderers() {
        use VarianceKind::{OfMean, OfSample};
        let rgb = [("R", 1.0), ("G", 1.0), ("B", 1.0)];
        let with = |more: &[(&str, f32)]| layers(&[&rgb[..], more].concat());
        assert_eq!(with(&[]), None);
        assert_eq!(with(&[("variance.Y", 0.25)]), Some((Space::Luminance, OfMean, [0.25; 3])));
        let pbrt = [("Variance.R", 1.0), ("Variance.G", 2.0), ("Variance.B", 3.0)];
        assert_eq!(with(&pbrt), Some((Space::Rgb, OfSample, [1.0, 2.0, 3.0])));
        // Mitsuba's two nested integrators; R, G, B is the second one here, whose Y is 1.
        let moments = [
            ("a.X", 5.0),
            ("a.Y", 5.0),
            ("a.Z", 5.0),
            ("b.X", 0.5),
            ("b.Y", 1.0),
            ("b.Z", 1.0),
            ("m2_a.X", 99.0),
            ("m2_a.Y", 99.0),
            ("m2_a.Z", 99.0),
            ("m2_b.X", 1.25),
            ("m2_b.Y", 3.0),
            ("m2_b.Z", 0.5),
        ];
        assert_eq!(with(&moments), Some((Space::Xyz, OfSample, [1.0, 2.0, 0.0])));
    }

    #[test]
    fn a_single_pass_has_no_variance() {
        let said = of_layer(f32::MAX).unwrap_err().to_string();
        assert_eq!(said, "layer `variance` of a.exr holds no variance: a single pass was rendered");
    }

    fn of_layer(variance: f32) -> Result<f64, CompareError> {
        let picture = picture(&[("R", 0.5), ("G", 2.0), ("B", 1.0), ("variance.Y", variance)]);
        let found = in_layers(&picture, Path::new("a.exr")).expect("the layer is there");
        checked(found, &picture).map(|found| found.values[0][1])
    }

    /// Mitsuba's own files of variances have such values.
    #[test]
    fn what_rounding_leaves_below_zero_is_no_variance() {
        assert_eq!(of_layer(0.125).unwrap(), 0.125);
        // Of the squared value 4 it may be 0.0156.
        assert_eq!(of_layer(-0.0096).unwrap(), 0.0);
        let said = of_layer(-0.0157).unwrap_err().to_string();
        assert_eq!(said, "layer `variance` of a.exr holds no variance: a value is below 0");
        assert!(of_layer(f32::NAN).is_err());
    }

    #[test]
    fn files_beside_pictures() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.ref.exr", "a.ref.var.exr", "b_ref_rgb.exr", "b_ref_rgb_var.exr", "d.exr"] {
            std::fs::write(folder.path().join(name), b"").unwrap();
        }
        let kind = |name: &str| beside(&folder.path().join(name)).map(|v| v.1);
        assert_eq!(kind("a.ref.exr"), Some(VarianceKind::OfMean));
        assert_eq!(kind("b_ref_rgb.exr"), Some(VarianceKind::OfSample));
        assert_eq!(kind("d.exr"), None);
    }
}
