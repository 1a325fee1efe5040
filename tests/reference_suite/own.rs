//! Trials of the suite itself: that it fails when it should.

use super::Profile;
use super::judge::Judge;
use super::manifest::Manifest;
use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use caustica_tools::compare::load;
use libtest_mimic::{Failed, Trial};
use std::path::Path;

pub fn trials(root: &Path) -> Vec<Trial> {
    let (a, b) = (root.to_path_buf(), root.to_path_buf());
    vec![
        Trial::test("reference::own::a_changed_scene_fails", move || a_changed_scene_fails(&a)),
        Trial::test("reference::own::a_wrong_corner_fails", move || a_wrong_corner_fails(&b)),
    ]
}

const NAME: &str = "lamps";

fn check(holds: bool, why: impl Into<String>) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(why.into().into()) }
}

/// A manifest is valid only for the scene it was made from.
fn a_changed_scene_fails(root: &Path) -> Result<(), Failed> {
    let manifest = Manifest::read(&root.join(format!("reference/{NAME}.toml")))?;
    manifest.check_files(root)?;
    let copy = tempfile::tempdir()?;
    let scene = copy.path().join(&manifest.scene);
    std::fs::create_dir_all(scene.parent().ok_or("the scene is in a folder")?)?;
    let text = std::fs::read_to_string(root.join(&manifest.scene))?;
    std::fs::write(&scene, &text)?;
    manifest.check_files(copy.path())?;
    std::fs::write(&scene, text.replacen("0.5", "0.6", 1))?;
    let said = manifest.check_files(copy.path()).err().unwrap_or_default();
    let wanted = format!(
        "{} has changed since its reference was made; renew it with: python3 tools/references/make.py {NAME}",
        manifest.scene
    );
    check(said == wanted, format!("said: {said}"))?;
    std::fs::remove_file(&scene)?;
    let said = manifest.check_files(copy.path()).err().unwrap_or_default();
    check(said.contains(&manifest.scene) && said.contains("make.py"), format!("said: {said}"))
}

/// The reference itself passes; with one block 10 % brighter it fails, and the page is written.
fn a_wrong_corner_fails(root: &Path) -> Result<(), Failed> {
    let manifest = Manifest::read(&root.join(format!("reference/{NAME}.toml")))?;
    let scratch = tempfile::tempdir()?;
    let failures = scratch.path().join("failures");
    let truth = load(&manifest.file.with_extension("exr"), None)?.pixels;
    let renders = manifest.renders(Profile::Short);
    for (integrator, limits) in renders.iter().filter(|(name, _)| *name == "path") {
        for (factor, holds) in [(1.0f32, true), (1.1, false)] {
            let image = scratch.path().join("image.exr");
            let side = [truth.width / 8, truth.height / 8];
            let in_block = |i: usize| i % truth.width / side[0] == 3 && i / truth.width / side[1] == 4;
            let scaled = |(i, p): (usize, &[f32; 3])| p.map(|v| if in_block(i) { v * factor } else { v });
            let data: Vec<f32> = truth.rgb.iter().enumerate().flat_map(scaled).collect();
            let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &data };
            write_exr(&image, truth.width, truth.height, &[layer], &[], ExrOptions::default())?;
            // The picture has no noise, so the blocks alone decide.
            let judge = Judge { manifest: &manifest, limits, image: &image, scratch: scratch.path() };
            let verdict = judge.verdict(integrator, &failures).map_err(|e| e.to_string());
            check(verdict.is_ok() == holds, format!("{factor}: {verdict:?}"))?;
            if let Err(said) = verdict {
                check(said.contains("FAILS  block  columns 36..=47, rows 48..=59"), said)?;
                for file in ["index.html", "flip.png", "image.exr", "reference.exr"] {
                    check(failures.join(file).is_file(), format!("{file} was not written"))?;
                }
            }
        }
    }
    Ok(())
}
