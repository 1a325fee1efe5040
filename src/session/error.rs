//! Why a session could not do its work.

use std::path::PathBuf;

use caustica_formats::Failure;
use caustica_formats::ir::Crop;
use thiserror::Error as ThisError;

use super::layers::LayerError;
use super::passes::listed;
use super::units::megabytes;
use crate::render::CheckpointError;
use crate::settings::SettingError;

/// What went wrong, with words for the person who asked.
#[derive(Debug, ThisError)]
pub enum Error {
    /// The scene could not be read or compiled.
    #[error(transparent)]
    Scene(#[from] Box<Failure>),
    /// The scene has no sensor of this number.
    #[error("invalid value `{asked}` for `--sensor`: expected {}", sensors(*.count))]
    NoSensor {
        /// Counted from 0.
        asked: usize,
        /// Sensors of the scene.
        count: usize,
    },
    /// What is to be rendered is not on the film.
    #[error("invalid value `{},{},{},{}` for `--crop`: expected a part of the film, which has {} × {} pixels",
        crop.x, crop.y, crop.width, crop.height, film[0], film[1])]
    OutsideFilm {
        /// The part that was asked for.
        crop: Crop,
        /// Width and height.
        film: [u32; 2],
    },
    /// A setting does not exist or cannot have this value.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The layers asked for are none that can be stored.
    #[error(transparent)]
    Layers(#[from] LayerError),
    /// An output would lose something that was asked for.
    #[error("{what} can be stored in .exr files only, and `{}` is the only output", file.display())]
    NeedsExr {
        /// What would be lost.
        what: &'static str,
        /// The first output.
        file: PathBuf,
    },
    /// The extension of an output names no format that can be written.
    #[error("cannot write `{}`: {}; pictures are .exr, .png, .hdr or .pfm", file.display(), if extension.is_empty() { "it has no extension".to_owned() } else { format!("the extension is `{extension}`") })]
    UnknownFormat {
        /// The output.
        file: PathBuf,
        /// In lower case.
        extension: String,
    },
    /// An output is a file that the scene was read from.
    #[error("cannot write `{}`: the scene was read from it", .0.display())]
    IsInput(PathBuf),
    /// Two outputs are one file.
    #[error("`{}` is named for two outputs", .0.display())]
    NamedTwice(PathBuf),
    /// Nothing can be written to this place.
    #[error("cannot write `{}`: {why}", file.display())]
    Unwritable {
        /// The output.
        file: PathBuf,
        /// The system's words, or ours.
        why: String,
    },
    /// Another process writes this file.
    #[error("another process is writing `{}`", .0.display())]
    Locked(PathBuf),
    /// A render would not fit into memory.
    #[error("{what} needs about {} of memory; {} are free", shown(*.needed), shown(*.free))]
    Memory {
        /// The film, or a setting with its value.
        what: String,
        /// Bytes, estimated.
        needed: u128,
        /// Bytes.
        free: u128,
    },
    /// A checkpoint cannot be read, or belongs to another render.
    #[error("cannot resume from `{}`: {source}", file.display())]
    Resume {
        /// The checkpoint.
        file: PathBuf,
        /// What is wrong with it.
        source: CheckpointError,
    },
    /// A checkpoint cannot be written.
    #[error("cannot write checkpoint `{}`: {source}", file.display())]
    Checkpoint {
        /// The checkpoint.
        file: PathBuf,
        /// The system's words.
        source: std::io::Error,
    },
    /// A render has no whole pass that could be merged with others.
    #[error("no pass is whole: there is nothing to merge")]
    NotWhole,
    /// No checkpoint was given to merge, or there are none in a folder.
    #[error("there is no checkpoint (.ckpt) to merge")]
    NoParts,
    /// A checkpoint cannot be merged with others.
    #[error("cannot merge `{}`: {source}", file.display())]
    Part {
        /// The checkpoint.
        file: PathBuf,
        /// What is wrong with it.
        source: CheckpointError,
    },
    /// Two checkpoints are of different renders.
    #[error("`{}` and `{}` are parts of different renders: {name} is `{}` and `{}`",
        files[0].display(), files[1].display(), values[0], values[1])]
    Unlike {
        /// The checkpoints.
        files: Box<[PathBuf; 2]>,
        /// What differs: a setting, the scene's hash, the film, the program's version.
        name: String,
        /// Its value in each.
        values: Box<[String; 2]>,
    },
    /// Some passes are in two checkpoints.
    #[error("`{}` and `{}` both hold passes {}..{}",
        files[0].display(), files[1].display(), passes[0], passes[1])]
    Overlap {
        /// The checkpoints.
        files: Box<[PathBuf; 2]>,
        /// The first such pass and the one after the last.
        passes: [u32; 2],
    },
    /// Some passes are in no checkpoint.
    #[error(
        "passes {} of 0..{whole} are missing{}; --allow-missing merges what is there",
        listed(missing),
        unfinished(begun)
    )]
    Missing {
        /// The first of each range and the one after the last.
        missing: Vec<[u32; 2]>,
        /// Passes of the whole render.
        whole: u32,
        /// Checkpoints that end before the passes which they were to hold.
        begun: Vec<PathBuf>,
    },
    /// More passes are there than were said to be.
    #[error("`{}` holds passes {}..{}, and the whole render is said to have {whole}", file.display(), passes[0], passes[1])]
    Beyond {
        /// The checkpoint.
        file: PathBuf,
        /// The first one and the one after the last.
        passes: [u32; 2],
        /// Passes of the whole render.
        whole: u32,
    },
    /// A layer was asked for that the parts were rendered without.
    #[error("the parts were rendered without the layer `{0}`: name it with --layers when they are rendered")]
    NotRendered(String),
    /// A picture cannot be encoded or written, in the words for each file.
    #[error("{0}")]
    Picture(String),
}

impl Error {
    /// Whether what was asked for is wrong in itself, rather than the scene, a file, the memory or the disk.
    pub fn is_request(&self) -> bool {
        matches!(
            self,
            Self::NoSensor { .. }
                | Self::OutsideFilm { .. }
                | Self::Setting(_)
                | Self::Layers(_)
                | Self::NeedsExr { .. }
                | Self::UnknownFormat { .. }
                | Self::IsInput(_)
                | Self::NamedTwice(_)
                | Self::Beyond { .. }
                | Self::NotRendered(_)
        ) || matches!(self, Self::Scene(failure) if failure.is_request())
    }
}

fn sensors(count: usize) -> String {
    match count {
        1 => "0, as the scene has one sensor".to_owned(),
        n => format!("a number from 0 to {}, as the scene has {n} sensors", n - 1),
    }
}

/// Words for checkpoints that can be completed.
fn unfinished(files: &[PathBuf]) -> String {
    let files: Vec<String> = files.iter().map(|file| format!("`{}`", file.display())).collect();
    match files.len() {
        0 => String::new(),
        1 => format!(" ({} is unfinished: --resume completes it)", files[0]),
        _ => format!(" ({} are unfinished: --resume completes them)", files.join(", ")),
    }
}

fn shown(bytes: u128) -> String {
    megabytes(u64::try_from(bytes).unwrap_or(u64::MAX))
}
