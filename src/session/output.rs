//! Pictures → files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use caustica_formats::image::{
    ExrLayer, ExrOptions, ImageError, atomic_write, encode_exr, encode_hdr, encode_pfm, encode_png,
};

use super::layers::Content;
use super::lock::Lock;
use super::picture::{Picture, PictureInfo};
use super::place::{check_distinct, check_place, keep_elsewhere, real};
use super::{Error, Session};

/// The files of a picture, and how they are encoded.
#[derive(Clone, Debug)]
pub struct Output {
    /// .exr, .png, .hdr or .pfm.
    pub files: Vec<PathBuf>,
    /// 16-bit floats instead of 32-bit ones, EXR only.
    pub half: bool,
    /// Stops, PNG only.
    pub exposure: f64,
    /// Exponent of the PNG's curve; `None` is the sRGB curve.
    pub gamma: Option<f64>,
    /// Store coverage as well, EXR only.
    pub alpha: bool,
}

impl Output {
    /// As the scene's own film asks for, into these files; what names one file twice is written once.
    pub fn new(session: &Session, files: Vec<PathBuf>) -> Self {
        Self::of(&session.info(), files)
    }

    /// The same for a picture that is merged from parts.
    pub fn of(info: &PictureInfo, mut files: Vec<PathBuf>) -> Self {
        files.dedup_by_key(|file| real(file));
        Self { files, half: false, exposure: info.exposure, gamma: info.gamma, alpha: info.alpha }
    }

    /// Finds out before the render what would fail after it: formats that do not exist or cannot hold what
    /// was asked for, places that cannot be written, outputs that would overwrite each other or the scene.
    /// `others` are further files that will be written.
    ///
    /// # Errors
    /// The first such problem.
    pub fn check(&self, session: &Session, others: &[&Path]) -> Result<(), Error> {
        let layers = session.layers_asked && !session.layers.is_empty();
        self.check_files(layers, &session.inputs, others)
    }

    /// [`Output::check`] for a picture that is merged from the files `parts`. `layers`: some were asked for.
    ///
    /// # Errors
    /// The first problem.
    pub fn check_merged(&self, layers: bool, parts: &[PathBuf], others: &[&Path]) -> Result<(), Error> {
        self.check_files(layers, &parts.iter().map(|part| real(part)).collect(), others)
    }

    fn check_files(&self, layers: bool, inputs: &BTreeSet<PathBuf>, others: &[&Path]) -> Result<(), Error> {
        for file in &self.files {
            let extension = extension(file);
            if !matches!(extension.as_str(), "exr" | "png" | "hdr" | "pfm") {
                return Err(Error::UnknownFormat { file: file.clone(), extension });
            }
        }
        if let Some(first) = self.files.first().filter(|_| !self.files.iter().any(|f| extension(f) == "exr"))
        {
            let lost = [(self.half, "half floats (--half)"), (layers, "layers (--layers)")];
            if let Some((_, what)) = lost.into_iter().find(|(asked, _)| *asked) {
                return Err(Error::NeedsExr { what, file: first.clone() });
            }
        }
        let all: Vec<&Path> = self.files.iter().map(PathBuf::as_path).chain(others.iter().copied()).collect();
        all.iter().try_for_each(|file| check_place(file))?;
        check_distinct(&all, inputs)
    }

    /// Keeps other processes from writing the same files, and `others`, until the locks are dropped.
    ///
    /// # Errors
    /// [`Error::Locked`] when another process is writing one of them.
    pub fn lock(&self, others: &[&Path]) -> Result<Vec<Lock>, Error> {
        let all = self.files.iter().map(PathBuf::as_path).chain(others.iter().copied());
        // Where files cannot be locked, nothing is.
        all.filter_map(|file| Lock::take(file).transpose()).collect()
    }

    /// Encodes and writes every file, each replaced in one step. What cannot be written where it should
    /// is kept elsewhere, and the error says where.
    ///
    /// # Errors
    /// [`Error::Picture`] with the words for every file that could not be written.
    pub fn write(&self, picture: &Picture<'_>) -> Result<(), Error> {
        let mut problems = Vec::new();
        for file in &self.files {
            let bytes = self
                .encode(picture, &extension(file))
                .map_err(|e| Error::Picture(format!("cannot write `{}`: {e}", file.display())))?;
            if let Err(e) = atomic_write(file, &bytes) {
                let kept = match keep_elsewhere(file, &bytes) {
                    Ok(place) => format!("the picture is in `{}` instead", place.display()),
                    Err(why) => format!("nor could it be kept elsewhere: {why}"),
                };
                problems.push(format!("cannot write `{}`: {e}; {kept}", file.display()));
            }
        }
        if problems.is_empty() { Ok(()) } else { Err(Error::Picture(problems.join("\n"))) }
    }

    fn encode(&self, picture: &Picture<'_>, extension: &str) -> Result<Vec<u8>, ImageError> {
        let [width, height] = picture.size();
        match extension {
            "exr" => self.exr(picture),
            "png" => encode_png(width, height, &self.eight_bit(picture)),
            "hdr" => encode_hdr(width, height, &floats(picture)),
            _ => encode_pfm(width, height, &floats(picture)),
        }
    }

    fn exr(&self, picture: &Picture<'_>) -> Result<Vec<u8>, ImageError> {
        let (pixels, passes) = (picture.pixels, picture.passes());
        let mut main = Vec::new();
        for (i, [r, g, b]) in picture.rgb().enumerate() {
            main.extend([r as f32, g as f32, b as f32]);
            if self.alpha {
                main.push(pixels.alpha(i, passes) as f32);
            }
        }
        let main_channels: &[&str] = if self.alpha { &["R", "G", "B", "A"] } else { &["R", "G", "B"] };
        let wanted = &picture.info.layers;
        let names: Vec<Vec<&str>> =
            wanted.iter().map(|layer| layer.channels.iter().map(String::as_str).collect()).collect();
        let extras: Vec<Vec<f32>> = wanted.iter().map(|layer| channels(picture, layer.content)).collect();
        let mut layers = vec![ExrLayer { name: "", channels: main_channels, data: &main }];
        layers.extend(wanted.iter().zip(&names).zip(&extras).map(|((layer, channels), data)| ExrLayer {
            name: &layer.name,
            channels,
            data,
        }));
        let [width, height] = picture.size();
        encode_exr(width, height, &layers, &picture.metadata(), ExrOptions { half: self.half })
    }

    fn eight_bit(&self, picture: &Picture<'_>) -> Vec<u8> {
        let gain = self.exposure.exp2();
        let curve = |v: f64| {
            let v = (v * gain).clamp(0.0, 1.0);
            let encoded = match self.gamma {
                Some(g) => v.powf(1.0 / g),
                None => caustica_formats::spectrum::linear_to_srgb(v),
            };
            (encoded * 255.0).round() as u8
        };
        picture.rgb().flat_map(|c| c.map(curve)).collect()
    }
}

/// The numbers of a layer, pixel by pixel.
fn channels(picture: &Picture<'_>, content: Content) -> Vec<f32> {
    let (pixels, passes) = (picture.pixels, picture.passes());
    let count = pixels.len();
    let alpha = |i: usize| pixels.alpha(i, passes) as f32;
    match content {
        Content::Part(layer) => {
            (0..count).flat_map(|i| pixels.layer(i, layer, passes)).map(|v| v as f32).collect()
        }
        Content::Picture => {
            let rgb = picture.rgb().enumerate();
            rgb.flat_map(|(i, [r, g, b])| [r as f32, g as f32, b as f32, alpha(i)]).collect()
        }
        Content::Variance => {
            (0..count).map(|i| pixels.variance(i, passes).min(f64::from(f32::MAX)) as f32).collect()
        }
        Content::Samples => vec![passes as f32 * pixels.common.samples_a_pass as f32; count],
        Content::Surface(aov) => {
            let list = &picture.info.aovs;
            (0..count).flat_map(|i| pixels.aov(i, aov, list, passes)).map(|v| v as f32).collect()
        }
    }
}

fn floats(picture: &Picture<'_>) -> Vec<f32> {
    picture.rgb().flat_map(|c| c.map(|v| v as f32)).collect()
}

fn extension(path: &Path) -> String {
    path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase())
}
