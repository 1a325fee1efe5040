//! One process at a time writes an output.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use caustica_formats::files::words;

use super::{Error, place};

/// Held while a render may write `path`; the system lets go of it even after kill -9.
#[derive(Debug)]
pub struct Lock {
    /// Kept open for its lock only.
    _file: File,
    beside: PathBuf,
}

impl Lock {
    /// `None` where files cannot be locked, as on some network folders.
    ///
    /// # Errors
    /// [`Error::Locked`] while another process holds it; [`Error::Unwritable`] where no file can be made.
    pub fn take(path: &Path) -> Result<Option<Self>, Error> {
        // Through a link the file it stands for is written.
        let target = place::real(path);
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        let beside = target.with_file_name(format!(".{name}.lock"));
        loop {
            let file = File::options().create(true).truncate(false).write(true).open(&beside);
            let file = file.map_err(|e| Error::Unwritable { file: path.to_path_buf(), why: words(&e) })?;
            match file.try_lock() {
                Ok(()) if same(&file, &beside) => return Ok(Some(Self { _file: file, beside })),
                // The process that had it removed the file between our two steps.
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(Error::Locked(path.to_path_buf()));
                }
                Err(TryLockError::Error(_)) => return Ok(None),
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that is left behind is harmless: it is not locked.
        let _left = std::fs::remove_file(&self.beside);
    }
}

#[cfg(unix)]
fn same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let inode = |m: std::io::Result<std::fs::Metadata>| m.ok().map(|m| (m.dev(), m.ino()));
    inode(file.metadata()) == inode(std::fs::metadata(path))
}

#[cfg(not(unix))]
fn same(_file: &File, _path: &Path) -> bool {
    true
}
