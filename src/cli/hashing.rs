//! A file source that remembers what it served, so that a render can be tied to its scene.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use caustica_formats::files::Files;

use crate::sampling::mix;

/// Wraps a source; the hash does not depend on the order of reads.
#[derive(Debug)]
pub struct Hashing<'a> {
    inner: &'a dyn Files,
    sum: AtomicU64,
    paths: Mutex<BTreeSet<PathBuf>>,
}

impl<'a> Hashing<'a> {
    pub fn new(inner: &'a dyn Files) -> Self {
        Self { inner, sum: AtomicU64::new(0), paths: Mutex::default() }
    }

    /// The files read so far, links followed.
    pub fn paths(self) -> BTreeSet<PathBuf> {
        self.paths.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hash of the contents of all files read so far.
    pub fn hash(&self) -> String {
        format!("{:016x}", self.sum.load(Ordering::Relaxed))
    }
}

fn hash(bytes: &[u8]) -> u64 {
    let mut words = bytes.chunks_exact(8);
    let mut h = words
        .by_ref()
        .fold(bytes.len() as u64, |h, w| mix(h ^ u64::from_le_bytes(w.try_into().unwrap_or_default())));
    for &b in words.remainder() {
        h = mix(h ^ u64::from(b));
    }
    h
}

impl Files for Hashing<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.inner.read(path)?;
        self.sum.fetch_add(hash(&bytes), Ordering::Relaxed);
        if let Ok(real) = std::fs::canonicalize(path) {
            self.paths.lock().unwrap_or_else(PoisonError::into_inner).insert(real);
        }
        Ok(bytes)
    }

    fn is_file(&self, path: &Path) -> bool {
        self.inner.is_file(path)
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        self.inner.names(folder)
    }

    fn declare(&self, folder: &Path) -> bool {
        self.inner.declare(folder)
    }
}
