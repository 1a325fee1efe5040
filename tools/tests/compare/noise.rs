//! The z-test by what either picture knows of its noise.

use crate::folder::{Folder, RGB, error, json};
use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use caustica_tools::compare::{CompareArgs, Status};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A picture of one colour with further channels of one value each.
fn layered(f: &Folder, name: &str, value: f32, more: &[(&str, f32)]) -> PathBuf {
    let channels: Vec<&str> = RGB.into_iter().chain(more.iter().map(|m| m.0)).collect();
    let pixel: Vec<f32> = [value; 3].into_iter().chain(more.iter().map(|m| m.1)).collect();
    f.write(name, &channels, &pixel.repeat(200), (20, 10))
}

/// Mean z², and what was said.
fn z2(image: &Path, reference: &Path, spp: [Option<f64>; 2]) -> (Option<f64>, String) {
    let [spp, reference_spp] = spp;
    let (status, report) = json(CompareArgs { spp, reference_spp, ..CompareArgs::new(image, reference) });
    assert_eq!(status, Status::Holds, "{report}");
    let comparison = &report["comparisons"][0];
    (comparison["z_test"]["mean_z2"].as_f64(), comparison["notes"].to_string())
}

fn near(found: &(Option<f64>, String), expected: f64) {
    // Values are stored in single precision.
    assert!(found.0.is_some_and(|z| (z / expected - 1.0).abs() < 1e-3), "{found:?}, expected {expected}");
}

#[test]
fn a_layer_of_variance_in_either_picture_is_enough() {
    let f = Folder::new();
    let noisy = layered(&f, "noisy.exr", 0.52, &[("variance.Y", 1e-4)]);
    let plain = f.exr("plain.exr", &RGB, 0.5);
    let found = z2(&noisy, &plain, [None; 2]);
    near(&found, 4.0);
    assert!(found.1.contains("luminance: variance of the image from layer `variance` of "), "{found:?}");
    assert!(found.1.contains("of the reference taken as 0"), "{found:?}");
    // Sample counts lend the variance to the other picture.
    near(&z2(&noisy, &plain, [Some(100.0), Some(300.0)]), 3.0);
    near(&z2(&plain, &noisy, [Some(300.0), Some(100.0)]), 3.0);
    // Two layers add up.
    near(&z2(&noisy, &layered(&f, "other.exr", 0.5, &[("variance.Y", 3e-4)]), [None; 2]), 1.0);
    // Of an image of unknown noise nothing can be said, unless the test is asked for.
    let (none, notes) = z2(&plain, &noisy, [None; 2]);
    assert!(none.is_none() && notes.contains("nothing is known of the noise of the image"), "{notes}");
    let asked = CompareArgs { z_test: true, ..CompareArgs::new(&plain, &noisy) };
    let (_, report) = json(asked);
    near(&(report["comparisons"][0]["z_test"]["mean_z2"].as_f64(), String::new()), 4.0);
}

#[test]
fn pictures_tell_their_sample_counts() {
    let f = Folder::new();
    let noisy = layered(&f, "noisy.exr", 0.52, &[("variance.Y", 1e-4), ("samples.Y", 100.0)]);
    near(&z2(&noisy, &layered(&f, "counted.exr", 0.5, &[("samples.Y", 300.0)]), [None; 2]), 3.0);
    // In the header, as caustica and pbrt write it.
    let header = f.path("header.exr");
    let layer = ExrLayer { name: "", channels: &RGB, data: &[0.5; 600] };
    let attribute = [("samplesPerPixel".to_owned(), "300".to_owned())];
    write_exr(&header, 20, 10, &[layer], &attribute, ExrOptions::default()).unwrap();
    near(&z2(&noisy, &header, [None; 2]), 3.0);
    near(&z2(&noisy, &header, [None, Some(100.0)]), 2.0);
}

#[test]
fn moments_of_mitsuba_are_variances_of_a_sample() {
    let f = Folder::new();
    // Gray 0.5 in XYZ with the white of Rec. 709, and squares whose excess over the mean's is 0.01.
    let white: [f32; 3] = [0.950_456, 1.0, 1.088_754];
    let names = ["nested.X", "nested.Y", "nested.Z", "m2_nested.X", "m2_nested.Y", "m2_nested.Z"];
    let means = white.map(|w| 0.5 * w);
    let values = [means, means.map(|m| m * m + 0.01)].concat();
    let moments: Vec<(&str, f32)> = names.into_iter().zip(values).collect();
    let reference = layered(&f, "moments.exr", 0.5, &moments);
    let image = f.exr("image.exr", &RGB, 0.52);
    // The mean of the squared differences of X, Y and Z over the variance, with 400 samples in each picture, of
    // which the reference's variance lost one.
    let squares: f64 = white.iter().map(|w| (0.02 * f64::from(*w)).powi(2)).sum::<f64>() / 3.0;
    let found = z2(&image, &reference, [Some(400.0), Some(400.0)]);
    near(&found, squares / (0.01 / 400.0 + 0.01 / 399.0));
    assert!(found.1.contains("XYZ") && found.1.contains("`m2_nested`"), "{found:?}");
    near(&z2(&image, &reference, [Some(400.0), None]), squares / (0.01 / 400.0));
    // The picture that has the moments may be the image; its count is then needed.
    near(&z2(&reference, &image, [Some(400.0), None]), squares / (0.01 / 399.0));
    let (none, notes) = z2(&reference, &image, [None; 2]);
    assert!(none.is_none() && notes.contains("--spp N"), "{notes}");
    // Against a luminance, the moments' Y counts.
    let noisy = layered(&f, "noisy.exr", 0.52, &[("variance.Y", 2e-4)]);
    near(&z2(&noisy, &reference, [None, Some(101.0)]), 4e-4 / 3e-4);
}

#[test]
fn files_beside_the_image_count_and_go_first() {
    let f = Folder::new();
    let image = layered(&f, "a.exr", 0.52, &[("variance.Y", 1.0)]);
    let reference = f.exr("r.exr", &RGB, 0.5);
    f.exr("a.var.exr", &RGB, 1e-4);
    near(&z2(&image, &reference, [None; 2]), 4.0);
    let other = f.exr("other.exr", &RGB, 4e-4);
    let args = CompareArgs { image_variance: Some(other), ..CompareArgs::new(&image, &reference) };
    let (_, report) = json(args);
    near(&(report["comparisons"][0]["z_test"]["mean_z2"].as_f64(), String::new()), 1.0);
}

#[test]
fn layers_that_tell_nothing_are_said() {
    let f = Folder::new();
    let once = layered(&f, "once.exr", 0.52, &[("variance.Y", f32::MAX)]);
    let reference = f.exr("r.exr", &RGB, 0.5);
    let (none, notes) = z2(&once, &reference, [None; 2]);
    assert!(none.is_none() && notes.contains("holds no variance: a single pass was rendered"), "{notes}");
    let said = error(CompareArgs { z_test: true, ..CompareArgs::new(&once, &reference) });
    assert!(said.ends_with("holds no variance: a single pass was rendered"), "{said}");
    // The variance of the whole says nothing of a layer.
    let parts = [("variance.Y", 1e-4), ("direct.R", 0.5), ("direct.G", 0.5), ("direct.B", 0.5)];
    let parts = layered(&f, "parts.exr", 0.52, &parts);
    let args = CompareArgs { layer: Some("direct".into()), ..CompareArgs::new(&parts, &parts) };
    assert_eq!(json(args).1["comparisons"][0]["z_test"], Value::Null);
}
