//! Turns manifests into trials.

mod blocks;
mod judge;
mod manifest;
mod own;

use judge::Judge;
use libtest_mimic::{Failed, Trial};
use manifest::{Limits, Manifest};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex};

/// How much time a run may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// Part of every test run.
    Short,
    /// For nightly runs.
    Long,
}

impl Profile {
    /// Long if `CAUSTICA_REFERENCE=long`.
    pub fn from_environment() -> Self {
        if std::env::var_os("CAUSTICA_REFERENCE").is_some_and(|v| v == "long") {
            Self::Long
        } else {
            Self::Short
        }
    }
}

/// One trial for each integrator of each manifest, and the trials of the suite itself.
///
/// # Errors
/// There are no manifests, or one cannot be read.
pub fn trials(root: &Path, profile: Profile) -> Result<Vec<Trial>, String> {
    let folder = root.join("reference");
    let files = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<PathBuf> = files.filter_map(|f| f.ok().map(|f| f.path())).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    if paths.is_empty() {
        return Err(format!("{}: no manifests; run tools/references/make.py", folder.display()));
    }
    // One render at a time, because each uses all cores.
    let turn = Arc::new(Mutex::new(()));
    let mut trials = Vec::new();
    for path in paths {
        let manifest = Arc::new(Manifest::read(&path)?);
        for (integrator, limits) in manifest.renders(profile) {
            let (manifest, turn, root) = (manifest.clone(), turn.clone(), root.to_path_buf());
            let name = format!("reference::{}::{integrator}", manifest.name);
            trials.push(Trial::test(name, move || {
                let _turn = turn.lock().unwrap_or_else(|e| e.into_inner());
                trial(&root, &manifest, integrator, &limits)
            }));
        }
    }
    trials.extend(own::trials(root));
    Ok(trials)
}

fn trial(root: &Path, manifest: &Manifest, integrator: &str, limits: &Limits) -> Result<(), Failed> {
    manifest.check_files(root)?;
    let [width, height] = manifest.size;
    let name = format!("{}-{integrator}", manifest.name);
    let target = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("reference");
    std::fs::create_dir_all(&target)?;
    let image = target.join(format!("{name}.exr"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
    command.args(["render", &manifest.scene, "--quiet", "--layers", "none", "--filter", "box"]);
    command.args(["--integrator", integrator, "--size", &format!("{width}x{height}")]);
    command.args(["--spp", &limits.spp.to_string()]).args(&limits.args);
    command.arg("-o").arg(&image).current_dir(root);
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("{command:?}\n{}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let failures = root.join("target/reference-failures").join(&name);
    let judge = Judge { manifest, limits, image: &image, scratch: &target };
    judge.verdict(integrator, &failures).map_err(|figures| {
        Failed::from(format!(
            "{figures}\nrendered by {command:?}\npage, picture, reference and FLIP map: {}",
            failures.display()
        ))
    })
}
