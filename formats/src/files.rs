//! How readers reach files: a folder on disk, or memory for tests and fuzzing.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

/// Source of files. Paths are as produced by [`resolve`].
pub trait Files: fmt::Debug + Sync {
    /// The whole content of a file.
    ///
    /// # Errors
    /// When it is missing, unreadable, or larger than [`MAX_FILE_BYTES`].
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
    /// Whether [`Files::read`] may open a file; nothing is opened.
    ///
    /// # Errors
    /// When it is missing or must not be read.
    fn check(&self, path: &Path) -> io::Result<()> {
        if self.is_file(path) { Ok(()) } else { Err(io::ErrorKind::NotFound.into()) }
    }
    /// Whether `path` is a file that can be read.
    fn is_file(&self, path: &Path) -> bool;
    /// Names of the entries of a folder, for suggestions only; empty when unknown.
    fn names(&self, _folder: &Path) -> Vec<String> {
        Vec::new()
    }
    /// The scene declares a search folder (`<path>`). True when that lets meshes and pictures be read
    /// from where nothing could be read before.
    fn declare(&self, _folder: &Path) -> bool {
        false
    }
    /// Files that the scene names and may not read, links followed.
    fn outside(&self) -> Vec<PathBuf> {
        Vec::new()
    }
}

/// No scene, mesh or texture file may be larger than this (8 GiB).
pub const MAX_FILE_BYTES: u64 = 8 << 30;

/// An error in the system's words, without its number in the system's list.
pub fn words(error: &io::Error) -> String {
    let text = error.to_string();
    let Some((words, rest)) = text.split_once(" (os error ") else { return text };
    let after = rest.split_once(')').map_or("", |(_, after)| after);
    format!("{words}{after}")
}

/// As [`words`], still an error.
pub fn plain(error: io::Error) -> io::Error {
    match words(&error) {
        text if text == error.to_string() => error,
        text => io::Error::new(error.kind(), text),
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.check(path)?;
        std::fs::read(path).map_err(plain)
    }

    fn check(&self, path: &Path) -> io::Result<()> {
        let about = std::fs::metadata(path).map_err(plain)?;
        // A device or a pipe may never end.
        if !about.is_file() {
            return Err(io::Error::other("it is not a regular file"));
        }
        let length = about.len();
        if length > MAX_FILE_BYTES {
            return Err(io::Error::other(format!("{length} bytes is over the limit of {MAX_FILE_BYTES}")));
        }
        Ok(())
    }

    fn is_file(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
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

    fn names(&self, folder: &Path) -> Vec<String> {
        let inside = self.0.keys().filter_map(|path| path.strip_prefix(folder).ok());
        inside.filter_map(|rest| rest.iter().next()?.to_str().map(str::to_owned)).collect()
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

/// The name that differs from `name` in upper and lower case only, if one of `folders` has it.
pub fn other_case(files: &dyn Files, name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    part_by_part(files, name, folders, |names, part| names.into_iter().find(|n| n.eq_ignore_ascii_case(part)))
}

/// The file below one of `folders` to which `choose` leads: of the names in a folder the one it takes for the next
/// part of `name`.
pub(crate) fn part_by_part(
    files: &dyn Files,
    name: &str,
    folders: &[PathBuf],
    choose: impl Fn(Vec<String>, &str) -> Option<String>,
) -> Option<PathBuf> {
    folders.iter().find_map(|folder| {
        let mut found = folder.clone();
        for part in Path::new(name).components() {
            let part = part.as_os_str().to_str()?;
            if part == "." || part == ".." {
                found.push(part);
                continue;
            }
            found.push(choose(files.names(&found), part)?);
        }
        files.is_file(&found).then_some(found)
    })
}

/// What the files of a scene read more than once may add up to, in bytes: includes that multiply each
/// other would fill the memory out of a few kilobytes.
const MAX_REPEATED: u64 = 64 << 20;
/// What a file read once more counts at least: an empty one costs memory too.
const LEAST_REPEATED: u64 = 1 << 10;

/// Keeps count of the files a scene includes. There may be any number of them; their size is limited.
#[derive(Debug, Default)]
pub(crate) struct Included {
    seen: BTreeSet<PathBuf>,
    repeated: u64,
}

impl Included {
    /// Counts one more inclusion of a file of so many bytes.
    pub fn count(&mut self, path: &Path, bytes: usize) -> Result<(), String> {
        if !self.seen.insert(path.to_path_buf()) {
            self.repeated += (bytes as u64).max(LEAST_REPEATED);
        }
        if self.is_full() {
            return Err(format!("files included again and again add up to more than {MAX_REPEATED} bytes"));
        }
        Ok(())
    }

    /// Whether the limit was passed, which [`Self::count`] reported: nothing more should be read.
    pub fn is_full(&self) -> bool {
        self.repeated > MAX_REPEATED
    }
}

/// Most expansion of a compressed file: text reaches 1:50, and a decompression bomb far more.
const MAX_GROWTH: u64 = 400;

pub(crate) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// The content of a gzip file, at most `limit` bytes.
pub(crate) fn unpack(bytes: &[u8], limit: u64) -> Result<Vec<u8>, String> {
    let limit = limit.min((bytes.len() as u64).saturating_mul(MAX_GROWTH).max(1 << 20));
    let mut out = Vec::new();
    let read = MultiGzDecoder::new(bytes).take(limit + 1).read_to_end(&mut out);
    read.map_err(|e| format!("the compressed file is damaged: {e}"))?;
    if out.len() as u64 > limit {
        return Err(format!("it unpacks to more than {limit} bytes"));
    }
    Ok(out)
}
