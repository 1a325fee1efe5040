//! `run` as the command line calls it: exit status, table, JSON, and every way to fail.

// Helpers of tests fail by panicking, as tests do.
#![allow(clippy::unwrap_used)]

mod folder;
mod junit;
mod noise;
mod update;

use caustica_formats::image::write_png;
use caustica_tools::compare::{CompareArgs, Status, VarianceOf};
use folder::{Folder, RGB, error, json, text};
use serde_json::Value;
use std::path::Path;

#[test]
fn thresholds_decide_the_status() {
    let f = Folder::new();
    let (a, b) = (f.exr("a.exr", &RGB, 0.55), f.exr("b.exr", &RGB, 0.5));
    let args = CompareArgs::new(a, b);
    assert_eq!(text(&args).0, Status::Holds);
    let limits =
        CompareArgs { max_rmse: Some(0.051), max_bias: Some(0.11), max_flip: Some(0.2), ..args.clone() };
    let (status, report) = json(limits);
    assert_eq!(status, Status::Holds, "{report}");
    assert_eq!(report["comparisons"][0]["checks"].as_array().unwrap().len(), 3);
    for tight in [
        CompareArgs { max_rmse: Some(0.049), ..args.clone() },
        CompareArgs { max_bias: Some(0.09), ..args.clone() },
        CompareArgs { max_flip: Some(0.01), ..args.clone() },
        CompareArgs { max_hdr_flip: Some(0.01), ..args.clone() },
        CompareArgs { max_relmse: Some(0.001), ..args.clone() },
    ] {
        assert_eq!(text(&tight).0, Status::FallsShort, "{tight:?}");
    }
    let (_, table) = text(&CompareArgs { max_rmse: Some(0.049), ..args });
    assert!(table.contains("\nFAILS  rmse 0.050000 > 0.049\n"), "{table}");
}

#[test]
fn what_cannot_be_compared_is_said() {
    let f = Folder::new();
    let good = f.exr("good.exr", &RGB, 0.5);
    let against = |image: &Path| error(CompareArgs::new(image, &good));
    let wide = f.sized("wide.exr", &RGB, 0.5, (21, 10));
    let message = against(&wide);
    assert!(
        message.contains("wide.exr has 21x10 pixels") && message.contains("good.exr has 20x10"),
        "{message}"
    );
    let message = against(&f.exr("xyz.exr", &["X", "Y", "Z"], 0.5));
    assert!(message.ends_with("no channels R G B or Y; the file has X Y Z"), "{message}");
    let mut data = vec![0.5; 600];
    data[3 * 45 + 1] = f32::NAN;
    let message = against(&f.write("nan.exr", &RGB, &data, (20, 10)));
    assert!(message.contains("the first is NaN in channel G at column 5, row 2"), "{message}");
    std::fs::write(f.path("text.exr"), "not an image").unwrap();
    assert!(against(&f.path("text.exr")).contains("text.exr: "));
    assert!(against(&f.path("absent.exr")).contains("absent.exr: "));
    assert!(against(f.0.path()).contains("is a folder and"));
    let message = error(CompareArgs { layer: Some("direct".into()), ..CompareArgs::new(&good, &good) });
    assert!(message.contains("no channels direct.R direct.G direct.B"), "{message}");
    let unwritable = f.path("no/such/folder.html");
    let message = error(CompareArgs { html: Some(unwritable), ..CompareArgs::new(&good, &good) });
    assert!(message.contains("folder.html: "), "{message}");
}

#[test]
fn gray_layers_and_display_values() {
    let f = Folder::new();
    let gray = f.exr("gray.exr", &["Y"], 0.5);
    let layered = f.exr("layers.exr", &["R", "G", "B", "direct.R", "direct.G", "direct.B", "Albedo.R"], 0.5);
    let args = CompareArgs { max_rmse: Some(0.0), ..CompareArgs::new(&layered, &gray) };
    assert_eq!(text(&args).0, Status::Holds);
    let reference = f.exr("r.exr", &["direct.R", "direct.G", "direct.B"], 0.5);
    let args = CompareArgs { layer: Some("direct".into()), ..CompareArgs::new(&layered, reference) };
    assert_eq!(text(&args).0, Status::Holds);
    let png = f.path("a.png");
    write_png(&png, 2, 1, &[188, 188, 188, 0, 0, 0]).unwrap();
    let (_, report) = json(CompareArgs::new(&png, &png));
    let mean = report["comparisons"][0]["bias"]["image_mean"][0].as_f64().unwrap();
    assert!((mean - 0.502_886 / 2.0).abs() < 1e-5, "sRGB is decoded: {mean}");
    assert!(report["comparisons"][0]["flip_hdr"].is_null());
}

#[test]
fn variances_beside_references_are_used() {
    let f = Folder::new();
    let image = f.exr("a.exr", &RGB, 0.52);
    let reference = f.exr("a.ref.exr", &RGB, 0.5);
    let args = CompareArgs { z_test: true, ..CompareArgs::new(&image, &reference) };
    assert!(error(args.clone()).starts_with("no variance image beside"));
    f.exr("a.ref.var.exr", &RGB, 1e-4);
    let (status, report) = json(args.clone());
    assert_eq!(status, Status::Holds);
    let z2 = report["comparisons"][0]["z_test"]["mean_z2"].as_f64().unwrap();
    assert!((z2 - 4.0).abs() < 1e-4, "{z2}");
    // The image's own noise: three times the reference's variance at a third of its samples.
    let (_, report) = json(CompareArgs { spp: Some(100.0), reference_spp: Some(300.0), ..args.clone() });
    let z2 = report["comparisons"][0]["z_test"]["mean_z2"].as_f64().unwrap();
    assert!((z2 - 1.0).abs() < 1e-4, "{z2}");
    let sample = CompareArgs { variance_of: Some(VarianceOf::Sample), ..args };
    assert!(error(sample.clone()).contains("--spp"));
    let (status, _) = json(CompareArgs { spp: Some(1e6), ..sample });
    assert_eq!(status, Status::FallsShort);
}

#[test]
fn pixels_that_a_reference_leaves_out_do_not_count() {
    let f = Folder::new();
    let mut data = vec![0.5; 600];
    data[..300].fill(9.0);
    let image = f.write("a.exr", &RGB, &data, (20, 10));
    let reference = f.exr("r/a.ref.exr", &RGB, 0.5);
    let args = CompareArgs { max_rmse: Some(1e-6), ..CompareArgs::new(&image, &reference) };
    assert_eq!(text(&args).0, Status::FallsShort);
    let mut mask = vec![1.0; 600];
    mask[..300].fill(0.0);
    let mask = f.write("r/a.ref.mask.exr", &RGB, &mask, (20, 10));
    let (status, report) = json(args.clone());
    assert_eq!(status, Status::Holds, "{report}");
    let note = report["comparisons"][0]["notes"].to_string();
    assert!(note.contains("100 of 200 pixels are masked out"), "{note}");
    let elsewhere = f.exr("b.exr", &RGB, 0.5);
    let given = CompareArgs { reference: elsewhere, mask: Some(mask), ..args.clone() };
    assert_eq!(text(&given).0, Status::Holds);
    f.sized("r/a.ref.mask.exr", &RGB, 1.0, (10, 10));
    assert!(error(args).contains("a.ref.mask.exr has 10x10"));
}

#[test]
fn folders_and_error_maps() {
    let f = Folder::new();
    f.exr("images/a.exr", &RGB, 0.5);
    f.exr("images/deep/b.exr", &RGB, 0.6);
    f.exr("images/extra.exr", &RGB, 0.6);
    f.exr("references/a.ref.exr", &RGB, 0.5);
    f.exr("references/deep/b_ref_rgb.exr", &RGB, 0.5);
    let args = CompareArgs {
        max_rmse: Some(0.01),
        error_map: Some(f.path("maps")),
        ..CompareArgs::new(f.path("images"), f.path("references"))
    };
    let (status, table) = text(&args);
    assert_eq!(status, Status::FallsShort);
    assert!(table.contains("deep/b") && table.contains("no reference for"), "{table}");
    assert!(f.path("maps/deep/b.png").is_file() && f.path("maps/a.png").is_file());
    f.exr("references/c.exr", &RGB, 0.5);
    assert!(error(args).contains("has no image for"));
}

#[test]
fn json_goes_to_a_file_beside_the_table() {
    let f = Folder::new();
    let a = f.exr("a.exr", &RGB, 0.5);
    let file = f.path("out.json");
    let (_, table) = text(&CompareArgs { json: Some(Some(file.clone())), ..CompareArgs::new(&a, &a) });
    assert!(table.starts_with("image "));
    let report: Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    assert_eq!(report["comparisons"][0]["rmse_all"], 0.0);
}
