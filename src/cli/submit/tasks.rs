//! Which passes each task renders.

use std::path::{Path, PathBuf};

use super::super::failure::Failure;
use crate::session::{Error, Parts, Session, files_of_parts};

/// The parts in a folder.
///
/// # Errors
/// When the folder cannot be read.
pub fn parts(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    match files_of_parts(&[folder.to_path_buf()]) {
        Err(Error::NoParts) => Ok(Vec::new()),
        files => files,
    }
}

/// The ranges of passes that are not in `parts`: those that were begun, which are resumed, and the rest in pieces as long
/// as `jobs` equal ones of all passes.
///
/// # Errors
/// When parts are damaged, or of another render than the session's.
pub fn tasks(parts: &[PathBuf], session: &Session, passes: u32, jobs: u32) -> Result<Vec<[u32; 2]>, Failure> {
    let mut gaps = vec![[0, passes]];
    let mut tasks = Vec::new();
    if !parts.is_empty() {
        let parts = Parts::read(parts)?;
        parts.check_session(session)?;
        tasks = parts.unfinished();
        gaps = parts.unclaimed(passes);
    }
    tasks.extend(gaps.into_iter().flat_map(|gap| pieces(gap, passes, jobs)));
    tasks.sort_unstable();
    Ok(tasks)
}

/// A range cut where `jobs` equal pieces of 0..`passes` meet.
fn pieces([first, end]: [u32; 2], passes: u32, jobs: u32) -> Vec<[u32; 2]> {
    let cut = |i: u32| (u64::from(passes) * u64::from(i) / u64::from(jobs)) as u32;
    let cuts = (0..=jobs.min(passes)).map(|i| if jobs > passes { i } else { cut(i) });
    let mut ends: Vec<u32> = cuts.filter(|cut| (first + 1..end).contains(cut)).collect();
    ends.extend([first, end]);
    ends.sort_unstable();
    ends.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_of_nearly_one_length_and_leave_nothing_out() {
        assert_eq!(pieces([0, 8], 8, 3), [[0, 2], [2, 5], [5, 8]]);
        assert_eq!(pieces([0, 3], 3, 10), [[0, 1], [1, 2], [2, 3]]);
        assert_eq!(pieces([3, 7], 8, 4), [[3, 4], [4, 6], [6, 7]]);
        let all = pieces([0, 4096], 4096, 64);
        assert!(all.len() == 64 && all.iter().all(|[a, b]| b - a == 64));
    }
}
