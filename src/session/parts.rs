//! Files that hold parts of a render: what would be refused is found before their sums are read.

use std::path::{Path, PathBuf};

use caustica_formats::files::plain;
use caustica_formats::memory::available;

use super::Session;
use super::error::Error;
use super::layers::Layers;
use super::merge::{Merge, Merged, agree, check_layers, disjoint, gaps, info_of, passes_of, whole};
use super::passes::missing;
use super::picture::PictureInfo;
use crate::film::{Aov, BinnedSums, STRIDE};
use crate::render::{CheckpointError, Head};

/// The files that are named, and for a folder those in it whose names end with `.ckpt`.
///
/// # Errors
/// [`Error::Part`] when a folder cannot be read, [`Error::NoParts`] when there are none.
pub fn files_of_parts(named: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    for place in named {
        if !place.is_dir() {
            files.push(place.clone());
            continue;
        }
        let entries = std::fs::read_dir(place).and_then(Iterator::collect::<Result<Vec<_>, _>>);
        let entries = entries.map_err(|e| unreadable(place, e))?.into_iter().map(|entry| entry.path());
        let mut parts: Vec<PathBuf> =
            entries.filter(|file| file.extension().is_some_and(|e| e == "ckpt")).collect();
        parts.sort();
        files.extend(parts);
    }
    if files.is_empty() { Err(Error::NoParts) } else { Ok(files) }
}

/// Checkpoints of one render, in the order of their passes.
#[derive(Debug)]
pub struct Parts {
    /// With what is said of their passes.
    files: Vec<(PathBuf, Head)>,
    /// The part that begins first.
    lowest: (PathBuf, Head),
    info: PictureInfo,
}

impl Parts {
    /// Reads the heads of files, and makes sure that they are of one render and have no pass in common.
    ///
    /// # Errors
    /// [`Error::NoParts`], [`Error::Part`], [`Error::Unlike`] or [`Error::Overlap`], with the first problem.
    pub fn read(files: &[PathBuf]) -> Result<Self, Error> {
        let mut parts = Vec::new();
        let mut lowest: Option<(PathBuf, Head)> = None;
        for file in files {
            let head = head(file)?;
            if let Some((lowest, other)) = &lowest {
                agree([lowest, file], [other, &head])?;
            }
            parts.push((file.clone(), passes_of(&head)));
            if lowest.as_ref().is_none_or(|(_, lowest)| head.first < lowest.first) {
                lowest = Some((file.clone(), head));
            }
        }
        let Some((first, head)) = lowest else { return Err(Error::NoParts) };
        let info = info_of(&head).map_err(|source| Error::Part { file: first.clone(), source })?;
        parts.sort_by_key(|(_, head)| (head.first, head.passes));
        for pair in parts.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(|(file, head)| (file.as_path(), [head.first, head.end()]));
            disjoint(a, b)?;
        }
        Ok(Self { files: parts, lowest: (first, head), info })
    }

    /// What the picture is.
    pub fn info(&self) -> &PictureInfo {
        &self.info
    }

    /// The files, in the order of their passes.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|(file, _)| file.as_path())
    }

    /// Passes that no part holds, of `passes` or as many as the parts say.
    pub fn missing(&self, passes: Option<u32>) -> Vec<[u32; 2]> {
        let ranges = self.files.iter().map(|(_, head)| [head.first, head.end()]).collect();
        missing(ranges, whole(&self.files, passes))
    }

    /// Passes that no part holds nor was begun for.
    pub fn unclaimed(&self, passes: u32) -> Vec<[u32; 2]> {
        let ranges = self.files.iter().map(|(_, head)| [head.first, head.end().max(head.until)]).collect();
        missing(ranges, passes)
    }

    /// The ranges of parts that end before the passes which they were to hold.
    pub fn unfinished(&self) -> Vec<[u32; 2]> {
        let parts = self.files.iter().filter(|(_, head)| head.end() < head.until);
        parts.map(|(_, head)| [head.first, head.until]).collect()
    }

    /// Makes sure that they are of a render of this session.
    ///
    /// # Errors
    /// [`Error::Part`] with what differs.
    pub fn check_session(&self, session: &Session) -> Result<(), Error> {
        let (file, head) = &self.lowest;
        let now = super::checkpoint::head(session);
        head.check(&now.identity).map_err(|source| Error::Part { file: file.clone(), source })
    }

    /// Finds out before the sums are read what would fail after it.
    ///
    /// # Errors
    /// As [`Merge::finish`], [`Merged::set_layers`], and [`Error::Memory`].
    pub fn check(
        &self,
        passes: Option<u32>,
        allow_missing: bool,
        layers: Option<&Layers>,
    ) -> Result<(), Error> {
        gaps(&self.files, passes, allow_missing)?;
        layers.map_or(Ok(()), |layers| check_layers(&self.info, layers))?;
        let [width, height] = self.info.size;
        let numbers = STRIDE + Aov::numbers_of(&self.info.aovs);
        // All that is summed so far, a part, and the file that it is read from.
        let sum = 2 * BinnedSums::BYTES + BinnedSums::PACKED;
        let needed = u128::from(width) * u128::from(height) * (numbers * sum) as u128;
        let free = available();
        if needed <= free {
            return Ok(());
        }
        Err(Error::Memory { what: format!("merging {width} × {height} pixels"), needed, free })
    }

    /// Adds them up, one at a time, and calls `progress` after each.
    ///
    /// # Errors
    /// As [`Merge::add`] and [`Merge::finish`].
    pub fn merge(
        &self,
        passes: Option<u32>,
        allow_missing: bool,
        progress: &mut dyn FnMut(&Path),
    ) -> Result<Merged, Error> {
        let mut merge = Merge::new();
        for (file, _) in &self.files {
            let bytes = std::fs::read(file).map_err(|e| unreadable(file, e))?;
            merge.add(file, &bytes)?;
            progress(file);
        }
        merge.finish(passes, allow_missing)
    }
}

fn unreadable(file: &Path, error: std::io::Error) -> Error {
    Error::Part { file: file.to_path_buf(), source: CheckpointError::Io(plain(error)) }
}

fn head(file: &Path) -> Result<Head, Error> {
    Head::read(file).map_err(|source| match source {
        CheckpointError::Io(e) => unreadable(file, e),
        source => Error::Part { file: file.to_path_buf(), source },
    })
}
