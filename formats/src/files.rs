//! How readers reach files: a folder on disk, or memory for tests and fuzzing.

use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Source of files. Paths are as produced by [`resolve`].
pub trait Files: fmt::Debug + Sync {
    /// Whole content. Fails when missing, unreadable, or over [`MAX_FILE_BYTES`].
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
    fn is_file(&self, path: &Path) -> bool;
}

/// No scene, mesh or texture file may be larger than this (8 GiB).
pub const MAX_FILE_BYTES: u64 = 8 << 30;

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let length = std::fs::metadata(path)?.len();
        if length > MAX_FILE_BYTES {
            return Err(io::Error::other(format!("{length} bytes is over the limit of {MAX_FILE_BYTES}")));
        }
        std::fs::read(path)
    }

    fn is_file(&self, path: &Path) -> bool {
        path.is_file()
    }
}

/// Files in memory.
#[derive(Clone, Debug, Default)]
pub struct Memory(pub BTreeMap<PathBuf, Vec<u8>>);

impl Files for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(path).cloned().ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))
    }

    fn is_file(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }
}

/// First of `folders` in which `name` exists; `name` itself when it is absolute.
pub fn resolve(files: &dyn Files, name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    let path = Path::new(name);
    if path.is_absolute() {
        return files.is_file(path).then(|| path.to_path_buf());
    }
    folders.iter().map(|folder| folder.join(path)).find(|candidate| files.is_file(candidate))
}
