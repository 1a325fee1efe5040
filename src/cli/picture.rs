//! Arguments that decide which files a picture goes to, and how.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::words::any_of;
use crate::session::{Error, KNOWN_LAYERS, Layers, Output, PictureInfo};

/// Files and layers of a picture, for every subcommand that writes one.
#[derive(Debug, Args)]
pub struct PictureArgs {
    /// Picture to write: .exr, .png, .hdr or .pfm [default: SCENE.exr here]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Also write a PNG [default name: that of the output]
    #[arg(long, value_name = "FILE", num_args = 0..=1, value_parser = png)]
    pub png: Option<Option<PathBuf>>,
    /// Stops of exposure for the PNG
    #[arg(long, value_name = "EV", default_value_t = 0.0, allow_hyphen_values = true, value_parser = stops)]
    pub exposure: f64,
    /// Store 16-bit floats
    #[arg(long)]
    pub half: bool,
    #[arg(long, value_name = "LIST", hide_possible_values = true,
        value_parser = any_of(KNOWN_LAYERS.into_iter().chain(["all", "none"])),
        help = format!("Layers of the EXR: {}, all or none [default: emission,direct,caustic,indirect and what the \
            scene asks for]", KNOWN_LAYERS.join(", ")))]
    layers: Option<String>,
}

fn png(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Ok(path);
    }
    Err("expected a name that ends in `.png`; what follows `--png` is that name, so that the scene goes before it".to_owned())
}

fn stops(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|e: &f64| e.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

impl PictureArgs {
    /// The layers asked for, if any.
    ///
    /// # Errors
    /// When there is no such layer.
    pub fn layers(&self) -> Result<Option<Layers>, Failure> {
        Ok(self.layers.as_deref().map(str::parse::<Layers>).transpose().map_err(Error::from)?)
    }

    /// The layers asked for, as they were.
    pub fn layers_as_given(&self) -> Option<&str> {
        self.layers.as_deref()
    }

    /// Whether a file is named.
    pub fn is_asked(&self) -> bool {
        self.output.is_some() || self.png.is_some()
    }

    /// The files, with what the picture's own film asks for.
    pub fn output(&self, info: &PictureInfo) -> Output {
        let main = self.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.exr", info.scene)));
        let mut files = vec![main.clone()];
        files.extend(self.png_beside(&main));
        let own = Output::of(info, files);
        Output { half: self.half, exposure: self.exposure + own.exposure, ..own }
    }

    /// The further PNG.
    fn png_beside(&self, main: &Path) -> Option<PathBuf> {
        self.png.as_ref().map(|name| name.clone().unwrap_or_else(|| main.with_extension("png")))
    }
}
