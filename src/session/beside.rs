//! Files in memory that stand beside those of a scene.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use caustica_formats::files::Files;

/// Some files over those of another source.
#[derive(Debug)]
pub struct Beside<'a> {
    /// The other source.
    pub below: &'a dyn Files,
    /// Contents by path; they win.
    pub made: &'a BTreeMap<PathBuf, Vec<u8>>,
}

impl Files for Beside<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.made.get(path).cloned().map_or_else(|| self.below.read(path), Ok)
    }

    fn check(&self, path: &Path) -> io::Result<()> {
        if self.made.contains_key(path) { Ok(()) } else { self.below.check(path) }
    }

    fn is_file(&self, path: &Path) -> bool {
        self.made.contains_key(path) || self.below.is_file(path)
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        self.below.names(folder)
    }

    fn declare(&self, folder: &Path) -> bool {
        self.below.declare(folder)
    }

    fn outside(&self) -> Vec<PathBuf> {
        self.below.outside()
    }
}
