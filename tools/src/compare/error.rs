use caustica_formats::image::{ImageError, words};
use std::path::PathBuf;
use thiserror::Error;

/// Why two pictures could not be compared.
#[derive(Debug, Error)]
pub enum CompareError {
    /// A file is not a picture, or a picture could not be encoded.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        source: ImageError,
    },
    /// A file could not be read or written.
    #[error("{}: {}", path.display(), words(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A picture lacks the channels asked for.
    #[error("{}: no channels {wanted}; the file has {found}", path.display())]
    MissingChannels {
        /// The picture.
        path: PathBuf,
        /// The channels asked for.
        wanted: String,
        /// The channels it has.
        found: String,
    },
    /// A picture holds NaN or infinities.
    #[error(
        "{}: {count} values are not finite; the first is {value} in channel {channel} at column {x}, row {y}",
        path.display()
    )]
    NotFinite {
        /// The picture.
        path: PathBuf,
        /// Number of values that are not finite.
        count: usize,
        /// The first of them.
        value: f32,
        /// Its channel: R, G or B.
        channel: char,
        /// Its column.
        x: usize,
        /// Its row.
        y: usize,
    },
    /// Two pictures differ in size.
    #[error(
        "different sizes: {} has {}x{} pixels, {} has {}x{} (`--size` and `--crop` of `caustica render` decide it)",
        path.display(), size[0], size[1], reference.display(), reference_size[0], reference_size[1]
    )]
    Size {
        /// The one picture.
        path: PathBuf,
        /// Its width and height.
        size: [usize; 2],
        /// The other picture.
        reference: PathBuf,
        /// Its width and height.
        reference_size: [usize; 2],
    },
    /// A z-test was asked for without a variance image.
    #[error(
        "no variance image beside {} or {}, and no layer of variance in them: give one with --variance FILE or --image-variance FILE",
        reference.display(), image.display()
    )]
    NoVariance {
        /// The reference.
        reference: PathBuf,
        /// The image.
        image: PathBuf,
    },
    /// The variance of one sample says nothing without the number of samples.
    #[error("{from} holds the variance of one sample: give the sample count of the image with --spp N")]
    NoSamples {
        /// The variance image or layer.
        from: String,
    },
    /// Variances that are not finite, such as those of a single pass.
    #[error("{from} holds no variance: {why}")]
    NotVariance {
        /// The variance image or layer.
        from: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A folder is compared with a file.
    #[error("{} is a folder and {} is a file", folder.display(), file.display())]
    FolderAgainstFile {
        /// The folder.
        folder: PathBuf,
        /// The file.
        file: PathBuf,
    },
    /// A folder has no image for a reference.
    #[error("{} has no image for {}", folder.display(), reference.display())]
    NoImage {
        /// The folder of images.
        folder: PathBuf,
        /// The reference.
        reference: PathBuf,
    },
    /// A folder holds no reference.
    #[error("no reference image in {}", folder.display())]
    NoReferences {
        /// The folder.
        folder: PathBuf,
    },
    /// A name of `--update` is that of no picture.
    #[error("--update: there is no picture `{name}` to compare{}", hint.as_ref().map_or(String::new(), |h| format!("; did you mean `{h}`?")))]
    NoSuchPicture {
        /// The name.
        name: String,
        /// A picture with nearly this name.
        hint: Option<String>,
    },
}

impl CompareError {
    /// Whether a file is not there.
    pub fn is_missing(&self) -> bool {
        match self {
            Self::NoImage { .. } | Self::NoReferences { .. } => true,
            Self::Io { source, .. } => source.kind() == std::io::ErrorKind::NotFound,
            _ => false,
        }
    }
}
