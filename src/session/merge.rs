//! Parts of a render → its picture.

use std::path::{Path, PathBuf};

use caustica_formats::image::atomic_write;

use super::error::Error;
use super::layers::{Content, Layers};
use super::passes::{missing, overlap};
use super::picture::{Picture, PictureInfo};
use crate::film::{Aov, Pixels};
use crate::render::{Checkpoint, CheckpointError, Head};

/// What a checkpoint says of the picture.
pub(super) fn info_of(head: &Head) -> Result<PictureInfo, CheckpointError> {
    serde_json::from_str(&head.about)
        .map_err(|_| CheckpointError::Invalid("what it says of its picture is not ours"))
}

/// Makes sure that two checkpoints are of one render.
pub(super) fn agree(files: [&Path; 2], heads: [&Head; 2]) -> Result<(), Error> {
    let unlike = |name: &str, values: [String; 2]| {
        let files = Box::new(files.map(Path::to_path_buf));
        Err(Error::Unlike { files, name: name.to_owned(), values: Box::new(values) })
    };
    match heads[0].check(&heads[1].identity) {
        Err(CheckpointError::Different { name, was, now }) => return unlike(&name, [was, now]),
        other => other.map_err(|source| Error::Part { file: files[0].to_path_buf(), source })?,
    }
    let part =
        |i: usize| info_of(heads[i]).map_err(|source| Error::Part { file: files[i].to_path_buf(), source });
    let names = [part(0)?, part(1)?].map(|info| {
        let names: Vec<String> = info.layers.iter().map(|layer| layer.name.clone()).collect();
        names.join(",")
    });
    if names[0] == names[1] { Ok(()) } else { unlike("layers", names) }
}

/// Makes sure that no pass is in two of the ranges, each with its file.
pub(super) fn disjoint(a: (&Path, [u32; 2]), b: (&Path, [u32; 2])) -> Result<(), Error> {
    let passes = [a.1[0].max(b.1[0]), a.1[1].min(b.1[1])];
    if passes[0] >= passes[1] {
        return Ok(());
    }
    Err(Error::Overlap { files: Box::new([a.0.to_path_buf(), b.0.to_path_buf()]), passes })
}

/// Adds up parts of one render, in any order; each may be forgotten when it is added.
#[derive(Debug, Default)]
pub struct Merge {
    sums: Option<Pixels>,
    /// The part that begins first, with the name that it is called by.
    lowest: Option<(PathBuf, Head)>,
    /// Passes of each.
    parts: Vec<(PathBuf, Head)>,
}

/// What a checkpoint says of its passes. Of thousands, the rest would take more memory than the sums.
pub(super) fn passes_of(head: &Head) -> Head {
    Head { identity: Vec::new(), about: String::new(), ..*head }
}

/// Passes of a render that were made in parts.
#[derive(Debug)]
pub struct Merged {
    info: PictureInfo,
    head: Head,
    /// The pass after the last one.
    end: u32,
    pixels: Pixels,
    missing: Vec<[u32; 2]>,
}

impl Merge {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a part: the bytes of a checkpoint, which errors call `name`.
    ///
    /// # Errors
    /// [`Error::Part`] for what is damaged or no checkpoint, [`Error::Unlike`] for a part of another render and
    /// [`Error::Overlap`] for passes that are there already. Nothing is added then.
    pub fn add(&mut self, name: &Path, bytes: &[u8]) -> Result<(), Error> {
        let problem = |source| Error::Part { file: name.to_path_buf(), source };
        let Checkpoint { head, pixels } = Checkpoint::decode(bytes).map_err(problem)?;
        let info = info_of(&head).map_err(problem)?;
        let count = info.size.iter().try_fold(1usize, |n, side| n.checked_mul(*side as usize));
        let aovs = Aov::numbers_of(&info.aovs).checked_mul(pixels.len());
        if count != Some(pixels.len()) || aovs != Some(pixels.numbers_of_aovs()) {
            return Err(problem(CheckpointError::Invalid("its sums do not fit its picture")));
        }
        if let Some((lowest, other)) = &self.lowest {
            agree([lowest, name], [other, &head])?;
        }
        let range = [head.first, head.end()];
        self.parts
            .iter()
            .try_for_each(|(file, other)| disjoint((file, [other.first, other.end()]), (name, range)))?;
        match &mut self.sums {
            None => self.sums = Some(pixels),
            Some(sums) => {
                if !sums.agree(&pixels) {
                    let values = Box::new([sums.common, pixels.common].map(|common| common.to_string()));
                    let files = Box::new([self.parts[0].0.clone(), name.to_path_buf()]);
                    return Err(Error::Unlike { files, name: "what a pass is".to_owned(), values });
                }
                let end = self.parts.iter().map(|(_, head)| head.end()).max().unwrap_or(0);
                sums.merge(end, &pixels, head.end());
            }
        }
        self.parts.push((name.to_path_buf(), passes_of(&head)));
        if self.lowest.as_ref().is_none_or(|(_, lowest)| head.first < lowest.first) {
            self.lowest = Some((name.to_path_buf(), head));
        }
        if let Some(sums) = &mut self.sums {
            sums.complete_until(missing(ranges(&self.parts), u32::MAX).first().map_or(0, |gap| gap[0]));
        }
        Ok(())
    }

    /// What was added, or the error that nothing was.
    ///
    /// With `passes`, the whole render has so many; else as many as the parts say.
    ///
    /// # Errors
    /// [`Error::NoParts`]; [`Error::Missing`] for passes that no part holds, unless `allow_missing`; [`Error::Beyond`]
    /// where a part holds more than `passes`.
    pub fn finish(self, passes: Option<u32>, allow_missing: bool) -> Result<Merged, Error> {
        let Self { sums, lowest, parts } = self;
        let gaps = gaps(&parts, passes, allow_missing)?;
        let (Some(pixels), Some((file, first))) = (sums, lowest) else { return Err(Error::NoParts) };
        let count = parts.iter().map(|(_, head)| head.passes).sum();
        let end = parts.iter().map(|(_, head)| head.end()).max().unwrap_or(0);
        let info = info_of(&first).map_err(|source| Error::Part { file, source })?;
        let head = Head { passes: count, until: 0, whole: whole(&parts, passes), ..first };
        Ok(Merged { info, head, end, pixels, missing: gaps })
    }
}

fn ranges(parts: &[(PathBuf, Head)]) -> Vec<[u32; 2]> {
    parts.iter().map(|(_, head)| [head.first, head.end()]).collect()
}

/// Passes of the whole render.
pub(super) fn whole(parts: &[(PathBuf, Head)], passes: Option<u32>) -> u32 {
    let said = parts.iter().map(|(_, head)| head.whole.max(head.until).max(head.end())).max();
    passes.unwrap_or(said.unwrap_or(0))
}

/// Passes that no part holds, which is an error unless they may be missing.
pub(super) fn gaps(
    parts: &[(PathBuf, Head)],
    passes: Option<u32>,
    allowed: bool,
) -> Result<Vec<[u32; 2]>, Error> {
    let whole = whole(parts, passes);
    if let Some((file, head)) = parts.iter().find(|(_, head)| head.end() > whole) {
        return Err(Error::Beyond { file: file.clone(), passes: [head.first, head.end()], whole });
    }
    let missing = missing(ranges(parts), whole);
    if allowed || missing.is_empty() {
        return Ok(missing);
    }
    let begun = parts.iter().filter(|(_, head)| head.end() < head.until).map(|(file, _)| file.clone());
    Err(Error::Missing { missing, whole, begun: begun.collect() })
}

impl Merged {
    /// What the picture is.
    pub fn info(&self) -> &PictureInfo {
        &self.info
    }

    /// Passes in the picture.
    pub fn passes(&self) -> u32 {
        self.head.passes
    }

    /// Passes that are not: of each range the first and the one after the last.
    pub fn missing(&self) -> &[[u32; 2]] {
        &self.missing
    }

    /// See [`Pixels::relative_error`]; infinite where it is not known.
    pub fn relative_error(&self) -> f64 {
        self.pixels.relative_error(self.passes())
    }

    /// Stores other layers than were asked for when the parts were rendered.
    ///
    /// # Errors
    /// [`Error::NotRendered`] for a layer that the parts do not hold.
    pub fn set_layers(&mut self, layers: Layers) -> Result<(), Error> {
        check_layers(&self.info, &layers)?;
        self.info.layers = layers;
        Ok(())
    }

    /// The picture.
    pub fn picture(&self) -> Picture<'_> {
        let passes = [self.head.first, self.passes()];
        Picture { info: self.info.clone(), pixels: &self.pixels, passes, missing: self.missing.clone() }
    }

    /// Writes a checkpoint that holds what all parts held: it may be merged again, and a render that begins with pass 0
    /// may go on from it.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] when the file cannot be written, [`Error::Missing`] when passes are missing between others.
    pub fn save(&self, file: &Path) -> Result<(), Error> {
        let range = [self.head.first, self.end];
        let between: Vec<[u32; 2]> =
            self.missing.iter().filter(|gap| overlap(**gap, range)).copied().collect();
        if !between.is_empty() {
            return Err(Error::Missing { missing: between, whole: self.head.whole, begun: Vec::new() });
        }
        let bytes = Checkpoint::encode(&self.head, &self.pixels);
        atomic_write(file, &bytes).map_err(|source| Error::Checkpoint { file: file.to_path_buf(), source })
    }
}

/// Makes sure that parts with this picture hold what layers show.
pub(super) fn check_layers(info: &PictureInfo, layers: &Layers) -> Result<(), Error> {
    let absent = |content: Content| matches!(content, Content::Surface(aov) if !info.aovs.contains(&aov));
    match layers.iter().find(|layer| absent(layer.content)) {
        Some(layer) => Err(Error::NotRendered(layer.name.clone())),
        None => Ok(()),
    }
}
