//! Atomic output: a file has either its old or its new content, never a part of it.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::files::plain;

/// Writes `bytes` to `path` through a temporary file in the same folder that is flushed to disk and
/// then renamed over the target. The temporary file is removed when anything fails.
///
/// # Errors
/// When the folder or the file cannot be written; the old file is then as it was.
pub fn atomic_write(path: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    write(path.as_ref(), bytes, true).map_err(plain)
}

/// As [`atomic_write`] without the flush: safe against a crash of the program, but not of the machine.
///
/// # Errors
/// When the folder or the file cannot be written; the old file is then as it was.
pub fn atomic_replace(path: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    write(path.as_ref(), bytes, false).map_err(plain)
}

fn write(path: &Path, bytes: &[u8], flush: bool) -> io::Result<()> {
    Staged::new(path, bytes, flush)?.commit()
}

/// The new content of a file, written beside it and not yet in its place. It is removed unless it is committed.
#[derive(Debug)]
pub enum Staged {
    /// The temporary file, and its place.
    Beside(TempPath, PathBuf),
    /// For a pipe or device, which cannot be replaced, only written to.
    Direct(Vec<u8>, PathBuf),
}

impl Staged {
    /// Writes `bytes` beside `path`; `flush` waits until they are on the disk.
    ///
    /// # Errors
    /// When `path` is a folder, or its folder cannot be written to.
    pub fn new(path: &Path, bytes: &[u8], flush: bool) -> io::Result<Self> {
        let old = std::fs::metadata(path).ok();
        if old.as_ref().is_some_and(std::fs::Metadata::is_dir) {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        if old.as_ref().is_some_and(|old| !old.is_file()) {
            return Ok(Self::Direct(bytes.to_vec(), path.to_path_buf()));
        }
        // Through a link the file it stands for is replaced, not the link.
        let path = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".caustica-");
        // Temporary files are private by default; an output gets what any new file would.
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = old.map_or(0o666, |old| old.permissions().mode() & 0o777);
            builder.permissions(std::fs::Permissions::from_mode(mode));
        }
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(bytes)?;
        if flush {
            file.as_file().sync_all()?;
        }
        // Thousands may be staged at a time, so none is kept open.
        Ok(Self::Beside(file.into_temp_path(), path))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// When that is not possible; the old file is then as it was.
    pub fn commit(self) -> io::Result<()> {
        match self {
            Self::Beside(file, path) => file.persist(path).map_err(|failed| failed.error),
            Self::Direct(bytes, path) => std::fs::File::options().write(true).open(path)?.write_all(&bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("out.bin");
        atomic_write(&path, b"one").expect("first write");
        atomic_write(&path, b"two").expect("second write");
        assert_eq!(std::fs::read(&path).expect("readable"), b"two");
        assert_eq!(std::fs::read_dir(folder.path()).expect("listable").count(), 1);
    }

    #[test]
    fn a_missing_folder_is_an_error() {
        assert!(atomic_write("/nonexistent-folder/file", b"x").is_err());
    }

    #[test]
    fn a_folder_is_not_replaced() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let target = folder.path().join("sub");
        std::fs::create_dir(&target).expect("creatable");
        assert!(atomic_write(&target, b"x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).expect("listable").count(), 1);
    }
}
