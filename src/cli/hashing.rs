//! A file source that remembers what it served, so that a render can be tied to its scene.

use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use caustica_formats::files::Files;

use crate::sampling::mix;

/// Wraps a source; the hash does not depend on the order of reads.
#[derive(Debug)]
pub struct Hashing<'a> {
    inner: &'a dyn Files,
    sum: AtomicU64,
}

impl<'a> Hashing<'a> {
    pub fn new(inner: &'a dyn Files) -> Self {
        Self { inner, sum: AtomicU64::new(0) }
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
