//! A scene reads below its own folder and the folders its user named, and meshes and pictures below
//! the folders it declares itself, nowhere else.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{PoisonError, RwLock};

use crate::files::{Disk, Files, plain};

/// The file system below some folders. Links and `..` are followed first, so they lead nowhere else.
#[derive(Debug)]
pub struct Confined {
    roots: Vec<PathBuf>,
    /// For files named as one of [`ASSETS`] only: a scene may not show what else stands there.
    declared: RwLock<Vec<PathBuf>>,
    /// What was looked for or asked for and lies elsewhere.
    outside: RwLock<BTreeSet<PathBuf>>,
}

const ASSETS: &[&str] = &[
    "obj",
    "mtl",
    "ply",
    "serialized",
    "exr",
    "hdr",
    "rgbe",
    "pfm",
    "png",
    "jpg",
    "jpeg",
    "tga",
    "bmp",
    "gz",
];

impl Confined {
    /// The folder of `scene` and `allowed`. Folders that do not exist allow nothing.
    pub fn new(scene: &Path, allowed: &[PathBuf]) -> Self {
        let own = match scene.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
            _ => PathBuf::from("."),
        };
        // A link to a scene stands for the scene.
        let linked = std::fs::canonicalize(scene).ok().and_then(|real| real.parent().map(Path::to_path_buf));
        let roots = [own].into_iter().chain(linked).chain(allowed.iter().cloned());
        let roots = roots.filter_map(|root| std::fs::canonicalize(root).ok()).collect();
        Self { roots, declared: RwLock::default(), outside: RwLock::default() }
    }

    fn allows(&self, real: &Path) -> bool {
        self.roots.iter().any(|root| real.starts_with(root)) || is_asset(real) && self.is_declared(real)
    }

    /// The file that a path stands for, when it may be read.
    fn allowed(&self, path: &Path) -> io::Result<PathBuf> {
        let real = std::fs::canonicalize(path).map_err(plain)?;
        if self.allows(&real) {
            return Ok(real);
        }
        self.note_outside(real);
        let text = "it is outside of the folders that the scene may read";
        Err(io::Error::new(io::ErrorKind::PermissionDenied, text))
    }

    fn is_declared(&self, real: &Path) -> bool {
        let declared = self.declared.read().unwrap_or_else(PoisonError::into_inner);
        declared.iter().any(|root| real.starts_with(root))
    }

    fn note_outside(&self, real: PathBuf) {
        self.outside.write().unwrap_or_else(PoisonError::into_inner).insert(real);
    }
}

fn is_asset(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    ASSETS.contains(&extension.as_str())
}

impl Files for Confined {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        Disk.read(&self.allowed(path)?)
    }

    fn check(&self, path: &Path) -> io::Result<()> {
        Disk.check(&self.allowed(path)?)
    }

    /// True outside of the folders too: reading then says what to allow, where "not found" would puzzle.
    fn is_file(&self, path: &Path) -> bool {
        let there = Disk.is_file(path);
        if there
            && let Ok(real) = std::fs::canonicalize(path)
            && !self.allows(&real)
        {
            self.note_outside(real);
        }
        there
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        match std::fs::canonicalize(folder) {
            Ok(real) if self.allows(&real) || self.is_declared(&real) => Disk.names(&real),
            _ => Vec::new(),
        }
    }

    fn declare(&self, folder: &Path) -> bool {
        let Ok(real) = std::fs::canonicalize(folder) else { return false };
        if self.allows(&real) || self.is_declared(&real) {
            return false;
        }
        self.declared.write().unwrap_or_else(PoisonError::into_inner).push(real);
        true
    }

    fn outside(&self) -> Vec<PathBuf> {
        let noted = self.outside.read().unwrap_or_else(PoisonError::into_inner);
        // A folder may have been declared since.
        noted.iter().filter(|real| !self.allows(real)).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_below_the_folders_only() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| place.path().join(name);
        for folder in ["scenes/meshes", "other", "scenes-too"] {
            std::fs::create_dir_all(at(folder)).expect("creatable");
        }
        for file in ["scenes/s.xml", "scenes/meshes/m", "other/o", "scenes-too/t"] {
            std::fs::write(at(file), file).expect("writable");
        }
        let files = Confined::new(&at("scenes/s.xml"), &[]);
        assert!(files.read(&at("scenes/s.xml")).is_ok());
        assert!(files.read(&at("scenes/meshes/../meshes/m")).is_ok());
        for outside in ["other/o", "scenes/../other/o", "scenes-too/t"] {
            let problem = files.read(&at(outside)).expect_err("outside");
            assert_eq!(problem.kind(), io::ErrorKind::PermissionDenied);
        }
        let real = |name: &str| std::fs::canonicalize(at(name)).expect("exists");
        assert_eq!(files.outside(), [real("other/o"), real("scenes-too/t")]);
        assert!(files.names(&at("other")).is_empty());
        let files = Confined::new(&at("scenes/s.xml"), &[at("other")]);
        assert!(files.read(&at("scenes/../other/o")).is_ok());
    }

    #[test]
    fn declared_folders_give_meshes_and_pictures_only() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| place.path().join(name);
        for folder in ["tests/scenes", "common/meshes"] {
            std::fs::create_dir_all(at(folder)).expect("creatable");
        }
        for file in ["common/meshes/m.ply", "common/meshes/password", "common/s.xml", "beside.ply"] {
            std::fs::write(at(file), file).expect("writable");
        }
        let files = Confined::new(&at("tests/scenes/s.xml"), &[]);
        assert!(files.read(&at("tests/scenes/../../common/meshes/m.ply")).is_err());
        assert!(files.declare(&at("tests/scenes/../../common")));
        assert!(!files.declare(&at("common/meshes")));
        assert!(files.read(&at("tests/scenes/../../common/meshes/m.ply")).is_ok());
        for other in ["common/meshes/password", "common/s.xml", "beside.ply"] {
            assert!(files.read(&at(other)).is_err(), "{other}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_nowhere_else() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let scenes = place.path().join("scenes");
        std::fs::create_dir(&scenes).expect("creatable");
        std::fs::write(place.path().join("secret"), "x").expect("writable");
        std::os::unix::fs::symlink("../secret", scenes.join("mesh.obj")).expect("linkable");
        assert!(Confined::new(&scenes.join("s.xml"), &[]).read(&scenes.join("mesh.obj")).is_err());
    }
}
