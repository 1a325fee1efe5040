//! A file source that remembers what it served, so that a render can be tied to its scene.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use caustica_formats::files::Files;

use crate::sampling::mix;

/// Wraps a source. Contents are hashed together with their names, so that two files which exchange theirs
/// make another scene.
#[derive(Debug)]
pub struct Hashing<'a> {
    inner: &'a dyn Files,
    /// Its folder is what names are relative to, and its own name does not count: a scene that is moved as
    /// a whole or renamed stays the same.
    scene: PathBuf,
    served: Mutex<Served>,
}

/// What was read so far.
#[derive(Clone, Debug, Default)]
pub struct Served {
    /// Hashes of contents by name, in an order that does not depend on that of the reads.
    contents: BTreeMap<PathBuf, u64>,
    /// Links followed.
    files: BTreeSet<PathBuf>,
}

impl<'a> Hashing<'a> {
    /// For the files of the scene at `scene`.
    pub fn new(inner: &'a dyn Files, scene: &Path) -> Self {
        Self { inner, scene: scene.to_path_buf(), served: Mutex::default() }
    }

    /// After another source of the same scene has served files.
    pub fn going_on(inner: &'a dyn Files, scene: &Path, served: Served) -> Self {
        Self { inner, scene: scene.to_path_buf(), served: Mutex::new(served) }
    }

    /// What was read.
    pub fn into_served(self) -> Served {
        self.served.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes it the hash of a scene in which a value was changed.
    pub fn change(&mut self, key: &str, numbers: &[f64]) {
        let served = self.served.get_mut().unwrap_or_else(PoisonError::into_inner);
        let content = numbers.iter().fold(numbers.len() as u64, |h, v| mix(h ^ v.to_bits()));
        // No file is called so: a name ends at the zero.
        served.contents.insert(PathBuf::from(format!("\0{key}")), content);
    }

    fn name(&self, path: &Path) -> PathBuf {
        let folder = self.scene.parent().unwrap_or(Path::new(""));
        if path == self.scene {
            PathBuf::new()
        } else {
            path.strip_prefix(folder).unwrap_or(path).to_path_buf()
        }
    }

    /// Hash of names and contents of the files read, and these files with links followed.
    pub fn finish(self) -> (String, BTreeSet<PathBuf>) {
        let served = self.into_served();
        let sum = served
            .contents
            .iter()
            .fold(0, |h, (name, content)| mix(mix(h ^ hash(name.as_os_str().as_encoded_bytes())) ^ content));
        (format!("{sum:016x}"), served.files)
    }
}

fn hash(bytes: &[u8]) -> u64 {
    // Four sums side by side: each step has to wait for the one before it.
    let (blocks, rest) = bytes.as_chunks::<32>();
    let mut sums = [0, 1, 2, 3];
    for block in blocks {
        for (sum, word) in sums.iter_mut().zip(block.as_chunks::<8>().0) {
            *sum = mix(*sum ^ u64::from_le_bytes(*word));
        }
    }
    let h = sums.into_iter().fold(bytes.len() as u64, |h, sum| mix(h ^ sum));
    rest.iter().fold(h, |h, b| mix(h ^ u64::from(*b)))
}

impl Files for Hashing<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.inner.read(path)?;
        let content = hash(&bytes);
        let name = self.name(path);
        let mut served = self.served.lock().unwrap_or_else(PoisonError::into_inner);
        served.contents.insert(name, content);
        served.files.extend(std::fs::canonicalize(path));
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

    fn outside(&self) -> Vec<PathBuf> {
        self.inner.outside()
    }
}

#[cfg(test)]
mod tests {
    use caustica_formats::files::Memory;

    use super::*;

    fn hash_of(folder: &str, files: &[(&str, &str)]) -> String {
        let named = files.iter().map(|(name, text)| (Path::new(folder).join(name), text.as_bytes().to_vec()));
        let memory = Memory(named.collect());
        let hashing = Hashing::new(&memory, &Path::new(folder).join("s.xml"));
        for (name, _) in files {
            hashing.read(&Path::new(folder).join(name)).unwrap();
        }
        hashing.finish().0
    }

    #[test]
    fn contents_belong_to_their_names_but_not_to_the_order_or_the_folder() {
        let hash = hash_of("a", &[("s.xml", "scene"), ("x.png", "red"), ("y.png", "blue")]);
        assert_ne!(hash, hash_of("a", &[("s.xml", "scene"), ("x.png", "blue"), ("y.png", "red")]));
        assert_eq!(hash, hash_of("a", &[("y.png", "blue"), ("s.xml", "scene"), ("x.png", "red")]));
        assert_eq!(hash, hash_of("b/c", &[("s.xml", "scene"), ("x.png", "red"), ("y.png", "blue")]));
    }
}
