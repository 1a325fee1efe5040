//! Putting a written scene on the disk: all of it, or nothing.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::{Content, WriteError, Written};
use crate::files::{Files, plain};
use crate::image::Staged;

impl Written {
    /// Writes scene and assets. An asset that is there already with the same bytes is left alone.
    ///
    /// # Errors
    /// When a target is a file that the scene was read from, or exists and `replace` is false, or when a file cannot
    /// be read or written: nothing is changed then. When a file that was written beside its target cannot be moved
    /// there: the files that are new are removed again.
    pub fn save(&self, files: &dyn Files, replace: bool) -> Result<(), WriteError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        self.check(&self.path, replace)?;
        let mut made = Made::default();
        for asset in &self.assets {
            let target = folder.join(&asset.path);
            let bytes = self.content(&asset.content, files)?;
            if is_there(&target, &bytes) {
                continue;
            }
            self.check(&target, replace)?;
            made.stage(target, &bytes, false)?;
        }
        // The scene comes last, and is on the disk when it is seen.
        made.stage(self.path.clone(), self.text.as_bytes(), true)?;
        made.commit()
    }

    fn content<'a>(&'a self, content: &'a Content, files: &dyn Files) -> Result<Cow<'a, [u8]>, WriteError> {
        Ok(match content {
            Content::Bytes(bytes) => bytes.into(),
            Content::Copy(source) => match self.read.get(source) {
                Some(bytes) => bytes.as_slice().into(),
                None => files.read(source).map_err(|error| io(source, error))?.into(),
            },
        })
    }

    fn check(&self, target: &Path, replace: bool) -> Result<(), WriteError> {
        self.spare_inputs(target)?;
        if target.exists() && !replace {
            return Err(WriteError::Exists(target.to_path_buf()));
        }
        Ok(())
    }
}

fn io(path: &Path, error: std::io::Error) -> WriteError {
    WriteError::Io { path: path.to_path_buf(), error: plain(error) }
}

fn is_there(target: &Path, bytes: &[u8]) -> bool {
    let length = std::fs::metadata(target).map(|about| about.len());
    length.is_ok_and(|length| length == bytes.len() as u64)
        && std::fs::read(target).is_ok_and(|old| old == bytes)
}

/// What was made so far; without `commit` it goes again.
#[derive(Default)]
struct Made {
    staged: Vec<(PathBuf, Staged)>,
    folders: Vec<PathBuf>,
    /// Files in their place that were not there before.
    new: Vec<PathBuf>,
    done: bool,
}

impl Made {
    fn stage(&mut self, target: PathBuf, bytes: &[u8], flush: bool) -> Result<(), WriteError> {
        self.folder(target.parent().unwrap_or(Path::new("")))?;
        let staged = Staged::new(&target, bytes, flush).map_err(|error| io(&target, error))?;
        self.staged.push((target, staged));
        Ok(())
    }

    fn folder(&mut self, folder: &Path) -> Result<(), WriteError> {
        if folder.as_os_str().is_empty() || folder.is_dir() {
            return Ok(());
        }
        if let Some(parent) = folder.parent() {
            self.folder(parent)?;
        }
        std::fs::create_dir(folder).map_err(|error| io(folder, error))?;
        self.folders.push(folder.to_path_buf());
        Ok(())
    }

    fn commit(mut self) -> Result<(), WriteError> {
        for (target, staged) in std::mem::take(&mut self.staged) {
            let new = !target.exists();
            staged.commit().map_err(|error| io(&target, error))?;
            if new {
                self.new.push(target);
            }
        }
        self.done = true;
        Ok(())
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        if self.done {
            return;
        }
        self.staged.clear();
        // Nothing can be done where something else was put there meanwhile.
        for file in &self.new {
            let _ = std::fs::remove_file(file);
        }
        for folder in self.folders.iter().rev() {
            let _ = std::fs::remove_dir(folder);
        }
    }
}
