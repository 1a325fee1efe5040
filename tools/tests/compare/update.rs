//! `--update`: which references are replaced, and that no other is touched.

use crate::folder::{Folder, RGB, error, json, text};
use caustica_tools::compare::{CompareArgs, Status};
use std::path::Path;

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

fn args(f: &Folder) -> CompareArgs {
    CompareArgs {
        update: Some(None),
        update_pages: f.path("pages"),
        no_hdr: true,
        ..CompareArgs::new(f.path("images"), f.path("references"))
    }
}

/// Action and reason for each picture, in order.
fn updates(args: CompareArgs) -> (Status, Vec<(String, String, String)>) {
    let (status, report) = json(args);
    let word = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let all = report["updates"].as_array().into_iter().flatten();
    (status, all.map(|u| (word(&u["name"]), word(&u["action"]), word(&u["reason"]))).collect())
}

#[test]
fn pictures_beyond_a_threshold_replace_their_references() {
    let f = Folder::new();
    let near = f.exr("images/near.exr", &RGB, 0.51);
    let far = f.exr("images/deep/far.exr", &RGB, 0.6);
    let new = f.exr("images/new/one.exr", &RGB, 0.6);
    let old_near = f.exr("references/near.ref.exr", &RGB, 0.5);
    let old_far = f.exr("references/deep/far.ref.exr", &RGB, 0.5);
    let before = bytes(&old_near);
    let (status, printed) = text(&CompareArgs { max_rmse: Some(0.05), ..args(&f) });
    assert_eq!(status, Status::Holds, "{printed}");
    assert_eq!(bytes(&old_far), bytes(&far));
    assert_eq!(bytes(&old_near), before);
    assert_eq!(bytes(&f.path("references/new/one.exr")), bytes(&new));
    let page = f.path("pages/deep/far.html");
    let html = std::fs::read_to_string(&page).unwrap();
    assert!(html.contains(r#""labels":["after","before"]"#) && html.contains(r#""name":"deep/far""#));
    assert!(!f.path("pages/near.html").exists());
    let line = |action: &str, a: &Path, rest: String| format!("{action:<10}{}{rest}\n", a.display());
    for line in [
        line("replaced", &old_far, format!(" by {}; before and after: {}", far.display(), page.display())),
        line("kept", &old_near, ": every threshold holds".to_owned()),
        line("added", &f.path("references/new/one.exr"), format!(" from {}", new.display())),
    ] {
        assert!(printed.contains(&line), "{line}{printed}");
    }
    // Without thresholds, all that differ are taken; a second time, nothing is left to do.
    assert_eq!(updates(args(&f)).1[1].1, "replaced");
    assert_eq!(bytes(&old_near), bytes(&near));
    let (status, again) = updates(args(&f));
    assert_eq!(status, Status::Holds);
    assert!(again.iter().all(|u| u.1 == "kept" && u.2 == "equal pixels") && again.len() == 3, "{again:?}");
}

#[test]
fn only_named_pictures_are_taken() {
    let f = Folder::new();
    for name in ["a", "b", "c"] {
        f.exr(&format!("images/{name}.exr"), &RGB, 0.6);
        f.exr(&format!("references/{name}.exr"), &RGB, 0.5);
    }
    f.exr("images/new.exr", &RGB, 0.6);
    let named =
        |names: &str| CompareArgs { max_rmse: Some(0.05), update: Some(Some(names.to_owned())), ..args(&f) };
    let said = error(named("a, bb"));
    assert_eq!(said, "--update: there is no picture `bb` to compare; did you mean `b`?");
    let (status, done) = updates(named("a,c"));
    assert_eq!(status, Status::FallsShort);
    let done: Vec<_> = done.iter().map(|u| (u.0.as_str(), u.1.as_str(), u.2.as_str())).collect();
    assert_eq!(done, [("a", "replaced", ""), ("b", "kept", "not named"), ("c", "replaced", "")]);
    assert!(!f.path("references/new.exr").exists());
}

/// What cannot be read, does not fit, or cannot be shown leaves the reference as it was.
#[test]
fn references_of_failed_comparisons_are_untouched() {
    let f = Folder::new();
    let names = ["broken", "wide", "kind", "gone", "nan"];
    let paths = names.map(|name| f.exr(&format!("references/{name}.exr"), &RGB, 0.5));
    let before = paths.each_ref().map(|p| bytes(p));
    let whole = bytes(&f.exr("images/broken.exr", &RGB, 0.6));
    std::fs::write(f.path("images/broken.exr"), &whole[..whole.len() / 2]).unwrap();
    f.sized("images/wide.exr", &RGB, 0.6, (21, 10));
    caustica_formats::image::write_pfm(f.path("images/kind.pfm"), 20, 10, &[0.5; 200]).unwrap();
    f.write("images/nan.exr", &RGB, &[f32::NAN; 600], (20, 10));
    std::fs::write(f.path("images/extra.exr"), b"no picture").unwrap();
    let (status, done) = updates(args(&f));
    assert_eq!(status, Status::CouldNotCompare);
    assert!(done.iter().all(|u| u.1 == "kept"), "{done:?}");
    assert_eq!(paths.each_ref().map(|p| bytes(p)), before);
    assert!(!f.path("references/extra.exr").exists() && !f.path("pages").exists());
}

#[test]
fn no_page_no_update() {
    let f = Folder::new();
    f.exr("images/a.exr", &RGB, 0.6);
    let reference = f.exr("references/a.exr", &RGB, 0.5);
    let before = bytes(&reference);
    std::fs::write(f.path("plain"), b"").unwrap();
    let said = error(CompareArgs { update_pages: f.path("plain"), ..args(&f) });
    assert!(said.contains("plain"), "{said}");
    assert_eq!(bytes(&reference), before);
}

#[test]
fn extensions_must_agree_and_variances_go_with_their_picture() {
    let f = Folder::new();
    caustica_formats::image::write_pfm(f.path("images.pfm"), 20, 10, &[0.6; 200]).unwrap();
    let reference = f.exr("references.exr", &RGB, 0.5);
    let single = CompareArgs { image: f.path("images.pfm"), reference: reference.clone(), ..args(&f) };
    assert_eq!(updates(single).1[0].2, "the image is .pfm and the reference .exr");
    let image = f.exr("images/a.exr", &RGB, 0.6);
    let reference = f.exr("references/a.ref.exr", &RGB, 0.5);
    let variance = f.exr("references/a.ref.var.exr", &RGB, 1e-4);
    let (_, done) = updates(args(&f));
    assert!(done[0].2.contains("a.ref.var.exr is the variance of the old picture"), "{done:?}");
    let new = f.exr("images/a.var.exr", &RGB, 1e-3);
    assert_eq!(updates(args(&f)).1[0].1, "replaced");
    assert_eq!((bytes(&reference), bytes(&variance)), (bytes(&image), bytes(&new)));
}
