//! What `tools/references/make.py` writes beside each reference.

use super::Profile;
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// A manifest; keys that are only meant for people are ignored.
#[derive(Debug, Deserialize)]
pub struct Manifest {
    pub name: String,
    /// Relative to the workspace.
    pub scene: String,
    pub size: [usize; 2],
    pub reference: Reference,
    files: Vec<File>,
    path: Option<Profiles>,
    photonmap: Option<Profiles>,
    /// Where the manifest was read from.
    #[serde(skip)]
    pub file: PathBuf,
}

/// How the reference was made.
#[derive(Debug, Deserialize)]
pub struct Reference {
    pub command: String,
    /// Samples a pixel.
    pub spp: u64,
}

#[derive(Debug, Deserialize)]
struct File {
    path: String,
    sha256: String,
}

#[derive(Debug, Deserialize)]
struct Profiles {
    short: Limits,
    long: Limits,
}

/// A number of samples per pixel, and the limits for a picture of that many.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    pub spp: u32,
    pub max_rmse: f64,
    pub max_flip: f64,
    pub max_bias: f64,
    /// Variance of one sample, relative to that of a sample of the reference.
    pub noise: f64,
    /// Whether the z-test of a path traced picture has to accept.
    #[serde(default)]
    pub z_test: bool,
    /// More arguments of `caustica render`.
    #[serde(default)]
    pub args: Vec<String>,
}

impl Manifest {
    /// # Errors
    /// The file cannot be read or is not a manifest; the message says where.
    pub fn read(path: &Path) -> Result<Self, String> {
        let problem = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
        let text = std::fs::read_to_string(path).map_err(|e| problem(&e))?;
        let manifest: Self = toml::from_str(&text).map_err(|e| problem(&e))?;
        Ok(Self { file: path.to_path_buf(), ..manifest })
    }

    /// Integrators that can render the scene, each with its limits.
    pub fn renders(&self, profile: Profile) -> Vec<(&'static str, Limits)> {
        let pick = |p: &Profiles| if profile == Profile::Long { p.long.clone() } else { p.short.clone() };
        [("path", &self.path), ("photonmap", &self.photonmap)]
            .into_iter()
            .filter_map(|(name, profiles)| profiles.as_ref().map(|p| (name, pick(p))))
            .collect()
    }

    /// Checks that every file of the scene is the one the reference was made from.
    ///
    /// # Errors
    /// Lists the files that are not, and the command that renews the reference.
    pub fn check_files(&self, root: &Path) -> Result<(), String> {
        let changed = self.files.iter().filter_map(|file| match std::fs::read(root.join(&file.path)) {
            Ok(bytes) if hex(&Sha256::digest(&bytes)) == file.sha256 => None,
            Ok(_) => Some(format!("{} has changed since its reference was made", file.path)),
            Err(e) => Some(format!("{}: {e}", file.path)),
        });
        let changed: Vec<String> = changed.collect();
        if changed.is_empty() {
            return Ok(());
        }
        Err(format!("{}; renew it with: {}", changed.join("\n"), self.reference.command))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
