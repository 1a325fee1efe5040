//! `--update`: images become the new references.

use super::comparison::{Compared, Comparison};
use super::error::CompareError;
use super::page::Page;
use super::pairs::Pair;
use super::report::{Action, Report, Update};
use super::variance::beside;
use crate::pixels::Pixels;
use caustica_formats::image::{Staged, atomic_write};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Which images are accepted as references.
#[derive(Debug)]
pub enum Accepted {
    /// All that differ: beyond a threshold, or where none is set, in any pixel.
    All,
    /// These, where a pixel differs.
    Named(BTreeSet<String>),
}

/// An image that was compared with the reference that it may replace.
#[derive(Debug)]
pub struct Candidate<'a> {
    pub pair: &'a Pair,
    /// The image's file, as it was compared.
    pub bytes: &'a [u8],
    pub image: &'a Pixels,
    pub reference: &'a Pixels,
    pub compared: &'a Compared,
}

impl Accepted {
    /// From the value of `--update`; `known` are all pictures of the run.
    ///
    /// # Errors
    /// A name is that of no picture.
    pub fn new(names: Option<&str>, known: &[&str]) -> Result<Self, CompareError> {
        let Some(names) = names else { return Ok(Self::All) };
        let names: BTreeSet<String> = names.split(',').map(|n| n.trim().to_owned()).collect();
        match names.iter().find(|n| !known.contains(&n.as_str())) {
            Some(name) => {
                let far = |other: &str| strsim::damerau_levenshtein(name, other);
                let near = known.iter().filter(|other| far(other) <= 2).min_by_key(|other| far(other));
                let hint = near.map(|other| (*other).to_owned());
                Err(CompareError::NoSuchPicture { name: name.clone(), hint })
            }
            None => Ok(Self::Named(names)),
        }
    }

    fn has(&self, name: &str) -> bool {
        match self {
            Self::All => true,
            Self::Named(names) => names.contains(name),
        }
    }

    /// Why a reference is not to be replaced.
    fn refusal(&self, of: &Candidate<'_>) -> Option<String> {
        let comparison = &of.compared.comparison;
        let limits = matches!(self, Self::All) && !comparison.checks.is_empty();
        let [image, reference] = [&of.pair.image, &of.pair.reference].map(|p| extension(p));
        if !self.has(&of.pair.name) {
            Some("not named".to_owned())
        } else if of.image == of.reference {
            Some("equal pixels".to_owned())
        } else if limits && comparison.holds {
            Some("every threshold holds".to_owned())
        } else if image != reference {
            Some(format!("the image is .{image} and the reference .{reference}"))
        } else {
            stale_variance(of.pair)
        }
    }

    /// Replaces the reference by the image if that is accepted: first a page with both is written into `pages`, then
    /// the file is put in the reference's place in one step, a variance image beside it with it.
    ///
    /// # Errors
    /// The page or the reference cannot be written. The reference is then as it was.
    pub fn replace(&self, of: &Candidate<'_>, pages: &Path) -> Result<Update, CompareError> {
        let Pair { name, image, reference } = of.pair;
        let update = |action, page: Option<&Path>, reason| Update {
            name: name.clone(),
            action,
            image: image.display().to_string(),
            reference: reference.display().to_string(),
            page: page.map(|p| p.display().to_string()),
            reason,
        };
        if let Some(reason) = self.refusal(of) {
            return Ok(update(Action::Kept, None, Some(reason)));
        }
        let page = pages.join(format!("{name}.html"));
        write(&page, before_and_after(of).as_bytes())?;
        put(image, of.bytes, reference)?;
        Ok(update(Action::Replaced, Some(&page), None))
    }

    /// Makes an image without a reference one; `bytes` is its file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(
        &self,
        name: &str,
        image: &Path,
        bytes: &[u8],
        reference: &Path,
    ) -> Result<Option<Update>, CompareError> {
        if !self.has(name) {
            return Ok(None);
        }
        folder_of(reference)?;
        put(image, bytes, reference)?;
        let [image, reference] = [image, reference].map(|p| p.display().to_string());
        let name = name.to_owned();
        Ok(Some(Update { name, action: Action::Added, image, reference, page: None, reason: None }))
    }
}

/// A reference that stays because its pair could not be compared.
pub fn kept(name: &str, image: &Path, reference: &Path) -> Update {
    Update {
        name: name.to_owned(),
        action: Action::Kept,
        image: image.display().to_string(),
        reference: reference.display().to_string(),
        page: None,
        reason: Some("not compared".to_owned()),
    }
}

fn extension(path: &Path) -> String {
    path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase())
}

/// The variance image of the old reference would be taken for that of the new one.
fn stale_variance(pair: &Pair) -> Option<String> {
    let (old, _) = beside(&pair.reference)?;
    let new = variance_of(&pair.image, &pair.reference);
    let same = new.is_some_and(|(_, to)| to == old);
    (!same).then(|| {
        format!(
            "{} is the variance of the old picture; remove it or put a new one beside the image",
            old.display()
        )
    })
}

/// The variance image beside an image, and where it goes beside the reference.
fn variance_of(image: &Path, reference: &Path) -> Option<(PathBuf, PathBuf)> {
    let (from, _) = beside(image)?;
    let (stem, long) = (image.file_stem()?.to_str()?, from.file_stem()?.to_str()?);
    let suffix = long.strip_prefix(stem)?;
    let name = format!("{}{suffix}.{}", reference.file_stem()?.to_str()?, reference.extension()?.to_str()?);
    Some((from, reference.with_file_name(name)))
}

/// Everything is written beside its place before anything is replaced.
fn put(image: &Path, bytes: &[u8], reference: &Path) -> Result<(), CompareError> {
    let io = |path: &Path, source| CompareError::Io { path: path.to_path_buf(), source };
    let stage = |path: &Path, bytes: &[u8]| Staged::new(path, bytes, true).map_err(|e| io(path, e));
    let picture = stage(reference, bytes)?;
    let variance = match variance_of(image, reference) {
        Some((from, to)) => Some((stage(&to, &std::fs::read(&from).map_err(|e| io(&from, e))?)?, to)),
        None => None,
    };
    if let Some((variance, to)) = variance {
        variance.commit().map_err(|e| io(&to, e))?;
    }
    picture.commit().map_err(|e| io(reference, e))
}

fn before_and_after(of: &Candidate<'_>) -> String {
    let mut page = Page::default();
    page.add(of.compared, of.image, of.reference);
    let comparisons: Vec<Comparison> = vec![of.compared.comparison.clone()];
    page.render(&Report { comparisons, labels: Some(["after", "before"]), ..Report::default() })
}

fn folder_of(path: &Path) -> Result<(), CompareError> {
    let Some(folder) = path.parent() else { return Ok(()) };
    std::fs::create_dir_all(folder).map_err(|source| CompareError::Io { path: folder.to_path_buf(), source })
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), CompareError> {
    folder_of(path)?;
    atomic_write(path, bytes).map_err(|source| CompareError::Io { path: path.to_path_buf(), source })
}
