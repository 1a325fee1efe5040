//! Which file is compared with which.

use super::error::CompareError;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Extensions of images in folders. Of files that differ in the extension only, the first one here is taken.
const EXTENSIONS: [&str; 9] = ["exr", "pfm", "hdr", "png", "jpg", "jpeg", "tga", "bmp", "rgbe"];

/// Suffixes of files that belong to a reference and are not compared themselves.
const COMPANIONS: [&str; 4] = [".var", "_var", ".mask", ".density"];

/// An image and its reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Path below the folders, without extension and suffix; for two files the name of the image.
    pub name: String,
    pub image: PathBuf,
    pub reference: PathBuf,
}

/// The pairs of two folders, and what has no partner.
#[derive(Debug, Default)]
pub struct Pairs {
    pub pairs: Vec<Pair>,
    /// References without an image, by name.
    pub missing: Vec<(String, PathBuf)>,
    /// Images without a reference, by name.
    pub extra: Vec<(String, PathBuf)>,
}

/// Finds the pairs of two folders: images whose paths agree up to the extension and a suffix of references
/// (`.ref`, `_ref`, `_ref_rgb`). Variance images and masks are left out.
///
/// # Errors
/// A folder cannot be read.
pub fn in_folders(images: &Path, references: &Path) -> Result<Pairs, CompareError> {
    let mut found = list(images)?;
    let mut pairs = Pairs::default();
    for (name, reference) in list(references)? {
        match found.remove(&name) {
            Some(image) => pairs.pairs.push(Pair { name, image, reference }),
            None => pairs.missing.push((name, reference)),
        }
    }
    pairs.extra = found.into_iter().collect();
    Ok(pairs)
}

fn list(folder: &Path) -> Result<BTreeMap<String, PathBuf>, CompareError> {
    let mut names = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        let io = |source| CompareError::Io { path: next.clone(), source };
        for entry in std::fs::read_dir(&next).map_err(io)? {
            let path = entry.map_err(io)?.path();
            if path.is_dir() {
                folders.push(path);
            } else if let Some(name) = partner_name(path.strip_prefix(folder).unwrap_or(&path)) {
                let rank = |p: &Path| EXTENSIONS.iter().position(|e| Some(*e) == extension(p).as_deref());
                let best = names.entry(name).or_insert_with(|| path.clone());
                if rank(&path) < rank(best) {
                    *best = path;
                }
            }
        }
    }
    Ok(names)
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// The part of the path that an image and its reference share; `None` for other files.
fn partner_name(path: &Path) -> Option<String> {
    EXTENSIONS.contains(&extension(path)?.as_str()).then_some(())?;
    let stem = path.with_extension("").to_string_lossy().replace('\\', "/");
    if COMPANIONS.iter().any(|c| stem.ends_with(c)) {
        return None;
    }
    let shared = [".ref", "_ref_rgb", "_ref"].into_iter().find_map(|suffix| stem.strip_suffix(suffix));
    Some(shared.unwrap_or(&stem).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn partners_in_folders() {
        let root = tempfile::tempdir().unwrap();
        let touch = |p: &str| {
            let path = root.path().join(p);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, b"").unwrap();
        };
        for p in ["i/a.exr", "i/a.png", "i/sub/b.exr", "i/c.exr", "i/notes.txt"] {
            touch(p);
        }
        for p in [
            "r/a.ref.exr",
            "r/a.ref.var.exr",
            "r/a.ref.mask.exr",
            "r/sub/b_ref_rgb.exr",
            "r/sub/b_ref_rgb_var.exr",
            "r/d.exr",
        ] {
            touch(p);
        }
        let (i, r) = (root.path().join("i"), root.path().join("r"));
        let pairs = in_folders(&i, &r).unwrap();
        let names: Vec<_> = pairs.pairs.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["a", "sub/b"]);
        assert_eq!(pairs.pairs[0].image, i.join("a.exr"));
        assert_eq!(pairs.missing, [("d".to_owned(), r.join("d.exr"))]);
        assert_eq!(pairs.extra, [("c".to_owned(), i.join("c.exr"))]);
    }
}
