use caustica_formats::image::ImageError;
use std::path::PathBuf;
use thiserror::Error;

/// Why two pictures could not be compared.
#[derive(Debug, Error)]
pub enum CompareError {
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: ImageError },
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{}: no channels {wanted}; the file has {found}", path.display())]
    MissingChannels { path: PathBuf, wanted: String, found: String },
    #[error(
        "{}: {count} of its values are not finite; the first is {value} in channel {channel} at column {x}, \
         row {y}",
        path.display()
    )]
    NotFinite { path: PathBuf, count: usize, value: f32, channel: char, x: usize, y: usize },
    #[error(
        "different sizes: {} has {}x{} pixels, {} has {}x{}",
        path.display(), size[0], size[1], reference.display(), reference_size[0], reference_size[1]
    )]
    Size { path: PathBuf, size: [usize; 2], reference: PathBuf, reference_size: [usize; 2] },
    #[error("no variance image beside {}: give one with --variance FILE", reference.display())]
    NoVariance { reference: PathBuf },
    #[error(
        "{} holds the variance of one sample: give the samples a pixel of the image with --spp N",
        path.display()
    )]
    NoSamples { path: PathBuf },
    #[error("{} is a folder and {} is a file", folder.display(), file.display())]
    FolderAgainstFile { folder: PathBuf, file: PathBuf },
    #[error("{} has no image for {}", folder.display(), reference.display())]
    NoImage { folder: PathBuf, reference: PathBuf },
    #[error("no reference image in {}", folder.display())]
    NoReferences { folder: PathBuf },
}
